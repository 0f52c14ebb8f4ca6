"""What a user names made a run: a result's file, an FMU or a scenario"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.files import fmu_file, fmus_folder, repository, unpack
from contact_fmus.fmu.scene import Scene, read_scene
from contact_fmus.results import Result
from contact_fmus.scenarios.motion import Motion
from contact_fmus.scenarios.scenario import ScenarioError, read_scenario

from .experiment import Experiment, of_fmu, of_scenario
from .record import record_densely

KINDS = "a result (.csv), an FMU (.fmu) or a scenario (.toml)"


@dataclass(frozen=True)
class Run:
    title: str
    label: str  # what tells it from the other runs of a scenario
    result: Result


def open_runs(name: str, settings: Sequence[str], stop: float | None, fmu: Path | None = None) -> list[Run]:
    """One run, or those that a scenario compares. `settings`: NAME=VALUE; `fmu`: for results naming none."""
    path = find(name)
    if path.suffix == ".csv":
        if settings or stop is not None:
            raise UserError(f"{path}: --set and --stop are for runs; this one is over")
        result = Result.read(path)
        if len(result.time) < 2:
            raise UserError(f"{path}: {len(result.time)} row of values; two are needed")
        result.fmu = fmu or result.fmu
        return [Run(path.stem, "", result)]
    experiments = _experiments(path, settings, stop)
    return [Run(one.title, one.label, record_densely(one)) for one in experiments]


def _experiments(path: Path, settings: Sequence[str], stop: float | None) -> list[Experiment]:
    if path.suffix == ".fmu":
        with readable(path):
            return [of_fmu(path, settings, stop)]
    try:
        scenario = read_scenario(path)
    except ScenarioError as error:
        raise UserError(str(error)) from None
    return [of_scenario(scenario, variant, settings, stop) for variant in scenario.plotted()]


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


def find(name: str) -> Path:
    """The file of this name, or the shipped FMU or scenario"""
    path = Path(name)
    if path.suffix in (".csv", ".fmu", ".toml"):
        if not path.is_file():
            raise UserError(f"{name}: no such file{similar(path.name, _neighbours(path))}")
        return path
    if path.is_file() or path.is_dir():
        raise UserError(f"{name}: {KINDS} is needed")
    scenarios = {file.stem: file for file in (repository() / "scripts" / "scenarios").glob("*.toml")}
    fmus = [file.stem for file in fmus_folder().glob("*.fmu")]
    if name in fmus:
        return fmu_file(name)
    if name in scenarios:
        return scenarios[name]
    raise UserError(f"no FMU or scenario '{name}'{similar(name, [*fmus, *scenarios])}; {KINDS} will do")


def _neighbours(path: Path) -> list[str]:
    return [file.name for file in path.parent.glob("*.*")] if path.parent.is_dir() else []


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
    for scalar in unpack(fmu)[1].modelVariables:
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
