"""An FMU as a file: its description and its loaded library. Instances of it are raw.py's."""

from __future__ import annotations

import copy
import functools
from pathlib import Path
from typing import Any, NamedTuple

from contact_fmus.fmu.files import fmu_file, repository, unpack
from support.fmi2.prototypes import bind

SCENES = sorted(path.stem for path in (repository() / "modelDescription" / "scenes").glob("*.toml"))
# Every choice open; bodies that cannot move freely; everything pinned, and no CVODE.
KINDS = ("SphereCylinder", "ForceElement", "PinnedEvent")
# A body may move freely: every choice open, pinned, Hertz's law, friction, no CVODE.
SOLVER_SCENES = ("SphereCylinder", "BallOffRoller", "HertzImpact", "GolfersDilemma", "PinnedEvent")
WITHOUT_CVODE = ("BouncingBall", "PinnedEvent")  # pinned to event_driven, no body in two contacts


class Variable(NamedTuple):
    """A ScalarVariable of the model description"""

    name: str
    reference: int
    type: str  # Real | Integer | Boolean | Enumeration
    causality: str
    start: str | None
    minimum: float
    maximum: float
    items: tuple[str, ...]  # an enumeration's item names; their values run from `minimum` on
    variability: str

    @property
    def call_type(self) -> str:
        """The part of fmi2Get... and fmi2Set... that fits"""
        return "Integer" if self.type == "Enumeration" else self.type

    @property
    def settable(self) -> bool:
        return self.causality in ("parameter", "input")

    @property
    def start_value(self) -> float | int:
        return _number(self.start, self.type)


def _number(text: str, kind: str) -> float | int:
    if kind == "Real":
        return float(text)
    return {"true": 1, "false": 0}[text] if kind == "Boolean" else int(text)


class Fmu:
    """An unpacked FMU with its loaded library"""

    def __init__(self, path: Path):
        self.folder, description = unpack(path)
        self.name = description.coSimulation.modelIdentifier
        self.guid = description.guid
        self.variables = {one.name: _variable(one) for one in description.modelVariables}
        self.roles = _roles(description)
        self._open(next(self.folder.glob(f"binaries/*/{self.name}.so")))

    def _open(self, library_file: Path) -> None:
        self.library_file = library_file
        self.library = bind(library_file)

    def with_library(self, library_file: Path) -> Fmu:
        """The same FMU with another build of its code"""
        other = copy.copy(self)
        other._open(library_file)
        return other

    def select(self, *causalities: str, kind: str | None = None) -> list[Variable]:
        return [
            variable
            for variable in self.variables.values()
            if variable.causality in causalities and kind in (None, variable.type)
        ]


def _roles(description: Any) -> dict[str, list[str]]:
    """Names of the states, of their rates, and of the event indicators, in the order of their vectors"""
    rates = [entry.variable for entry in description.derivatives]
    indicators = [one.name for one in description.modelVariables if one.name.endswith("_indicator")]
    assert len(indicators) == description.numberOfEventIndicators
    return {
        "state": [rate.derivative.name for rate in rates],
        "rate": [rate.name for rate in rates],
        "indicator": indicators,
    }


def _variable(scalar: Any) -> Variable:
    declared, enumeration = scalar.declaredType, scalar.type == "Enumeration"
    items = declared.items if enumeration else []
    values = [int(item.value) for item in items] or [0, 1]
    wide = (-1.8e308, 1.8e308) if scalar.type in ("Real", "Integer") else (values[0], values[-1])
    low, high = (
        next(
            (one for one in (getattr(scalar, name), getattr(declared, name, None)) if one is not None), limit
        )
        for name, limit in zip(("min", "max"), wide, strict=True)
    )
    names = tuple(item.name for item in items)
    about = (scalar.name, scalar.valueReference, scalar.type, scalar.causality, scalar.start)
    return Variable(*about, float(low), float(high), names, scalar.variability)


@functools.cache
def load(name: str) -> Fmu:
    return Fmu(fmu_file(name))
