"""Steps an FMU through an experiment and keeps its inputs and outputs at every communication point"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import fmpy
import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.files import unpack
from contact_fmus.fmu.slaves import text_of
from contact_fmus.fmu.touching import Touching
from contact_fmus.fmu.variables import Variable, entries, is_fmi3, item_value, known, read_variables, scalars
from contact_fmus.results import Result
from contact_fmus.scenarios.scenario import Experiment

RECORDED = ("output", "input")
PARAMETERS = ("parameter", "calculatedParameter")
MOST_VALUES = 200_000_000  # of a result: 1.6 GB


class StoppedEarly(RunFailure):
    """The FMU refused a step; `result` is what there was until then"""

    def __init__(self, text: str, result: Result):
        super().__init__(text)
        self.result = result


def simulate(
    experiment: Experiment, interval: float | None = None, advance: Callable[[float], None] = lambda time: None
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
        raise UserError(f"the end at {experiment.stop_time} s is not after the start at {experiment.start_time} s")
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
            f"a result of {values:.3g} values is more than {MOST_VALUES:.0e}: give a longer --step or --output-interval"
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


# Runs an FMU by fmpy's simulation, whose CVODE moves the states and finds the events of Model Exchange

TOLERANCE = 1e-8  # relative, where neither the user nor the FMU says one
WARNING = 1  # fmi2Warning, fmi3Warning


def exchange(
    experiment: Experiment, interval: float | None = None, advance: Callable[[float], None] = lambda time: None
) -> Result:
    """`interval`: time between rows of the result, s; events have rows too"""
    return by_fmpy(experiment, "modelExchange", interval, advance)


def by_fmpy(
    experiment: Experiment,
    kind: str,
    interval: float | None = None,
    advance: Callable[[float], None] = lambda time: None,
) -> Result:
    """`kind`: coSimulation or modelExchange"""
    folder, description = unpack(experiment.fmu, kind=kind)
    variables, times = read_variables(description), communication_points(experiment)
    told: list[tuple[int, str]] = []
    begun: list[float] = []

    def step_finished(time: float, _recorder: Any) -> bool:
        begun.append(time)
        advance(time)
        return True

    values = {**experiment.values, **_inputs(experiment, experiment.start_time)}
    for name in values:
        known(name, variables, experiment.fmu)
    try:
        rows = fmpy.simulate_fmu(
            str(folder),
            validate=False,
            model_description=description,
            fmi_type=kind[0].upper() + kind[1:],
            start_time=experiment.start_time,
            stop_time=experiment.stop_time,
            start_values=_as_described(description, _by_scalar(variables, values)),
            input=_signals(experiment, times, description, variables),
            output=[one.name for one in description.modelVariables if one.causality in RECORDED],
            output_interval=experiment.step if interval is None else max(interval, experiment.step),
            relative_tolerance=experiment.tolerance or (TOLERANCE if kind == "modelExchange" else None),
            logger=lambda *given: told.append((given[-3], text_of(given[-1]))),
            step_finished=step_finished,
        )
    except Exception as error:  # fmpy raises what its parts raise, of a dozen kinds
        said = [text for status, text in told if status > WARNING] or [" ".join(str(error).split())]
        where = f"at {begun[-1]!r} s: " if begun else f"{experiment.fmu.name}: "
        raise (RunFailure if begun else UserError)(where + " ".join(said)) from None
    columns = _columns(rows, description, variables)
    units = {name: variables[name].unit for name in columns}
    warnings = list(dict.fromkeys(text for status, text in told if status == WARNING))
    parameters = _parameters(description, variables, experiment)
    return Result(np.asarray(rows["time"]), columns, units, experiment.fmu.resolve(), parameters, warnings)


def _parameters(description: Any, variables: dict[str, Variable], experiment: Experiment) -> dict[str, Any]:
    """Start values of the description, and those of the experiment"""
    described = [one for one in scalars(description) if one.causality in PARAMETERS and one.start is not None]
    given = _by_scalar(variables, experiment.values)
    return {one.name: _described_start(variables[one.name], one.start) for one in described} | {
        name: plain(variables[name], value) for name, value in given.items() if variables[name].causality in PARAMETERS
    }


def _inputs(experiment: Experiment, time: float) -> dict[str, Any]:
    return {signal.variable: signal.evaluate(time, 0) for signal in experiment.inputs}


def _by_scalar(variables: dict[str, Variable], values: dict[str, Any]) -> dict[str, Any]:
    """Numbers by the names of scalars, enumerations' items among them"""
    found = {}
    for name, value in values.items():
        variable = variables[name]
        if variable.is_vector:
            parts = {f"{name}[{place}]": one for place, one in enumerate(np.atleast_1d(value).tolist(), 1)}
        else:
            parts = {name: np.atleast_1d(value).tolist()[0]}
        found |= {one: item_value(variable, v) if variable.items else v for one, v in parts.items()}
    return found


def _as_described(description: Any, given: dict[str, Any]) -> dict[str, Any]:
    """FMI 3.0's arrays are given whole: what nobody sets keeps its start value."""
    if not is_fmi3(description):
        return given
    wholes: dict[str, list] = {}
    chosen = set()
    for (variable, _, _), scalar in zip(entries(description), scalars(description), strict=True):
        wholes.setdefault(variable.name, []).append(given.get(scalar.name, scalar.start))
        if scalar.name in given:
            chosen.add(variable.name)
    return {name: whole if len(whole) > 1 else whole[0] for name, whole in wholes.items() if name in chosen}


def _signals(
    experiment: Experiment, times: Sequence[float], description: Any, variables: dict[str, Variable]
) -> np.ndarray | None:
    """Inputs at the communication points, between which fmpy draws straight lines"""
    if not experiment.inputs:
        return None
    rows = [_as_described(description, _by_scalar(variables, _inputs(experiment, time))) for time in times]
    kinds = [("time", float), *((name, float, np.shape(value)) for name, value in rows[0].items())]
    return np.array([(time, *row.values()) for time, row in zip(times, rows, strict=True)], dtype=kinds)


def _columns(rows: np.ndarray, description: Any, variables: dict[str, Variable]) -> dict[str, np.ndarray]:
    """Of fmpy's result, arrays entry by entry, in the order of the description"""
    places = [index for _, index, _ in entries(description)] if is_fmi3(description) else None
    names = [one.name for one in description.modelVariables for _ in range(int(np.prod(one.shape or (1,))))]
    found = {}
    for number, scalar in enumerate(scalars(description)):
        name = names[number]
        if scalar.causality not in RECORDED or scalar.type not in READERS or name not in rows.dtype.names:
            continue
        values = rows[name].reshape(len(rows), -1)[:, places[number] if places else 0]
        found[scalar.name] = np.array([plain(variables[scalar.name], one) for one in values])
    return found


def _described_start(variable: Variable, text: Any) -> Any:
    if variable.type == "Boolean":
        return str(text).lower() in ("true", "1")
    if variable.type == "Real":
        return float(text)
    return plain(variable, int(text)) if variable.type in READERS else text
