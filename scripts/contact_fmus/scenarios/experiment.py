"""What a scenario is, once read, and what a run of it leaves: the types that all other files here share"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure
from contact_fmus.fmu.files import fmu_file, repository
from contact_fmus.fmu.scene import has_scene, read_scene

from .inputs import InputSignal
from .motion import Motion


@dataclass(frozen=True)
class Claim:
    check: str
    text: str
    allowed: float
    relative: bool
    options: dict[str, Any] = field(default_factory=dict)
    when: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Variant:
    """One run of a scenario: what [vary] chose for it"""

    choice: dict[str, Any]
    start: dict[str, Any]
    steps: int
    tolerance: float | None

    @property
    def label(self) -> str:
        return ", ".join(_describe(name, value) for name, value in self.choice.items())


@dataclass(frozen=True)
class Scenario:
    name: str
    title: str
    description: str
    fmu: str
    start_time: float
    stop_time: float
    variants: list[Variant]
    inputs: list[InputSignal]
    claims: list[Claim]
    plot_steps: int
    plot_compare: str | None

    def plotted(self) -> list[Variant]:
        """The runs that are drawn: the last choice of everything but what is compared"""
        last = self.variants[-1].choice
        drawn = [
            variant
            for variant in self.variants
            if all(value == last[name] for name, value in variant.choice.items() if name != self.plot_compare)
        ]
        return [
            Variant(
                {name: value for name, value in variant.choice.items() if name == self.plot_compare},
                variant.start,
                self.plot_steps,
                variant.tolerance,
            )
            for variant in drawn
        ]


def _describe(name: str, value: Any) -> str:
    """A choice in words: cvode_bdf; 10 steps; finite_length true; penalty_factor 1e+06"""
    if isinstance(value, str):
        return value
    if name == "steps":
        return f"{value} step{'' if value == 1 else 's'}"
    if isinstance(value, list):
        text = "(" + ", ".join(f"{entry:g}" for entry in value) + ")"
    else:
        text = str(value).lower() if isinstance(value, bool) else f"{value:g}"
    return f"{name.split('.')[-1]} {text}"


class RunError(RunFailure):
    """The FMU refused something, or lacks a variable the scenario names"""


@dataclass(frozen=True)
class Recording:
    scenario: Scenario
    variant: Variant
    time: np.ndarray
    series: dict[str, np.ndarray]  # recorded names, one row a communication point
    initial: dict[str, Any]  # every variable after initialization
    final: dict[str, Any]  # every variable at the end

    def value(self, name: str) -> Any:
        """A parameter, pinned or open, or an output at the start"""
        if name in self.initial:
            return self.initial[name]
        pinned = pinned_values(self.scenario.fmu)
        if name in pinned:
            return pinned[name]
        raise RunError(f"{self.scenario.name}: {self.scenario.fmu} has no variable {name}")

    @cached_property
    def motion(self) -> Motion:
        """The run as pictures need it"""

        def value(name: str) -> Any:
            return self.value(name) if self.has(name) else None

        return Motion(read_scene(fmu_file(self.scenario.fmu)), self.time, value, self.series.get)

    def has(self, name: str) -> bool:
        return name in self.initial or name in pinned_values(self.scenario.fmu)


@cache
def scene_file(fmu: str) -> dict[str, Any]:
    """The scene an FMU was built from; empty for an FMU from elsewhere"""
    path = repository() / "modelDescription" / "scenes" / f"{fmu}.toml"
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


@cache
def pinned_values(fmu: str) -> dict[str, Any]:
    """What the FMU's scene pins, so that it is no variable any more; empty for an FMU from elsewhere"""
    file = fmu_file(fmu)
    return read_scene(file).pinned if has_scene(file) else {}
