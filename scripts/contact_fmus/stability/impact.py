"""One free head-on impact by Hertz's law with the damping of Hunt and Crossley: the FMU's start values and
the closed form of the same motion, up to one quadrature for its duration.

With delta' = v and y = chi v, v dv / d delta = -(k/m) delta^(3/2) (1 + y) gives

    (2/5) (k/m) delta^(5/2) = Q(v_0) - Q(v),   Q = v/chi - ln(1 + chi v)/chi^2, or v^2/2 without damping

and the time follows from dt = -dv / ((k/m) delta^(3/2) (1 + y)). The approach-only dashpot has no damping on
the way back. Bodies lie along z as in head_on.py.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

from mpmath import mp, mpf

from .expected import EPSILON, Expected
from .line_motion import DIGITS
from .unforced import Unforced

ROUND = ("sphere outside", "sphere inside", "cylinder outside", "cylinder inside")
GEOMETRIES = (*ROUND, "plane")
FMUS = {"sphere": "SphereSphere", "cylinder": "SphereCylinder", "plane": "SpherePlane"}
POISSON = 0.3
LEAST = 1e-3  # smaller coefficients of restitution count as this


@dataclass(frozen=True)
class Impact(Unforced):
    """SI units. k_h by the modulus of both bodies, or `stiffness`; chi by `restitution`, or as chi v"""

    geometry: str = "sphere outside"
    law: str = "non_adhesive"  # the dashpot, or undamped
    modulus: float | None = None
    stiffness: float = 1e8
    restitution: float | None = None
    damped: float = 0.0
    source_radius: float = 0.125
    destination_radius: float = 0.5
    gap: float = 0.125
    speed: float = 1.0
    source_mass: float = 1.0
    destination_mass: float | None = None
    end: float = 0.0  # 0: as long after the impact as before it

    stored_penalty = 0.0  # what is stored was motion before

    @property
    def shape(self) -> str:
        return self.geometry.partition(" ")[0]

    @property
    def inside(self) -> bool:
        return self.geometry.endswith("inside")

    @property
    def fmu(self) -> str:
        return FMUS[self.shape]

    @property
    def reach(self) -> float:
        if self.shape == "plane":
            return self.source_radius
        return self.destination_radius + self.source_radius * (-1 if self.inside else 1)

    @property
    def place(self) -> float:
        return -(self.reach - self.gap) if self.inside else self.reach + self.gap

    @property
    def scale(self) -> float:
        """A length of the scene"""
        return min(self.gap, self.reach)

    def configuration(self) -> dict[str, Any]:
        values = {
            "source.radius": self.source_radius,
            "source.mass": self.source_mass,
            "source.center": [0.0, 0.0, self.place],
            "source.initial_velocity": [0.0, 0.0, -self.speed],
            "gravity": [0.0, 0.0, 0.0],
            "contact.law": "hertz",
        }
        if self.shape != "plane":
            values |= {"destination.radius": self.destination_radius}
            values |= {"contact.location": "inside" if self.inside else "outside"}
        if self.shape != "sphere":
            values["destination.axis"] = [0.0, 0.0, 1.0] if self.shape == "plane" else [0.0, 1.0, 0.0]
        if self.destination_mass is not None:
            values |= {"destination.motion": "free", "destination.mass": self.destination_mass}
        return values | self._stiffness() | self._damping()

    def _stiffness(self) -> dict[str, Any]:
        if self.modulus is None:
            return {"contact.hertz_stiffness": self.stiffness}
        values: dict[str, Any] = {"contact.penalty_control": "automatic"}
        for body in ("source", "destination"):
            values |= {f"{body}.youngs_modulus": self.modulus, f"{body}.poissons_ratio": POISSON}
        return values

    def _damping(self) -> dict[str, Any]:
        if self.law == "undamped":
            return {"contact.method": "penalty"}
        values: dict[str, Any] = {"contact.dashpot": self.law}
        if self.restitution is not None:
            return values | {
                "contact.viscous_control": "restitution",
                "contact.restitution": self.restitution,
            }
        return values | {"contact.hunt_crossley_factor": self.damped / self.speed}

    # The closed form

    @cached_property
    def factor(self) -> mpf:
        """k_h"""
        if self.modulus is None:
            return mpf(self.stiffness)
        with mp.workdps(DIGITS):
            modulus = mpf(self.modulus) / (2 * (1 - mpf(POISSON) ** 2))
            along = 1 / (2 * mpf(self.source_radius))
            other = mpf(self.destination_radius) * (-1 if self.inside else 1)
            curved = along + 1 / (2 * other)
            if self.shape != "cylinder":
                return 4 * modulus / (3 * mp.sqrt(2 * (along if self.shape == "plane" else curved)))
            return elliptic_stiffness(modulus, min(along, curved), max(along, curved))

    @cached_property
    def damping(self) -> mpf:
        """chi v_0"""
        if self.law == "undamped" or self.restitution == 1.0:
            return mpf(0)
        return mpf(self.damped) if self.restitution is None else damping_of(self.restitution, self.law)

    @property
    def mass(self) -> mpf:
        source = mpf(self.source_mass)
        return source if self.destination_mass is None else 1 / (1 / source + 1 / mpf(self.destination_mass))

    @cached_property
    def impact(self) -> tuple[mpf, mpf, mpf]:
        """Duration, relative speed after it, depth"""
        with mp.workdps(DIGITS):
            speed, duration, after, depth = mpf(self.speed), *free_impact(self.damping, self.law)
            unit = (speed**2 / (self.factor / self.mass)) ** (mpf(2) / 5)
            return duration * unit / speed, after * speed, depth * unit

    def timed(self) -> Impact:
        return self if self.end else replace(self, end=2 * self.gap / self.speed + float(self.impact[0]))

    def masses(self) -> tuple[float, float | None]:
        """The second where the destination is free"""
        return self.source_mass, self.destination_mass

    def swings(self, time: float) -> float:
        return 0.0

    def expected(self) -> Expected:
        with mp.workdps(DIGITS):
            duration, after, depth = self.impact
            speed, end = mpf(self.speed), mpf(self.end)
            reach = mpf(self.destination_radius) * (self.shape != "plane")
            reach = reach + mpf(self.source_radius) * (-1 if self.inside else 1)
            touch = (mpf(self.place) - (-reach if self.inside else reach)) / speed
            if end < touch + duration:
                raise ValueError("the end is within the impact")
            # the bodies' distance at the end, over what it would be without contact
            gained = (speed + after) * (end - touch) - after * duration
            share = self.mass / mpf(self.source_mass)
            moved = {"source": [mpf(0), mpf(0), share * gained - speed * end]}
            if self.destination_mass is not None:
                share = self.mass / mpf(self.destination_mass)
                moved["destination"] = [mpf(0), mpf(0), -share * gained]
        way = max(self.speed * self.end, float(depth))
        resolution = EPSILON * (self.reach + max(float(abs(u[2])) for u in moved.values()))
        return Expected(
            displacement=moved,
            way=way,
            rounding=8 * resolution,
            fastest=self.speed,
            onsets=1,
            sure=True,
            strong=1,
            last_onset=float(touch),
            onset_rounding=8 * resolution / self.speed,
        )


def elliptic_stiffness(modulus: mpf, a: mpf, b: mpf) -> mpf:
    """K. L. Johnson, Contact Mechanics, 4.2: with K, E of the eccentricity e and the larger half axis h,
    A, B = 3 F/(2 pi E* h^3) times (K - E)/e^2 and (E/(1 - e^2) - K)/e^2; depth = 3 F K/(2 pi E* h)."""

    def parts(m: mpf) -> tuple[mpf, mpf, mpf]:
        k, e = mp.ellipk(m), mp.ellipe(m)
        return k, (k - e) / m, (e / (1 - m) - k) / m

    def wanted(m: mpf) -> mpf:
        _, first, second = parts(m)
        return first / second - a / b

    m = mp.findroot(wanted, (mpf("1e-9"), 1 - mpf("1e-12")), solver="anderson")
    k, first, _ = parts(m)
    return 2 * mp.pi * modulus / 3 * mp.sqrt(first / (a * k**3))


def damping_of(restitution: float, law: str) -> mpf:
    """chi v_0 by its coefficient of restitution (the module's integral from v_0 to -e v_0)"""
    with mp.workdps(DIGITS):
        e = mpf(max(restitution, LEAST))
        low, high = mpf("1e-20"), 2 / e**2 if law == "approach_only" else (1 - mpf("1e-20")) / e
        for _ in range(220):
            y = (low + high) / 2
            if law == "approach_only":
                too_little = 2 * (y - mp.log(1 + y)) / y**2 > e**2
            else:
                too_little = mp.log((1 + y) / (1 - e * y)) < y * (1 + e)
            low, high = (y, high) if too_little else (low, y)
        return high


@cache
def free_impact(damped: mpf, law: str) -> tuple[mpf, mpf, mpf]:
    """Duration, speed after it, depth, for k_h, mass and speed of 1. The variable is L = -ln(1 + y):
    (2/5) delta^(5/2) = (1 + 1/y - exp(-L)/y)/y - (ln(1 + y) + L)/y^2, dt = dL/(y delta^(3/2))."""
    half = mpf("0.5")
    if damped == 0:
        return 2 * _time_without_damping(half), mpf(1), (mpf(5) / 2 * half) ** (mpf(2) / 5)
    y, begin = damped, -mp.log(1 + damped)

    def energy(turned: mpf) -> mpf:
        return (1 + (1 - mp.exp(-turned)) / y) / y - (turned - begin) / y**2

    def pace(turned: mpf) -> mpf:
        left = energy(turned)
        return 1 / (y * (mpf(5) / 2 * left) ** (mpf(3) / 5)) if left > 0 else mpf(0)

    deepest = energy(mpf(0))
    depth = (mpf(5) / 2 * deepest) ** (mpf(2) / 5)
    forth = mp.quad(pace, [begin, 0])
    if law == "approach_only":
        return forth + _time_without_damping(deepest), mp.sqrt(2 * deepest), depth
    low, high = mpf(0), 1 + y - begin
    for _ in range(220):
        last = (low + high) / 2
        low, high = (last, high) if energy(last) > 0 else (low, last)
    back = mp.quad(pace, [0, last / 2, last])
    return forth + back, (1 - mp.exp(-last)) / y, depth


def _time_without_damping(energy: mpf) -> mpf:
    """To rise from the deepest place: sqrt(pi) Gamma(7/5)/Gamma(9/10) of depth / speed"""
    depth = (mpf(5) / 2 * energy) ** (mpf(2) / 5)
    factor = mp.sqrt(mp.pi) * mp.gamma(mpf(7) / 5) / mp.gamma(mpf(9) / 10)
    return factor * depth / mp.sqrt(2 * energy)
