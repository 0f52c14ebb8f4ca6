"""One check of an FMU's library, in a process of its own: a library may end it or hang.

python -m contact_fmus.checking.trial CHECK FILE.fmu       prints JSON: findings
"""

import ctypes
import dataclasses
import json
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy import fmi3

from contact_fmus.errors import UserError
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.variables import is_fmi3
from contact_fmus.results import Result
from contact_fmus.running.exchange import by_fmpy
from contact_fmus.scenarios.experiment import Experiment
from contact_fmus.scenarios.recording import said, simulate
from contact_fmus.scenarios.scenario import of_fmu

STEPS = 100  # of the trial
# What a restored state may change: outputs are the same at once but for rounding; a solver that starts afresh
# from there goes on with errors of its own, 1e-4 as FMI's default tolerance allows.
AT_ONCE, LATER = 1e-9, 1e-4  # of the largest value

CHECKS = tomllib.loads(Path(__file__).with_name("checks.toml").read_text(encoding="utf-8"))


def wanted(version: str, kind: str) -> list[str]:
    """Functions of the standard; FMI 3.0 wants those of all kinds. `kind`: a name of fmpy's"""
    if version == "2":
        return [f"fmi2{name}" for which in ("every", kind) for name in CHECKS["functions"][which].split()]
    importer = fmi3.FMU3Slave if kind == "coSimulation" else fmi3.FMU3Model
    return [name for name in dir(importer) if name.startswith("fmi3")]


def platform_folder(description: Any) -> str:
    """Where binaries for this machine are: FMI 3.0 calls platforms otherwise"""
    return fmpy.platform_tuple if is_fmi3(description) else fmpy.platform


def exports(file: Path) -> Iterator[str]:
    """Functions of the standard that this platform's library lacks"""
    folder = Path(fmpy.extract(str(file)))
    about = fmpy.read_model_description(folder, validate=False)
    for kind in ("coSimulation", "modelExchange"):
        if (one := getattr(about, kind)) is None:
            continue
        name = f"{one.modelIdentifier}{fmpy.sharedLibraryExtension}"
        library = ctypes.CDLL(str((folder / "binaries" / platform_folder(about) / name).resolve()))
        missing = [one for one in wanted(about.fmiVersion[0], kind) if not hasattr(library, one)]
        if missing:
            yield f"{name} does not export {', '.join(missing)}"


def short(file: Path, kind: str = "coSimulation") -> Experiment:
    """The first steps of the default experiment"""
    default = of_fmu(file, kind)
    stop = min(default.stop_time, default.start_time + STEPS * default.step)
    return dataclasses.replace(default, stop_time=stop)


def run(file: Path) -> Iterator[str]:
    """A short simulation: it comes to its end, with finite numbers, and no error is logged"""
    yield from _looked_at(simulate(short(file)))


def exchange(file: Path) -> Iterator[str]:
    """A short simulation by Model Exchange comes to its end in the same way"""
    yield from _looked_at(by_fmpy(short(file, "modelExchange")))


def _looked_at(result: Result) -> Iterator[str]:
    for name, column in result.columns.items():
        if column.dtype.kind == "f" and not np.all(np.isfinite(column)):
            yield f"{name} is not finite at {result.time[~np.isfinite(column)][0]} s"
    yield from (text for text in result.warnings if text.startswith("error logged"))


def state(file: Path) -> Iterator[str]:
    """A state is saved in the middle and restored at the end: outputs are as they were, and go on so"""
    experiment = short(file)
    middle = experiment.start_time + 0.5 * (experiment.stop_time - experiment.start_time)
    with ContactFmu(file) as fmu:
        names = [
            name
            for name, one in fmu.variables.items()
            if one.causality == "output" and one.type == "Real" and not one.is_vector
        ]

        def outputs() -> np.ndarray:
            return np.array([fmu[name] for name in names])

        def end() -> np.ndarray:
            fmu.step(experiment.stop_time - fmu.time)
            return outputs()

        fmu.start({}, experiment.tolerance, experiment.start_time, experiment.stop_time)
        fmu.step(middle - fmu.time)
        saved, then, first = fmu.save(), outputs(), end()
        texts = [saved]
        kind = fmu.description.coSimulation
        if getattr(kind, "canSerializeFMUstate", False) or getattr(kind, "canSerializeFMUState", False):
            texts.append(bytes(saved))
        for given in texts:
            how = "restored" if given is saved else "restored from its bytes"
            fmu.restore(given)
            fmu.time = saved.time
            yield from _differences(names, then, outputs(), AT_ONCE, f"right after the state was {how}")
            yield from _differences(names, first, end(), LATER, f"at the end of a run whose state was {how}")


def _differences(names: list[str], expected: np.ndarray, found: np.ndarray, part: float, when: str) -> Iterator[str]:
    off = np.abs(found - expected) > part * np.maximum(np.abs(found), np.abs(expected))
    wrong = [f"{names[k]} ({found[k]!r} instead of {expected[k]!r})" for k in np.flatnonzero(off)[:3]]
    if wrong:
        more = f" and {np.count_nonzero(off) - 3} more" if np.count_nonzero(off) > 3 else ""
        yield f"{when}, {', '.join(wrong)}{more} differ"


TRIALS = {"exports": exports, "run": run, "exchange": exchange, "state": state}


def main() -> int:
    check, file = sys.argv[1], Path(sys.argv[2])
    try:
        findings = list(TRIALS[check](file))
    except Exception as error:  # whatever the library or fmpy comes to is what is looked for
        text = said(error) if hasattr(error, "messages") else str(error)
        if isinstance(error, UserError):
            text = text.replace(f"{file}: ", "").replace(f"{file.name}: ", "")
        findings = [" ".join(text.split()) or type(error).__name__]
    print("\n" + json.dumps({"findings": findings}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
