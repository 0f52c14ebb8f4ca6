"""Runs of fmpy, whose CVODE moves Model Exchange FMUs of FMI 2.0 and FMI 3.0"""

from pathlib import Path

import fmpy
import numpy as np

from contact_fmus.fmu.files import fmu_file
from support.checks import check_close, check_relative
from support.fmi3.raw import FMUS

# Relative tolerance of fmpy's CVODE, whose absolute one is that times the nominal value of each state.
TOLERANCE = 1e-11


def scalars(start: dict, description) -> dict:
    """Returns start values by the names of the description, items of enumerations as numbers."""
    known = {variable.name: variable for variable in description.modelVariables}
    flat = {}
    for name, value in start.items():
        if isinstance(value, (list, tuple)) and name not in known:
            flat |= {f"{name}[{k}]": one for k, one in enumerate(value, 1)}
        elif isinstance(value, str):
            items = known[name].declaredType.items
            flat[name] = int(next(item.value for item in items if item.name == value))
        else:
            flat[name] = value
    return flat


def simulate(file: Path, start: dict, stop: float, names: list[str], kind: str = "ModelExchange"):
    description = fmpy.read_model_description(str(file))
    settings = {"start_values": scalars(start, description), "stop_time": stop, "output": names}
    settings |= {"relative_tolerance": TOLERANCE, "output_interval": 1e-3}
    return fmpy.simulate_fmu(str(file), fmi_type=kind, **settings)


def check_exchange(fmu, scene: str, values: dict, end: float, vectors: list[str]):
    """The Model Exchange of both versions has the same vectors, work of friction and balance at the end as
    `fmu`, an FMU for Co-Simulation that has come there."""
    scalar = [f"{name}[{k}]" for name in vectors for k in (1, 2, 3)]
    for file, names in ((fmu_file(scene), scalar), (FMUS / f"{scene}.fmu", vectors)):
        found = simulate(file, values, end, [*names, "energy.friction", "energy.total"])
        ends = np.concatenate([np.atleast_1d(found[name][-1]) for name in names])
        check_close("motion", ends, np.concatenate([fmu[name] for name in vectors]), 1e-6)
        check_relative("energy.friction", found["energy.friction"][-1], fmu["energy.friction"], 1e-6)
        check_close("balance", np.ptp(found["energy.total"]), 0.0, 1e-6)
