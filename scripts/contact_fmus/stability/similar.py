"""Oblique scenes in other units: the same motion with lengths, masses and times multiplied by powers of two.
Every number given to the FMU is then exactly that of the original but for its exponent, so the end is that of
oblique_references.json, scaled, however extreme the units are.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .expected import EPSILON, Expected

FILE = Path(__file__).parent / "oblique_references.json"


class Units(NamedTuple):
    """Powers of two"""

    length: int = 0
    mass: int = 0
    time: int = 0

    def factor(self, length: int = 0, mass: int = 0, time: int = 0) -> float:
        return 2.0 ** (length * self.length + mass * self.mass + time * self.time)


UNCHANGED = Units()

# Dimension of a variable by the end of its name: powers of length, mass, time.
DIMENSIONS = {
    "radius": (1, 0, 0),
    "mass": (0, 1, 0),
    "center": (1, 0, 0),
    "length": (1, 0, 0),
    "displacement": (1, 0, 0),
    "velocity": (1, 0, -1),
    "external_force": (1, 1, -2),
    "gravity": (1, 0, -2),
    "penalty_factor": (0, 1, -2),
    "viscous_penalty_factor": (0, 1, -1),
    "reference_modulus": (-1, 1, -2),
    "characteristic_time": (0, 0, 1),
}
FREE_OF_UNITS = ("axis", "multiplier", "finite_length", "motion", "location", "method", "control", "dashpot")
START = {"source.mass": 1.0, "destination.mass": 1.0, "contact.reference_modulus": 1e9}
START |= {"contact.characteristic_time": 1e-4, "contact.viscous_penalty_factor": 100.0}
START |= {"gravity": [0.0, 0.0, -9.81]}


def dimension(name: str) -> tuple[int, int, int] | None:
    """None: free of units"""
    last = name.rsplit(".", 1)[-1]
    if any(last.endswith(end) for end in FREE_OF_UNITS):
        return None
    return DIMENSIONS[max((end for end in DIMENSIONS if last.endswith(end)), key=len)]


@functools.cache
def bases() -> list[dict[str, Any]]:
    return json.loads(FILE.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Similar:
    """A scene of oblique_references.json by its number, in other units"""

    number: int
    units: Units = UNCHANGED

    @property
    def base(self) -> dict[str, Any]:
        return bases()[self.number]

    @property
    def fmu(self) -> str:
        return {"sphere": "SphereSphere", "cylinder": "SphereCylinder"}[self.base["shape"]]

    @property
    def geometry(self) -> str:
        return f"{self.base['shape']} {self.base['values'].get('contact.location', '')}".strip()

    @property
    def law(self) -> str:
        values = self.base["values"]
        if values.get("contact.penalty_control") == "viscous_only":
            return "viscous_only"
        return "undamped" if values["contact.method"] == "penalty" else values["contact.dashpot"]

    @property
    def end(self) -> float:
        return self.base["end"] * self.units.factor(time=1)

    @property
    def scale(self) -> float:
        """A length of the scene"""
        return 0.125 * self.units.factor(length=1)

    @property
    def stored_penalty(self) -> float:
        """Not needed here: nothing is pressed that was not fast before"""
        return 0.0

    def configuration(self) -> dict[str, Any]:
        """All that has a unit is given, with "<input>.derivatives" as lists of first and second ones"""
        values = START | self.base["values"]
        return {name: self._scaled(name, value) for name, value in values.items()}

    def _scaled(self, name: str, value: Any) -> Any:
        if name.endswith(".derivatives"):
            powers = dimension(name.removesuffix(".derivatives"))
            factors = [self.units.factor(*powers) * self.units.factor(time=-k) for k in (1, 2)]
            return [(f * np.array(row)).tolist() for f, row in zip(factors, value, strict=False)]
        powers = dimension(name)
        if powers is None:
            return value
        scaled = self.units.factor(*powers) * np.array(value, dtype=float)
        return scaled.tolist() if scaled.ndim else float(scaled)

    def masses(self) -> tuple[float, float | None]:
        values = self.configuration()
        free = values.get("destination.motion") == "free"
        return values["source.mass"], values["destination.mass"] if free else None

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        """What gravity and the external force have passed to a body"""
        values = self.configuration()
        rows = [values.get(f"{body}.external_force", [0.0] * 3)]
        rows += values.get(f"{body}.external_force.derivatives", [])
        impulse = values[f"{body}.mass"] * np.array(values["gravity"]) * time
        for order, (row, divisor) in enumerate(zip(rows, (1, 2, 6), strict=False)):
            impulse = impulse + np.array(row) * time ** (order + 1) / divisor
        return impulse

    def passive(self) -> bool:
        values = self.base["values"]
        moved = values.get("destination.motion") == "prescribed" or values.get("destination.finite_length")
        return not moved and not any("external_force" in name for name in values)

    def swings(self, time: float) -> float:
        """None that last long"""
        return 0.0

    def expected(self) -> Expected:
        base, length = self.base, self.units.factor(length=1)
        moved = np.array(base["displacement"]) * length
        free = ["source", "destination"] if self.masses()[1] is not None else ["source"]
        way = float(max(np.linalg.norm(moved[:3]), np.linalg.norm(moved[3:])))
        velocity = np.array(base["velocity"]) * self.units.factor(length=1, time=-1)
        condition = 1 + base["condition"]["displacement"]
        time = self.units.factor(time=1)
        return Expected(
            displacement={body: list(moved[3 * i : 3 * i + 3]) for i, body in enumerate(free)},
            way=max(way, 0.1 * length),
            rounding=8 * EPSILON * condition * length,
            fastest=float(np.linalg.norm(velocity[:3])),
            onsets=base["onsets"],
            sure=base["steady"],
            strong=0,
            last_onset=base["contact.last_onset_time"] * time if base["onsets"] else None,
        )


def unit_systems() -> Iterator[tuple[str, int, Units]]:
    """Which unit, its power of two, and all three"""
    yield "length", 0, UNCHANGED
    for power in (-30, -20, -10, 10, 20):
        yield "length", power, Units(length=power)
    for power in (-30, -20, -10, 10, 20, 30):
        yield "mass", power, Units(mass=power)
    for power in (-30, -20, -10, 10, 20):
        yield "time", power, Units(time=power)
    for power in (-20, -10, 10, 20):
        yield "all", power, Units(power, -power, power // 2)
