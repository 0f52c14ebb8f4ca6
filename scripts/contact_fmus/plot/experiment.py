"""What is to be run: an FMU with settings, or one variant of a scenario"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import fmu_file, unpack
from contact_fmus.fmu.scene import has_scene, read_scene
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


def of_fmu(fmu: Path, settings: dict[str, Any], stop: float | None = None) -> Experiment:
    """`stop`: else the end that the FMU itself proposes"""
    description = unpack(fmu)[1]
    proposed = description.defaultExperiment
    if stop is None:
        stop = float(proposed.stopTime) if proposed is not None and proposed.stopTime else STOP
    tolerance = float(proposed.tolerance) if proposed is not None and proposed.tolerance else None
    title = read_scene(fmu).title if has_scene(fmu) else description.modelName
    return _checked(Experiment(title, fmu, stop, settings, tolerance=tolerance))


def of_scenario(
    scenario: Scenario, variant: Variant, settings: dict[str, Any], stop: float | None = None
) -> Experiment:
    try:
        fmu = fmu_file(scenario.fmu)
    except FileNotFoundError as error:
        raise UserError(f"{scenario.name}: {error}") from None
    return _checked(
        Experiment(
            scenario.title,
            fmu,
            scenario.stop_time if stop is None else stop,
            variant.start | settings,
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


def read_settings(texts: Iterable[str]) -> dict[str, Any]:
    """NAME=VALUE: a number, true or false, an enumeration's item, [x, y, z] or x,y,z"""
    settings = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise UserError(f"--set {text}: NAME=VALUE is needed, such as contact.dashpot=unclamped")
        settings[name.strip()] = _value(value.strip())
    return settings


def _value(text: str) -> Any:
    listed = f"[{text}]" if "," in text and not text.startswith("[") else text
    try:
        return json.loads(listed)
    except json.JSONDecodeError:
        return text
