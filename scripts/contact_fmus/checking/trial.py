"""Loads an FMU's library and runs it for a short while, in a process of its own: a library may end it.

python -m contact_fmus.checking.trial FOLDER       FOLDER: an unpacked FMU; prints JSON: check -> findings
"""

from __future__ import annotations

import ctypes
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np

STEPS = 100  # of the trial

# Functions that FMI 2.0.5 wants of every FMU (section 2.1), of co-simulation (4.2), of model exchange (3.2)
EVERY = """GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment
    EnterInitializationMode ExitInitializationMode Terminate Reset GetReal GetInteger GetBoolean GetString
    SetReal SetInteger SetBoolean SetString GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize
    SerializeFMUstate DeSerializeFMUstate GetDirectionalDerivative"""
CO_SIMULATION = """SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep GetStatus GetRealStatus
    GetIntegerStatus GetBooleanStatus GetStringStatus"""
MODEL_EXCHANGE = """EnterEventMode NewDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep SetTime
    SetContinuousStates GetDerivatives GetEventIndicators GetContinuousStates
    GetNominalsOfContinuousStates"""


def exports(folder: Path, about: Any) -> Iterator[str]:
    """Functions of the standard that this platform's library lacks"""
    if about.fmiVersion != "2.0":
        return
    for kind, own in ((about.coSimulation, CO_SIMULATION), (about.modelExchange, MODEL_EXCHANGE)):
        if kind is None:
            continue
        name = f"{kind.modelIdentifier}{fmpy.sharedLibraryExtension}"
        library = ctypes.CDLL(str((folder / "binaries" / fmpy.platform / name).resolve()))
        missing = [f"fmi2{one}" for one in f"{EVERY} {own}".split() if not hasattr(library, f"fmi2{one}")]
        if missing:
            yield f"{name} does not export {', '.join(missing)}"


def run(folder: Path, about: Any) -> Iterator[str]:
    """A short simulation: it comes to its end, with finite numbers, and no error is logged"""
    default = about.defaultExperiment
    start = float(getattr(default, "startTime", None) or 0.0)
    stop = float(getattr(default, "stopTime", None) or start + 1.0)
    step = float(getattr(default, "stepSize", None) or (stop - start) / STEPS)
    messages: list[str] = []

    def log(_environment, _instance, status, category, message) -> None:
        if status >= 3:  # fmi2Error
            messages.append((message or b"").decode("utf-8", "replace"))

    stop = min(stop, start + STEPS * step)
    rows = fmpy.simulate_fmu(
        str(folder),
        start_time=start,
        stop_time=stop,
        output_interval=step,
        logger=log if about.fmiVersion == "2.0" else None,
    )
    if rows["time"][-1] < stop - step:
        yield f"the run ends at {rows['time'][-1]} s instead of {stop} s"
    for name in rows.dtype.names or ():
        if rows[name].dtype.kind == "f" and not np.all(np.isfinite(rows[name])):
            yield f"{name} is not finite at {rows['time'][~np.isfinite(rows[name])][0]} s"
    yield from (f"error logged: {message}" for message in messages)


def main() -> int:
    folder = Path(sys.argv[1])
    about = fmpy.read_model_description(folder, validate=False)
    found = {}
    for check in (exports, run):
        try:
            found[check.__name__] = list(check(folder, about))
        except Exception as error:  # whatever the library or fmpy comes to is what is looked for
            found[check.__name__] = [" ".join(str(error).split()) or type(error).__name__]
        print(json.dumps(found), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
