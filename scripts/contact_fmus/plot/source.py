"""What a user names made a run: a result's file, an FMU or a scenario"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.files import Scene, read_scene, unpack
from contact_fmus.fmu.touching import Touching
from contact_fmus.fmu.variables import Variable, scalars
from contact_fmus.results import Result
from contact_fmus.scenarios.experiment import Motion
from contact_fmus.scenarios.scenario import ANY, Experiment, changed, drawn_runs, find

# Runs an experiment and keeps everything that the FMU tells, with more points around each contact.
#
# A contact may last a millionth of the run: wherever bodies touch or part within a step, points before,
# between and after that are added.

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


@dataclass(frozen=True)
class Run:
    title: str
    label: str  # what tells it from the other runs of a scenario
    result: Result


def open_runs(name: str, settings: Sequence[str], stop: float | None, fmu: Path | None = None) -> list[Run]:
    """One run, or those that a scenario compares. `settings`: NAME=VALUE; `fmu`: for results naming none."""
    path = find(name, ANY)
    if path.suffix == ".csv":
        if settings or stop is not None:
            raise UserError(f"{path}: --set and --stop are for runs; this one is over")
        result = Result.read(path)
        if len(result.time) < 2:
            raise UserError(f"{path}: {len(result.time)} row of values; two are needed")
        result.fmu = fmu or result.fmu
        return [Run(path.stem, "", result)]
    with readable(path):
        experiments = [changed(one, settings, stop) for one in drawn_runs(path)]
    runs = [Run(one.title, one.label, record_densely(one)) for one in experiments]
    for run in runs:
        run.result.tell_warnings()
    return runs


@contextlib.contextmanager
def readable(fmu: Path) -> Iterator[None]:
    """Whatever fmpy makes of a file that is no FMU becomes one sentence."""
    try:
        yield
    except UserError:
        raise
    except Exception as error:
        text = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise UserError(f"{fmu}: this is no FMU that can be run: {text}") from None


def motion_of(result: Result) -> Motion:
    """UserError where nothing tells the scene"""
    if result.fmu is None:
        raise UserError("the result does not say which FMU made it: name it by --fmu")
    fmu = Path(result.fmu)
    if not fmu.is_file():
        raise UserError(f"{fmu}, which made the result, does not exist: name it by --fmu")
    with readable(fmu):
        scene, starts = read_scene(fmu), _start_values(fmu)
    _check_columns(result, scene)

    def value(name: str) -> Any:
        for known in (result.parameters, scene.pinned, starts):
            if name in known:
                return known[name]
        return None

    def series(name: str) -> np.ndarray | None:
        if name in result.columns:
            return result.columns[name]
        pattern = re.compile(re.escape(name) + r"\[\d+\]")
        parts = [column for column in result.columns if pattern.fullmatch(column)]
        return np.column_stack([result.columns[part] for part in parts]) if parts else None

    return Motion(scene, result.time, value, series)


def _check_columns(result: Result, scene: Scene) -> None:
    """A result of another FMU would be shown as bodies that stand still."""
    names = [contact.name for contact in scene.contacts]
    if not any(f"{name}.gap" in result.columns for name in names):
        raise UserError(f"{result.fmu}: the result has no gap of its contacts ({', '.join(names)})")


def _start_values(fmu: Path) -> dict[str, Any]:
    """Start values of the description: what holds where a result does not say what was set"""
    found: dict[str, Any] = {}
    for scalar in scalars(unpack(fmu)[1]):
        if scalar.start is None:
            continue
        value: Any = scalar.start
        if scalar.type == "Real":
            value = float(value)
        elif scalar.type == "Boolean":
            value = str(value).lower() in ("true", "1")
        elif scalar.type == "Enumeration":
            items = {str(item.value): item.name for item in scalar.declaredType.items}
            value = items.get(str(value), value)
        name, bracket, _ = scalar.name.partition("[")
        if bracket:
            found.setdefault(name, []).append(value)
        else:
            found[name] = value
    return found
