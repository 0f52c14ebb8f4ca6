"""Runs an experiment and keeps everything that the FMU tells, with more points around each contact.

A contact may last a millionth of the run. The run is therefore made twice: the first finds the contacts,
whose times the FMU tells exactly, and the second stops at points that show each of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.variables import Variable
from contact_fmus.results import Result
from contact_fmus.scenarios.target import Experiment

from .contacts import Touch, missed, touches

POINTS = 600  # of a run besides those for contacts: as many as a screen shows, and as many frames in 10 s
DENSE = 8000  # shared by all contacts of a run
FEWEST, MOST = 5, 32  # points of one contact
SEARCHES, PARTS = 3, 32  # how often a step with several onsets is split, and into how many
LEAST_STEP = 16  # roundings of the time: a shorter step could end where it began


def record_densely(experiment: Experiment, points: int = POINTS) -> Result:
    """`points` of the run in all, and some inside and beside each contact"""
    even = np.linspace(experiment.start_time, experiment.stop_time, points + 1)
    times = even
    for _ in range(SEARCHES):
        result = record(experiment, times)
        lost = missed(result)
        if len(lost) == 0 or len(times) > DENSE:
            break
        parts = [np.linspace(times[row - 1], times[row], PARTS + 1) for row in lost[: DENSE // PARTS]]
        times = _distinct(np.concatenate([times, *parts]), experiment)
    found = touches(result)
    if not found:
        return result
    count = int(np.clip(DENSE // len(found), FEWEST, MOST))
    dense = [_around(touch, count) for touch in found[: DENSE // FEWEST]]
    return record(experiment, _distinct(np.concatenate([even, *dense]), experiment))


def _around(touch: Touch, count: int) -> np.ndarray:
    """Evenly over the contact, closer after its onset (a long one begins like a short one), and beside it"""
    inside = np.linspace(0.0, 1.0, count)
    start = np.geomspace(1e-4, 1.0 / count, max(2, count // 4))
    return touch.begin + touch.duration * np.concatenate([inside, start, [-1.0, -0.5, 1.5, 2.0]])


def _distinct(times: np.ndarray, experiment: Experiment) -> np.ndarray:
    """Rising, inside the run, no two closer than a step can be"""
    begin, end = experiment.start_time, experiment.stop_time
    times = np.unique(times[(times > begin) & (times < end)])
    least = LEAST_STEP * np.spacing(max(abs(begin), abs(end)))
    kept = [begin]
    for time in times.tolist():
        if time - kept[-1] > least and end - time > least:
            kept.append(time)
    return np.array([*kept, end])


def record(experiment: Experiment, times: np.ndarray) -> Result:
    """The FMU's outputs and inputs at these times, the first of which is the start"""
    try:
        with ContactFmu(experiment.fmu) as fmu:
            start = dict(experiment.values)
            for signal in experiment.inputs:
                start[signal.variable] = signal.evaluate(experiment.start_time, 0)
            fmu.start(start, experiment.tolerance, experiment.start_time, experiment.stop_time)
            return _step_through(fmu, experiment, times)
    except FmuError as error:
        raise RunFailure(f"{experiment.fmu.name}: {error}") from None
    except (KeyError, ValueError) as error:
        text = error.args[0] if isinstance(error, KeyError) else error
        raise UserError(f"{experiment.fmu.name}: {text}") from None


def _step_through(fmu: ContactFmu, experiment: Experiment, times: np.ndarray) -> Result:
    kept = [one for one in fmu.variables.values() if not one.is_vector and _changes(one)]
    readers = _readers(fmu, kept)
    rows = []
    for index, time in enumerate(times):
        if index > 0:
            fmu.step(time - fmu.time)
        for signal in experiment.inputs:
            fmu[signal.variable] = signal.evaluate(time, 0)
            for order in range(1, signal.derivatives + 1):
                fmu.set_derivative(signal.variable, signal.evaluate(time, order), order)
        rows.append([value for read in readers for value in read()])
    names = [one.name for kind in TYPES for one in kept if one.type == kind]
    columns = dict(zip(names, np.array(rows, dtype=float).T, strict=True))
    units = {one.name: one.unit for one in kept}
    return Result(times, columns, units, experiment.fmu, _parameters(fmu))


def _changes(variable: Variable) -> bool:
    return variable.causality in ("output", "input", "local") and variable.type in TYPES


TYPES = {"Real": "getReal", "Integer": "getInteger", "Boolean": "getBoolean"}


def _readers(fmu: ContactFmu, kept: list[Variable]) -> list[Callable[[], list]]:
    """One call of the FMU for all variables of a type"""

    def reader(kind: str) -> Callable[[], list]:
        references = [one.references[0] for one in kept if one.type == kind]
        return lambda: fmu.call(TYPES[kind], references) if references else []

    return [reader(kind) for kind in TYPES]


def _parameters(fmu: ContactFmu) -> dict[str, Any]:
    """Their values in this run, vectors as lists"""
    names = [name for name in fmu.variables if not name.endswith("]")]
    wanted = [name for name in names if "arameter" in fmu.variables[name].causality]
    known = [name for name in wanted if fmu.variables[name].type != "String"]
    return {name: _plain(fmu[name]) for name in known}


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value
