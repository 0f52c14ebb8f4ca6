"""Runs of fmpy, whose CVODE moves Model Exchange FMUs. Without a logger it may call one that is gone."""

from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi1 import printLogMessage

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
            flat[name] = int(next(one.value for one in known[name].declaredType.items if one.name == value))
        else:
            flat[name] = value
    return flat


def simulate(file: Path, start: dict, stop: float, names: list[str], kind: str = "ModelExchange"):
    description = fmpy.read_model_description(str(file))
    settings = {"start_values": scalars(start, description), "stop_time": stop, "output": names}
    settings |= {"relative_tolerance": TOLERANCE, "output_interval": 1e-3}
    settings |= {"logger": printLogMessage} if description.fmiVersion == "2.0" else {}
    return fmpy.simulate_fmu(str(file), fmi_type=kind, **settings)


def check_exchange(fmu, scene: str, values: dict, end: float, vectors: list[str]):
    """Model Exchange of both versions ends as `fmu`, for Co-Simulation, has ended, and keeps its balance."""
    scalar = [f"{name}[{k}]" for name in vectors for k in (1, 2, 3)]
    for file, names in ((fmu_file(scene), scalar), (FMUS / f"{scene}.fmu", vectors)):
        found = simulate(file, values, end, [*names, "energy.friction", "energy.total"])
        ends = np.concatenate([np.atleast_1d(found[name][-1]) for name in names])
        check_close("motion", ends, np.concatenate([fmu[name] for name in vectors]), 1e-6)
        check_relative("energy.friction", found["energy.friction"][-1], fmu["energy.friction"], 1e-6)
        check_close("balance", np.ptp(found["energy.total"]), 0.0, 1e-6)
