"""What is to be run: an FMU with settings, or one variant of a scenario"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import fmu_file, unpack
from contact_fmus.fmu.scene import has_scene, read_scene
from contact_fmus.fmu.settings import read_settings
from contact_fmus.fmu.variables import read_variables
from contact_fmus.scenarios.experiment import Scenario, Variant
from contact_fmus.scenarios.inputs import InputSignal

STOP = 1.0  # s, where an FMU names no end of its own


@dataclass(frozen=True)
class Experiment:
    title: str
    fmu: Path
    stop: float  # s
    start: dict[str, Any] = field(default_factory=dict)
    inputs: tuple[InputSignal, ...] = ()
    start_time: float = 0.0  # s
    tolerance: float | None = None
    label: str = ""  # what tells it from the other runs of a scenario


def of_fmu(fmu: Path, settings: Iterable[str], stop: float | None = None) -> Experiment:
    """`settings`: NAME=VALUE; `stop`: else the end that the FMU itself proposes"""
    description = unpack(fmu)[1]
    proposed = description.defaultExperiment
    if stop is None:
        stop = float(proposed.stopTime) if proposed is not None and proposed.stopTime else STOP
    tolerance = float(proposed.tolerance) if proposed is not None and proposed.tolerance else None
    title = read_scene(fmu).title if has_scene(fmu) else description.modelName
    start = read_settings(settings, read_variables(description), fmu.name)
    return _checked(Experiment(title, fmu, stop, start, tolerance=tolerance))


def of_scenario(
    scenario: Scenario, variant: Variant, settings: Iterable[str], stop: float | None = None
) -> Experiment:
    try:
        fmu = fmu_file(scenario.fmu)
    except FileNotFoundError as error:
        raise UserError(f"{scenario.name}: {error}") from None
    start = read_settings(settings, read_variables(unpack(fmu)[1]), fmu.name)
    return _checked(
        Experiment(
            scenario.title,
            fmu,
            scenario.stop_time if stop is None else stop,
            variant.start | start,
            tuple(scenario.inputs),
            scenario.start_time,
            variant.tolerance,
            variant.label,
        )
    )


def _checked(experiment: Experiment) -> Experiment:
    if not experiment.start_time < experiment.stop < float("inf"):
        raise UserError(f"--stop {experiment.stop:g}: a time after {experiment.start_time:g} s is needed")
    return experiment
