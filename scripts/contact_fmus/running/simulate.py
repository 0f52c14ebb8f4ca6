"""Steps an FMU through an experiment and keeps its inputs and outputs at every communication point"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.settings import known
from contact_fmus.fmu.touching import Touching
from contact_fmus.fmu.variables import Variable
from contact_fmus.results import Result
from contact_fmus.scenarios.target import Experiment

RECORDED = ("output", "input")
PARAMETERS = ("parameter", "calculatedParameter")
MOST_VALUES = 200_000_000  # of a result: 1.6 GB


class StoppedEarly(RunFailure):
    """The FMU refused a step; `result` is what there was until then"""

    def __init__(self, text: str, result: Result):
        super().__init__(text)
        self.result = result


def simulate(
    experiment: Experiment,
    interval: float | None = None,
    advance: Callable[[float], None] = lambda time: None,
) -> Result:
    """Rows at communication points and right before and after each onset and release. `interval`: time
    between the former, s; a row for every communication step without it
    """
    times = communication_points(experiment)
    every = 1 if interval is None else max(1, round(interval / experiment.step))
    with ContactFmu(experiment.fmu) as fmu:
        names = _scalars(fmu, RECORDED)
        _refuse_too_much(len(names) * (len(times) // every))
        _start(fmu, experiment)
        recorder = Recorder(fmu, names)
        recorder.row()
        touching = Touching(fmu)
        try:
            for index, time in enumerate(times[1:], 1):
                for _ in touching.step(time):
                    recorder.row()
                _set_inputs(fmu, experiment, time)
                if index % every == 0 or index == len(times) - 1:
                    recorder.row()
                advance(time)
        except FmuError as error:
            raise StoppedEarly(f"at {fmu.time!r} s: {said(error)}", recorder.result(experiment)) from None
        return recorder.result(experiment)


def communication_points(experiment: Experiment) -> list[float]:
    """Whole steps and, where they do not end there, a shorter one to stop_time"""
    length = experiment.stop_time - experiment.start_time
    if not length > 0.0:
        raise UserError(
            f"the end at {experiment.stop_time} s is not after the start at {experiment.start_time} s"
        )
    if not experiment.step > 0.0:
        raise UserError(f"a communication step of {experiment.step} s is not greater than 0")
    _refuse_too_much(length / experiment.step)
    # A quotient that is whole but for its rounding counts as whole.
    count = max(1, math.ceil(length / experiment.step * (1.0 - 1e-12)))
    inner = [experiment.start_time + index * experiment.step for index in range(count)]
    return [*inner, experiment.stop_time]


def said(error: FmuError) -> str:
    """What the FMU said, in its own words where it has any"""
    texts = [message.text for message in error.messages if message.text]
    return " ".join(texts) or str(error)


def _refuse_too_much(values: float) -> None:
    if values > MOST_VALUES:
        raise UserError(
            f"a result of {values:.3g} values is more than {MOST_VALUES:.0e}: give a longer --step"
            " or --output-interval"
        )


RELATIVE_TOLERANCE = "solver.relative_tolerance"  # of the FMUs here, which the experiment's replaces


def _check_tolerance(fmu: ContactFmu, experiment: Experiment) -> None:
    """An FMU takes the nearest one that it allows: here that would be another one than was asked for"""
    declared = [one for one in fmu.description.modelVariables if one.name == RELATIVE_TOLERANCE]
    if experiment.tolerance is None or not declared or None in (declared[0].min, declared[0].max):
        return
    low, high = float(declared[0].min), float(declared[0].max)
    if not low <= experiment.tolerance <= high:
        raise UserError(
            f"{experiment.fmu.name}: the tolerance {experiment.tolerance:g} is refused"
            f" (allowed: {low:g} .. {high:g}, as {RELATIVE_TOLERANCE})"
        )


def _start(fmu: ContactFmu, experiment: Experiment) -> None:
    """What the FMU refuses before its first step is the user's to change"""
    _check_tolerance(fmu, experiment)
    values = dict(experiment.values)
    for signal in experiment.inputs:
        values[signal.variable] = signal.evaluate(experiment.start_time, 0)
    for name in values:
        known(name, fmu.variables, experiment.fmu)
    try:
        fmu.start(values, experiment.tolerance, experiment.start_time, experiment.stop_time)
        _set_inputs(fmu, experiment, experiment.start_time)
    except FmuError as error:
        raise UserError(f"{experiment.fmu.name}: {said(error)}") from None
    except ValueError as error:
        raise UserError(f"{experiment.fmu.name}: {error}") from None


def _set_inputs(fmu: ContactFmu, experiment: Experiment, time: float) -> None:
    for signal in experiment.inputs:
        fmu[signal.variable] = signal.evaluate(time, 0)
        for order in range(1, signal.derivatives + 1):
            fmu.set_derivative(signal.variable, signal.evaluate(time, order), order)


def _scalars(fmu: ContactFmu, causalities: tuple[str, ...]) -> list[str]:
    """Names of variables without vectors, and without texts"""
    return [
        name
        for name, variable in fmu.variables.items()
        if variable.causality in causalities and not variable.is_vector and variable.type in READERS
    ]


READERS = {"Real": "getReal", "Integer": "getInteger", "Enumeration": "getInteger", "Boolean": "getBoolean"}


class Recorder:
    """Rows of values, read by one call for each type"""

    def __init__(self, fmu: ContactFmu, names: list[str]):
        self.fmu, self.names = fmu, names
        self.times: list[float] = []
        self.rows: dict[str, list] = {function: [] for function in READERS.values()}
        self.groups = {
            function: [name for name in names if READERS[fmu.variables[name].type] == function]
            for function in self.rows
        }
        self.parameters = self._parameters()

    def row(self) -> None:
        self.times.append(self.fmu.time)
        for function, names in self.groups.items():
            if names:
                references = [self.fmu.variables[name].references[0] for name in names]
                self.rows[function].append(self.fmu.call(function, references))

    def result(self, experiment: Experiment) -> Result:
        """Columns in the order of the FMU's description"""
        found: dict[str, np.ndarray] = {}
        for function, names in self.groups.items():
            rows = self.rows[function][: len(self.times)]
            for index, name in enumerate(names):
                values = [row[index] for row in rows]
                found[name] = np.array([plain(self.fmu.variables[name], value) for value in values])
        length = min((len(column) for column in found.values()), default=len(self.times))
        columns = {name: found[name][:length] for name in self.names}
        units = {name: self.fmu.variables[name].unit for name in self.names}
        time = np.array(self.times[:length])
        return Result(time, columns, units, experiment.fmu.resolve(), self.parameters, self.fmu.warnings())

    def _parameters(self) -> dict[str, Any]:
        found = {}
        for name in _scalars(self.fmu, PARAMETERS):
            variable = self.fmu.variables[name]
            value = self.fmu.call(READERS[variable.type], variable.references)[0]
            found[name] = plain(variable, value)
        return found


def plain(variable: Variable, value: Any) -> Any:
    """An enumeration's item by name, a Boolean as one"""
    if variable.type == "Boolean":
        return bool(value)
    if variable.items and value in variable.item_values:
        return variable.items[variable.item_values.index(value)]
    return value
