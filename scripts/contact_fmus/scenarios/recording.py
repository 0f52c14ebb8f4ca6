"""Steps an FMU through an experiment and keeps what it tells, with rows on both sides of each onset and release"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, fmu_file
from contact_fmus.fmu.touching import Touching
from contact_fmus.fmu.variables import known, plain
from contact_fmus.results import Result

from .experiment import ENERGIES, Experiment, Recording, RunError, Scenario, Variant

RECORDED = ("output", "input")
PARAMETERS = ("parameter", "calculatedParameter")
READERS = {"Real": "getReal", "Integer": "getInteger", "Enumeration": "getInteger", "Boolean": "getBoolean"}
MOST_VALUES = 200_000_000  # of a result: 1.6 GB
RELATIVE_TOLERANCE = "solver.relative_tolerance"  # of the FMUs here; the tolerance of the experiment replaces it

# A contact may last a millionth of the run. A result that is drawn has points before, in and after each contact.
POINTS = 600  # of a run besides those of contacts: as many as a screen shows, and as many frames in 10 s
DENSE = 8000  # shared by all contacts of a run
FEWEST, MOST = 5, 32  # points of one contact
AHEAD = 100  # each contact gets this part of the points that are left

# What a scenario's recording has of every body, of every contact, of the world, where the FMU has it
OF_BODIES = ("position", "velocity", "orientation", "angular_velocity", "current_axis")
OF_BODIES += ("prescribed_displacement", "prescribed_velocity")
OF_CONTACTS = ("gap", "gap_rate", "normal_force", "peak_force", "source_force", "destination_force")
OF_CONTACTS += ("onsets", "last_onset_time", "last_duration")


class StoppedEarly(RunFailure):
    """The FMU refused a step; `result` is what there was until then"""

    def __init__(self, text: str, result: Result):
        super().__init__(text)
        self.result = result


class Recorder:
    """Rows of scalars, read by one call for each type"""

    def __init__(self, fmu: ContactFmu, names: Sequence[str]):
        self.fmu, self.names, self.times = fmu, names, []
        self.groups: dict[str, list[str]] = {}
        for name in names:
            self.groups.setdefault(READERS[fmu.variables[name].type], []).append(name)
        self.references = {
            function: [fmu.variables[name].references[0] for name in group] for function, group in self.groups.items()
        }
        self.rows: dict[str, list] = {function: [] for function in self.groups}

    def row(self) -> None:
        self.times.append(self.fmu.time)
        for function, references in self.references.items():
            self.rows[function].append(self.fmu.call(function, references))

    def columns(self) -> dict[str, np.ndarray]:
        """The columns in the order of the names. A row that the FMU refused half-way is left out."""
        whole = min(map(len, self.rows.values()), default=len(self.times))
        self.times = self.times[:whole]
        found = {
            name: np.array([plain(self.fmu.variables[name], row[index]) for row in self.rows[function][:whole]])
            for function, group in self.groups.items()
            for index, name in enumerate(group)
        }
        return {name: found[name] for name in self.names}


def set_inputs(fmu: ContactFmu, experiment: Experiment | Scenario, time: float) -> None:
    for signal in experiment.inputs:
        fmu[signal.variable] = signal.evaluate(time, 0)
        for order in range(1, signal.derivatives + 1):
            fmu.set_derivative(signal.variable, signal.evaluate(time, order), order)


def begin(fmu: ContactFmu, experiment: Experiment | Scenario, values: dict[str, Any], tolerance: float | None) -> None:
    """Initializes the FMU with the start values and the inputs of the start"""
    start = experiment.start_time
    given = values | {signal.variable: signal.evaluate(start, 0) for signal in experiment.inputs}
    fmu.start(given, tolerance, start, experiment.stop_time)
    set_inputs(fmu, experiment, start)


def simulate(
    experiment: Experiment,
    interval: float | None = None,
    advance: Callable[[float], None] = lambda time: None,
    within: bool = False,
) -> Result:
    """Rows at communication points and right before and after each onset and release. `interval`: time between the
    former, s; without it every communication step has a row. `within`: some within and beside each contact too."""
    times = communication_points(experiment)
    every = 1 if interval is None else max(1, round(interval / experiment.step))

    def wanted(index: int, rows: int) -> tuple[bool, int]:
        advance(times[index])
        return index % every == 0 or index == len(times) - 1, _within(index, rows) if within else 0

    return _result(experiment, times, every, wanted, RECORDED)


def record_densely(experiment: Experiment, points: int = POINTS) -> Result:
    """`points` of the run in all, and some within and beside each contact"""
    times = np.linspace(experiment.start_time, experiment.stop_time, points + 1)

    def wanted(index: int, rows: int) -> tuple[bool, int]:
        return True, _within(index, rows)

    return _result(experiment, times, 1, wanted, (*RECORDED, "local"), ("Real", "Integer", "Boolean"))


def _within(index: int, rows: int) -> int:
    """How many points the next contact gets, `rows` after the start, of which `index` are no contacts'"""
    return int(np.clip((DENSE + index - rows) // AHEAD, FEWEST, MOST))


def _result(
    experiment: Experiment,
    times: Sequence[float],
    every: int,
    wanted: Callable[[int, int], tuple[bool, int]],
    causalities: tuple[str, ...],
    types: Sequence[str] = tuple(READERS),
) -> Result:
    """`wanted`: whether a communication point has a row, and how many points the next contact gets"""
    with ContactFmu(experiment.fmu) as fmu:
        every_scalar = {name: one for name, one in fmu.variables.items() if not one.is_vector}
        names = [name for name, one in every_scalar.items() if one.causality in causalities and one.type in types]
        refuse_too_much(len(names) * (len(times) // every))
        _start(fmu, experiment)
        recorder = Recorder(fmu, names)
        every_name = [name for name, one in fmu.variables.items() if one.causality in PARAMETERS]
        parameters = {name: fmu[name] for name in every_name if fmu.variables[name].type in READERS}
        parameters = {name: one.tolist() if isinstance(one, np.ndarray) else one for name, one in parameters.items()}
        touching, inside = Touching(fmu), 0

        def result() -> Result:
            columns, units = recorder.columns(), {name: fmu.variables[name].unit for name in names}
            time = np.array(recorder.times)
            return Result(time, columns, units, experiment.fmu.resolve(), parameters, fmu.warnings())

        try:
            for index, time in enumerate(times):
                if index > 0:
                    for _ in touching.step(time, inside):
                        recorder.row()
                    set_inputs(fmu, experiment, time)
                kept, inside = wanted(index, len(recorder.times))
                if kept:
                    recorder.row()
        except FmuError as error:
            raise StoppedEarly(f"at {fmu.time!r} s: {said(error)}", result()) from None
        return result()


def communication_points(experiment: Experiment) -> list[float]:
    """Whole steps and, where they do not end there, a shorter one to stop_time"""
    length = experiment.stop_time - experiment.start_time
    if not length > 0.0:
        raise UserError(f"the end at {experiment.stop_time} s is not after the start at {experiment.start_time} s")
    if not experiment.step > 0.0:
        raise UserError(f"a communication step of {experiment.step} s is not greater than 0")
    refuse_too_much(length / experiment.step)
    # A quotient that is whole but for its rounding counts as whole.
    count = max(1, math.ceil(length / experiment.step * (1.0 - 1e-12)))
    return [*(experiment.start_time + index * experiment.step for index in range(count)), experiment.stop_time]


def said(error: FmuError) -> str:
    """What the FMU said, in its own words where it has any"""
    texts = [message.text for message in error.messages if message.text]
    return " ".join(texts) or str(error)


def refuse_too_much(values: float) -> None:
    if values > MOST_VALUES:
        text = f"a result of {values:.3g} values is more than {MOST_VALUES:.0e}"
        raise UserError(f"{text}: give a longer --step or --output-interval")


def _check_tolerance(fmu: ContactFmu, experiment: Experiment) -> None:
    """An FMU takes the nearest tolerance that it allows: here that would be another one than was asked for"""
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
    for name in (*experiment.values, *(signal.variable for signal in experiment.inputs)):
        known(name, fmu.variables, experiment.fmu)
    try:
        begin(fmu, experiment, experiment.values, experiment.tolerance)
    except (FmuError, ValueError) as error:
        text = said(error) if isinstance(error, FmuError) else error
        raise UserError(f"{experiment.fmu.name}: {text}") from None


# Runs of scenarios


def recorded(fmu: ContactFmu) -> list[str]:
    """The names that a recording keeps; a vector goes by its name without index"""
    names = [name for name in fmu.variables if not name.endswith("]")]
    energies = [f"energy.{name}" for name in (*ENERGIES, "external_work")]
    return [name for name in names if name in energies or name.partition(".")[2] in OF_BODIES + OF_CONTACTS]


def record(scenario: Scenario, variant: Variant) -> Recording:
    """Rows at the communication points"""
    try:
        with ContactFmu(fmu_file(scenario.fmu)) as fmu:
            begin(fmu, scenario, variant.start, variant.tolerance)
            return _recording(fmu, scenario, variant)
    except (FmuError, KeyError, ValueError, FileNotFoundError) as error:
        where = f"{scenario.name} ({variant.label})" if variant.label else scenario.name
        raise RunError(f"{where}: {error.args[0] if isinstance(error, KeyError) else error}") from None


def _recording(fmu: ContactFmu, scenario: Scenario, variant: Variant) -> Recording:
    names, initial = recorded(fmu), _snapshot(fmu)
    parts = {name: [f"{name}[{i + 1}]" for i in range(len(fmu.variables[name].references))] for name in names}
    parts = {name: found if fmu.variables[name].is_vector else [name] for name, found in parts.items()}
    recorder = Recorder(fmu, [one for found in parts.values() for one in found])
    recorder.row()
    # Communication points are fractions of the whole: the last one is stop_time, not a sum of roundings.
    for time in np.linspace(scenario.start_time, scenario.stop_time, variant.steps + 1)[1:]:
        fmu.step(time - fmu.time)
        set_inputs(fmu, scenario, time)
        recorder.row()
    columns = recorder.columns()
    series = {
        name: np.column_stack([columns[one] for one in found]) if fmu.variables[name].is_vector else columns[name]
        for name, found in parts.items()
    }
    times = np.array(recorder.times)
    return Recording(scenario, variant, times, series, initial, _snapshot(fmu), fmu.warnings())


def _snapshot(fmu: ContactFmu) -> dict[str, Any]:
    """Every variable; a vector under its name without index, too"""
    return {name: fmu[name] for name in fmu.variables}
