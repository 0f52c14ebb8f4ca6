"""Runs of fmpy, whose CVODE moves Model Exchange FMUs of FMI 2.0 and FMI 3.0"""

from pathlib import Path

import fmpy

# Relative tolerance of fmpy's CVODE, whose absolute one is that times the nominal value of each state.
TOLERANCE = 1e-11


def scalars(start: dict, description) -> dict:
    """Start values by the names of the description, items of enumerations as numbers"""
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
    return fmpy.simulate_fmu(
        str(file),
        fmi_type=kind,
        start_values=scalars(start, description),
        stop_time=stop,
        relative_tolerance=TOLERANCE,
        output=names,
        output_interval=1e-3,
    )
