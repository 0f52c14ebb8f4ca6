"""A ball that slides and then rolls on a plane, and a cylinder that tumbles into a ball: the FMU's start
values and the closed form of the same motions.

Rolling: under regularized friction and a constant normal force the slip s obeys s' = -r (1 - exp(-s/v_0))
with r = (1 + 1/k) mu g and I = k m a^2, hence with A = exp(s_0/v_0) - 1

    s = v_0 ln(1 + A exp(-r t/v_0)),  integral of s = (v_0^2/r) (Li_2(-A exp(-r t/v_0)) - Li_2(-A)),

and the ball has lost (s_0 - s)/(1 + 1/k) of its speed; it turns at the rate (v - s)/a.

Tumbling: an axis that turns in a plane with the rate w comes within r_s + r_d of a ball at the distance D
from the middle of the cylinder when D cos(w t) = r_s + r_d.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpmath import mp, mpf

from .expected import EPSILON, Expected
from .line_motion import DIGITS
from .unforced import Unforced

G = 9.81
LONGEST = 10.0  # s
MOST_TURNS = 1000  # of a ball, each of which an integrator has to follow


@dataclass(frozen=True)
class Rolling:
    """SI units. A ball of 1 kg, in balance with its weight"""

    speed: float = 2.0
    spin: float = 0.0  # about y; back-spin is negative
    friction: float = 0.2
    slip_velocity: float = 1e-3
    inertia: float = 0.4  # over m a^2
    radius: float = 0.125
    penalty: float = 1e6
    end: float = 0.0  # 0: half as long again as it slides, ten seconds and so many turns at most

    geometry = "plane"
    law = "undamped"
    fmu = "SpherePlane"
    stored_penalty = 0.0
    held = False  # whether neither body can move

    @property
    def slip(self) -> float:
        return self.speed - self.radius * self.spin

    @property
    def rate(self) -> float:
        """Of the slip while the ball slides, m/s^2"""
        return (1 + 1 / self.inertia) * self.friction * G

    @property
    def scale(self) -> float:
        """A length of the scene"""
        return self.radius

    @property
    def height(self) -> float:
        return self.radius - G / self.penalty

    def timed(self) -> Rolling:
        turns = 2 * math.pi * MOST_TURNS / abs(self.spin) if self.spin else math.inf
        return self if self.end else replace(self, end=min(1.5 * self.slip / self.rate, LONGEST, turns))

    def configuration(self) -> dict[str, Any]:
        return {
            "source.radius": self.radius,
            "source.center": [0.0, 0.0, self.height],
            "source.initial_velocity": [self.speed, 0.0, 0.0],
            "source.rotation": "free",
            "source.inertia_control": "user_defined",
            "source.axial_inertia": self.inertia * self.radius**2,
            "source.initial_angular_velocity": [0.0, self.spin, 0.0],
            "contact.method": "penalty",
            "contact.penalty_factor": self.penalty,
            "contact.friction": "regularized",
            "contact.friction_coefficient": self.friction,
            "contact.slip_velocity_control": "user_defined",
            "contact.characteristic_slip_velocity": self.slip_velocity,
        }

    def masses(self) -> tuple[float, float | None]:
        """The second where the destination is free"""
        return 1.0, None

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        return np.array([0.0, 0.0, -G * time if body == "source" else 0.0])

    def passive(self) -> bool:
        return True

    def swings(self, time: float) -> float:
        return 0.0

    def expected(self) -> Expected:
        with mp.workdps(DIGITS):
            small, slip, rate, end = map(mpf, (self.slip_velocity, self.slip, self.rate, self.end))
            begun = mp.expm1(slip / small)
            area = small**2 / rate * (_dilogarithm(begun * mp.exp(-rate * end / small)) - _dilogarithm(begun))
            way = mpf(self.speed) * end - (slip * end - area) / (1 + 1 / mpf(self.inertia))
            turned = (way - area) / mpf(self.radius)
        size = max(self.speed, self.slip) * self.end
        return Expected(
            displacement={"source": [way, mpf(0), mpf(0)]},
            way=size,
            rounding=16 * EPSILON * size,
            fastest=max(self.speed, self.slip),
            onsets=1,
            sure=True,
            strong=1,
            last_onset=0.0,
            turned=turned,
        )


def _dilogarithm(a: mpf) -> mpf:
    """Li_2(-a); large ones by its inversion, which does not need a itself"""
    if a <= 1:
        return mp.re(mp.polylog(2, -a))
    return -(mp.pi**2) / 6 - mp.log(a) ** 2 / 2 - mp.re(mp.polylog(2, -1 / a))


@dataclass(frozen=True)
class Tumbling(Unforced):
    """SI units. A cylinder that turns about its fixed middle meets a fixed ball"""

    rate: float = 1.0  # rad/s
    law: str = "undamped"
    source_radius: float = 0.125
    destination_radius: float = 0.25
    away: float = 2.0  # of the ball, from the middle
    length: float = 6.0
    penalty: float = 0.0  # 0: an impact that lasts a thousandth of a radian
    end: float = 0.0  # 0: half as long again as until the touch

    geometry = "cylinder outside"
    fmu = "SphereCylinder"
    stored_penalty = 0.0
    held = True

    @property
    def touch(self) -> float:
        return math.acos((self.source_radius + self.destination_radius) / self.away) / self.rate

    @property
    def scale(self) -> float:
        return self.source_radius

    def timed(self) -> Tumbling:
        return self if self.end else replace(self, end=1.5 * self.touch)

    def configuration(self) -> dict[str, Any]:
        across = (3 * self.destination_radius**2 + self.length**2) / 12
        penalty = self.penalty or across / self.away**2 * (math.pi * self.rate / 1e-3) ** 2
        return {
            "source.motion": "fixed",
            "source.radius": self.source_radius,
            "source.center": [self.away, 0.0, 0.0],
            "destination.motion": "fixed",
            "destination.rotation": "free",
            "destination.radius": self.destination_radius,
            "destination.finite_length": True,
            "destination.length": self.length,
            "destination.axis": [0.0, 0.0, 1.0],
            "destination.initial_angular_velocity": [0.0, self.rate, 0.0],
            "contact.location": "outside",
            "contact.method": "penalty",
            "contact.penalty_factor": penalty,
        }

    def masses(self) -> tuple[float, float | None]:
        return 1.0, None

    def swings(self, time: float) -> float:
        return self.rate * time

    def expected(self) -> Expected:
        return Expected(
            displacement={"source": [mpf(0)] * 3},
            way=self.away,
            rounding=0.0,
            fastest=self.rate * self.away,
            onsets=1,
            sure=True,
            strong=1,
            last_onset=self.touch,
            onset_rounding=16 * EPSILON * self.touch,
        )
