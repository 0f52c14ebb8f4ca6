"""Head-on scenes: the FMU's start values and the closed form of the same motion, from one set of numbers.

Bodies meet along z; a cylinder lies along y, so that motion along y is free of the contact. The source comes
from +z outside and goes to -z inside a hollow destination, where gravity and the push point too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpmath import mp, mpf

from .line_motion import DIGITS, Line, damping_ratio

GEOMETRIES = ("sphere outside", "sphere inside", "cylinder outside", "cylinder inside")
PLANE = "plane"  # its normal is that along z; it has an axis of its own, and no radius
LAWS = ("undamped", "non_adhesive", "unclamped", "approach_only", "viscous_only")


@dataclass(frozen=True)
class HeadOn:
    """SI units. Without `damping` the dashpot has `ratio` of the critical damping. `source_mass` meets a
    fixed destination, or a free one of `destination_mass`."""

    geometry: str = "sphere outside"
    law: str = "non_adhesive"
    dashpot: str = "non_adhesive"  # of viscous_only
    source_radius: float = 0.125
    destination_radius: float = 0.5
    gap: float = 0.125
    speed: float = 1.0  # towards the contact
    source_mass: float = 1.0
    destination_mass: float | None = None
    penalty: float = 1e6
    ratio: float = 0.2
    damping: float | None = None
    restitution: float | None = None  # in place of either
    gravity: float = 9.81
    force: float = 0.0  # on the source, into the contact
    offset: float = 0.0  # of both bodies, in all directions
    place: float | None = None  # q itself, instead of the gap
    length: float | None = None  # of a finite cylinder
    along: float = 0.0  # where the source starts along the cylinder's axis
    along_speed: float = 0.0
    prescribed: bool = False  # the destination is, and jumps
    end: float = 0.0  # 0: as long as a first contact and a flight as long as that before it

    @property
    def inside(self) -> bool:
        return self.geometry.endswith("inside")

    @property
    def fmu(self) -> str:
        if self.geometry == PLANE:
            return "SpherePlane"
        return "SphereSphere" if self.geometry.startswith("sphere") else "SphereCylinder"

    @property
    def reach(self) -> float:
        if self.geometry == PLANE:
            return self.source_radius
        return self.destination_radius + self.source_radius * (-1 if self.inside else 1)

    @property
    def stored_penalty(self) -> float:
        return 0.0 if self.law == "viscous_only" else self.penalty

    @property
    def reduced_mass(self) -> float:
        if self.destination_mass is None:
            return self.source_mass
        return self.source_mass / (1 + self.source_mass / self.destination_mass)

    @property
    def dashpot_factor(self) -> float:
        if self.law == "undamped":
            return 0.0
        if self.damping is not None:
            return self.damping
        if self.restitution is not None:
            return float(self._restitution_factor())
        return 2 * self.ratio * math.sqrt(self.penalty * self.reduced_mass)

    @property
    def kind(self) -> str:
        return {"undamped": "unclamped", "viscous_only": self.dashpot}.get(self.law, self.law)

    def source_center(self) -> list[float]:
        q = self.place
        if q is None:
            q = -(self.reach - self.gap) if self.inside else self.reach + self.gap
        return [self.offset, self.offset + self.along, self.offset + q]

    def configuration(self) -> dict[str, Any]:
        values = {
            "source.radius": self.source_radius,
            "source.mass": self.source_mass,
            "source.center": self.source_center(),
            "destination.center": [self.offset] * 3,
            "source.initial_velocity": [0.0, self.along_speed, -self.speed],
            "gravity": [0.0, 0.0, -self.gravity],
            "source.external_force": [0.0, 0.0, -self.force],
        }
        if self.geometry == PLANE:
            values["destination.axis"] = [0.0, 0.0, 1.0]
        else:
            values["destination.radius"] = self.destination_radius
            values["contact.location"] = "inside" if self.inside else "outside"
        if self.destination_mass is not None:
            values |= {"destination.motion": "free", "destination.mass": self.destination_mass}
        if self.prescribed:
            values["destination.motion"] = "prescribed"
        if self.fmu == "SphereCylinder":
            values["destination.axis"] = [0.0, 1.0, 0.0]
        if self.length is not None:
            values |= {"destination.finite_length": True, "destination.length": self.length}
        return values | self._law()

    def _law(self) -> dict[str, Any]:
        if self.law == "undamped":
            return {"contact.method": "penalty", "contact.penalty_factor": self.penalty}
        values = {"contact.viscous_penalty_factor": self.dashpot_factor, "contact.dashpot": self.kind}
        if self.restitution is not None:
            values = {"contact.viscous_control": "restitution", "contact.restitution": self.restitution}
            return values | {"contact.dashpot": self.kind, "contact.penalty_factor": self.penalty}
        if self.law == "viscous_only":
            return values | {"contact.penalty_control": "viscous_only"}
        return values | {"contact.penalty_factor": self.penalty}

    def _restitution_factor(self) -> mpf:
        with mp.workdps(DIGITS):
            mass = mpf(self.source_mass)
            if self.destination_mass is not None:
                mass = mass * mpf(self.destination_mass) / (mass + mpf(self.destination_mass))
            return 2 * damping_ratio(self.restitution, self.kind) * mp.sqrt(mpf(self.penalty) * mass)

    def line(self) -> Line:
        """The closed form, from the very numbers that the FMU is given"""
        with mp.workdps(DIGITS):
            source, free = mpf(self.source_mass), self.destination_mass is not None
            mass = (
                source * mpf(self.destination_mass) / (source + mpf(self.destination_mass))
                if free
                else source
            )
            radii = mpf(self.destination_radius), mpf(self.source_radius)
            if self.geometry == PLANE:
                radii = mpf(0), radii[1]
            damped = self.restitution is not None and self.law != "undamped"
            return Line(
                inside=self.inside,
                flat=self.geometry == PLANE,
                reach=radii[0] - radii[1] if self.inside else radii[0] + radii[1],
                mass=mass,
                stiffness=mpf(self.stored_penalty),
                damping=self._restitution_factor() if damped else mpf(self.dashpot_factor),
                dashpot=self.kind,
                push=-mpf(self.force) / source - (mpf(0) if free else mpf(self.gravity)),
                place=mpf(self.source_center()[2]) - mpf(self.offset),
                speed=-mpf(self.speed),
                **self._ends(),
            )

    def _ends(self) -> dict[str, Any]:
        """When the source passes the ends of a finite cylinder"""
        if self.length is None:
            return {}
        start, half = mpf(self.source_center()[1]) - mpf(self.offset), mpf(self.length) / 2
        times = ()
        if self.along_speed:
            times = ((side * half - start) / mpf(self.along_speed) for side in (1, -1))
        return {"within": abs(start) <= half, "ends": tuple(t for t in times if t > 0)}

    def flight_time(self) -> float:
        """To the first touch, about"""
        pull = self.gravity * (self.destination_mass is None) + self.force / self.source_mass
        gap = max(self.gap, 0.0)
        if pull == 0 and self.speed == 0:
            return 0.0
        return 2 * gap / (self.speed + math.sqrt(self.speed**2 + 2 * pull * gap))

    def contact_time(self) -> float:
        return math.pi * math.sqrt(self.reduced_mass / self.penalty)

    @property
    def scale(self) -> float:
        """A length of the scene"""
        return max(min(self.gap or self.reach, self.reach), 1e-5 * self.destination_radius)

    def masses(self) -> tuple[float, float | None]:
        """The second where the destination is free"""
        return self.source_mass, self.destination_mass

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        """What gravity and the external force have passed to a body"""
        source = body == "source"
        mass = self.source_mass if source else self.destination_mass
        return np.array([0.0, 0.0, -(mass * self.gravity + self.force * source) * time])

    def passive(self) -> bool:
        """Whether nothing but gravity gives energy; a finite cylinder's end may"""
        return self.force == 0 and not self.prescribed and self.length is None

    def swings(self, time: float) -> float:
        """Radians of the pendulum that a ball pressed into a hollow body is"""
        pull = self.gravity * (self.destination_mass is None) + self.force / self.source_mass
        return time * math.sqrt(abs(pull) / self.reach) if self.inside else 0.0

    def timed(self) -> HeadOn:
        return self if self.end else replace(self, end=2.5 * self.flight_time() + 2.5 * self.contact_time())
