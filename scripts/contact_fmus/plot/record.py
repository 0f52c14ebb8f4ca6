"""Runs an experiment and keeps everything that the FMU tells, with more points around each contact.

A contact may last a millionth of the run: wherever bodies touch or part within a step, points before, between
and after that are added.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.touching import Touching
from contact_fmus.fmu.variables import Variable
from contact_fmus.results import Result
from contact_fmus.scenarios.target import Experiment

POINTS = 600  # of a run besides those for contacts: as many as a screen shows, and as many frames in 10 s
DENSE = 8000  # shared by all contacts of a run
FEWEST, MOST = 5, 32  # points of one contact
AHEAD = 100  # contacts that are still reckoned with: each gets this part of what is left


def record_densely(experiment: Experiment, points: int = POINTS) -> Result:
    """The FMU's outputs and inputs: `points` of the run in all, and some inside and beside each contact"""
    try:
        with ContactFmu(experiment.fmu) as fmu:
            start = dict(experiment.values)
            for signal in experiment.inputs:
                start[signal.variable] = signal.evaluate(experiment.start_time, 0)
            fmu.start(start, experiment.tolerance, experiment.start_time, experiment.stop_time)
            return _step_through(fmu, experiment, points)
    except FmuError as error:
        raise RunFailure(f"{experiment.fmu.name}: {error}") from None
    except (KeyError, ValueError) as error:
        text = error.args[0] if isinstance(error, KeyError) else error
        raise UserError(f"{experiment.fmu.name}: {text}") from None


def _step_through(fmu: ContactFmu, experiment: Experiment, points: int) -> Result:
    kept = [one for one in fmu.variables.values() if not one.is_vector and _changes(one)]
    readers = _readers(fmu, kept)
    times: list[float] = []
    rows: list[list] = []

    def row(time: float) -> None:
        times.append(time)
        rows.append([value for read in readers for value in read()])

    touching, left = Touching(fmu), DENSE
    for index, time in enumerate(np.linspace(experiment.start_time, experiment.stop_time, points + 1)):
        if index > 0:
            before = len(rows)
            for between in touching.step(time, int(np.clip(left // AHEAD, FEWEST, MOST))):
                row(between)
            left -= len(rows) - before
        for signal in experiment.inputs:
            fmu[signal.variable] = signal.evaluate(time, 0)
            for order in range(1, signal.derivatives + 1):
                fmu.set_derivative(signal.variable, signal.evaluate(time, order), order)
        row(time)
    names = [one.name for kind in TYPES for one in kept if one.type == kind]
    columns = dict(zip(names, np.array(rows, dtype=float).T, strict=True))
    units = {one.name: one.unit for one in kept}
    return Result(np.array(times), columns, units, experiment.fmu, _parameters(fmu), fmu.warnings())


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
