"""Runs an FMU by fmpy's simulation, whose CVODE moves the states and finds the events of Model Exchange"""

from collections.abc import Callable, Sequence
from typing import Any

import fmpy
import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.files import unpack
from contact_fmus.fmu.slaves import text_of
from contact_fmus.fmu.variables import (
    Variable,
    entries,
    is_fmi3,
    item_value,
    known,
    plain,
    read_variables,
    scalars,
    start_values,
)
from contact_fmus.results import Result
from contact_fmus.scenarios.experiment import Experiment
from contact_fmus.scenarios.recording import PARAMETERS, READERS, RECORDED, communication_points

TOLERANCE = 1e-8  # relative, where neither the user nor the FMU says one
WARNING = 1  # fmi2Warning, fmi3Warning


def by_fmpy(
    experiment: Experiment,
    interval: float | None = None,
    advance: Callable[[float], None] = lambda time: None,
    kind: str = "modelExchange",
) -> Result:
    """`interval`: time between rows of the result, s; events have rows too. `kind`: coSimulation or modelExchange"""
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
    # Start values of the description, and those of the experiment
    given = _by_scalar(variables, experiment.values)
    parameters = start_values(description) | {name: plain(variables[name], value) for name, value in given.items()}
    parameters = {name: value for name, value in parameters.items() if variables[name].causality in PARAMETERS}
    return Result(np.asarray(rows["time"]), columns, units, experiment.fmu.resolve(), parameters, warnings)


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
    """The columns of fmpy's result are the scalars in the order of the description."""
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
