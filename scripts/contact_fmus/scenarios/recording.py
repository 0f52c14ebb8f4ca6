"""Steps an FMU through a variant of a scenario and keeps what it saw"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, fmu_file
from contact_fmus.fmu.touching import Touching

from .experiment import Recording, RunError, Scenario, Variant

# Read at every communication point, where the FMU has them: of every body, of every contact, of the world
OF_BODIES = (
    "position",
    "velocity",
    "orientation",
    "angular_velocity",
    "current_axis",
    "prescribed_displacement",
    "prescribed_velocity",
)
OF_CONTACTS = (
    "gap",
    "gap_rate",
    "normal_force",
    "peak_force",
    "source_force",
    "destination_force",
    "onsets",
    "last_onset_time",
    "last_duration",
)
DRAWN = 12  # rows within a contact that a picture shows
ENERGIES = ("kinetic", "rotational", "potential", "contact", "tangential", "dissipated", "friction")
OF_THE_WORLD = (*ENERGIES, "external_work")


def recorded(fmu: ContactFmu) -> list[str]:
    """The names that a recording keeps; a vector goes by its name without index"""
    names = [name for name in fmu.variables if not name.endswith("]")]
    kept = (*OF_BODIES, *OF_CONTACTS)
    energies = [f"energy.{name}" for name in OF_THE_WORLD]
    return [name for name in names if name in energies or name.partition(".")[2] in kept]


def record(
    scenario: Scenario, variant: Variant, advance: Callable[[int], None] = lambda steps: None, inside: int = 0
) -> Recording:
    """Rows at the communication points. `advance` is told now and then how many steps were done. `inside`:
    for pictures, rows on both sides of each onset and release as well, and so many within each contact
    """
    try:
        with ContactFmu(fmu_file(scenario.fmu)) as fmu:
            start = dict(variant.start)
            for signal in scenario.inputs:
                start[signal.variable] = signal.evaluate(scenario.start_time, 0)
            fmu.start(start, variant.tolerance, scenario.start_time, scenario.stop_time)
            return _step_through(fmu, scenario, variant, advance, inside)
    except (FmuError, KeyError, ValueError, FileNotFoundError) as error:
        where = f"{scenario.name} ({variant.label})" if variant.label else scenario.name
        text = error.args[0] if isinstance(error, KeyError) else error
        raise RunError(f"{where}: {text}") from None


def _step_through(
    fmu: ContactFmu, scenario: Scenario, variant: Variant, advance: Callable[[int], None], inside: int
) -> Recording:
    names = recorded(fmu)
    rows: dict[str, list] = {name: [] for name in names}
    times: list[float] = []

    def row(time: float) -> None:
        times.append(time)
        for name in names:
            rows[name].append(fmu[name])

    initial, touching = _snapshot(fmu), Touching(fmu)
    # Communication points as fractions of the whole: the last one is stop_time, not a sum of roundings
    points = np.linspace(scenario.start_time, scenario.stop_time, variant.steps + 1)
    for index, time in enumerate(points):
        if index > 0 and inside:
            for between in touching.step(time, inside):
                row(between)
        elif index > 0:
            fmu.step(time - fmu.time)
        for signal in scenario.inputs:
            _set_input(fmu, signal, time)
        row(time)
        if index % 100 == 0 and index > 0:
            advance(100)
    advance(variant.steps % 100)
    series = {name: np.array(values) for name, values in rows.items()}
    return Recording(scenario, variant, np.array(times), series, initial, _snapshot(fmu))


def _set_input(fmu: ContactFmu, signal: Any, time: float) -> None:
    fmu[signal.variable] = signal.evaluate(time, 0)
    for order in range(1, signal.derivatives + 1):
        fmu.set_derivative(signal.variable, signal.evaluate(time, order), order)


def _snapshot(fmu: ContactFmu) -> dict[str, Any]:
    """Every variable; a vector under its name without index, too"""
    return {name: fmu[name] for name in fmu.variables}
