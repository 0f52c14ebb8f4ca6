"""What a user names made a run: a result's file, an FMU or a scenario"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import read_scene, unpack
from contact_fmus.fmu.variables import start_values
from contact_fmus.results import Result
from contact_fmus.scenarios.experiment import Motion
from contact_fmus.scenarios.recording import record_densely
from contact_fmus.scenarios.scenario import ANY, changed, drawn_runs, find


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
    experiments = [changed(one, settings, stop) for one in drawn_runs(path)]
    runs = [Run(one.title, one.label, record_densely(one)) for one in experiments]
    for run in runs:
        run.result.tell_warnings()
    return runs


def motion_of(result: Result) -> Motion:
    """UserError where nothing tells the scene"""
    if result.fmu is None:
        raise UserError("the result does not say which FMU made it: name it by --fmu")
    fmu = Path(result.fmu)
    if not fmu.is_file():
        raise UserError(f"{fmu}, which made the result, does not exist: name it by --fmu")
    scene, starts = read_scene(fmu), _start_values(fmu)
    names = [contact.name for contact in scene.contacts]
    if not any(f"{name}.gap" in result.columns for name in names):  # bodies would be shown that stand still
        raise UserError(f"{result.fmu}: the result has no gap of its contacts ({', '.join(names)})")

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


def _start_values(fmu: Path) -> dict[str, Any]:
    """Start values of the description: what holds where a result does not say what was set"""
    found: dict[str, Any] = {}
    for scalar, value in start_values(unpack(fmu)[1]).items():
        name, bracket, _ = scalar.partition("[")
        if bracket:
            found.setdefault(name, []).append(value)
        else:
            found[name] = value
    return found
