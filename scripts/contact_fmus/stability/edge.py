"""A ball that flies at the rim of a capped cylinder: the FMU's start values and the same motion from touch to
release by DOP853 (scipy), with flight in closed form before and after.

All happens in the plane of the axis, y, and of the way outward, x. About the point of the rim that lies in it
the force is central: with the distance r, delta = r_s - r and the angular momentum h by mass,

    delta'' = -h^2/r^3 - F(delta, delta')/m,   angle' = h/r^2,

in units of the speed into the contact and of the oscillation's rate. A ball that comes down on the cap or the
side itself does so head-on: h = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from .expected import EPSILON, Expected
from .unforced import Unforced

ACCURACY = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
TURN = math.pi / 2


class Bounce(NamedTuple):
    """Of the contact, in units: its duration, delta's rate at its end, the angle turned, and delta there"""

    duration: float
    rate: float
    turned: float
    depth: float


@dataclass(frozen=True)
class Edge(Unforced):
    """SI units. The ball flies towards the rim at `angle` from the way inward: 0 across the side, pi/2 down
    on the cap. Its centre's path passes the rim's point at the distance `offset`: beyond the face that it
    would meet if positive, else over the face."""

    law: str = "non_adhesive"  # the dashpot, or undamped
    hertz: bool = False
    angle: float = TURN
    offset: float = 0.0
    source_radius: float = 0.125
    destination_radius: float = 0.5
    length: float = 1.0
    gap: float = 0.125
    speed: float = 1.0
    source_mass: float = 1.0
    depth: float = 1e-3  # of an impact without damping, over the ball's radius; decides the stiffness
    ratio: float = 0.2  # of critical damping; chi times the speed under Hertz's law
    end: float = 0.0  # 0: as long after the impact as before it

    geometry = "capped cylinder"
    fmu = "SphereCylinder"

    @property
    def stiffness(self) -> float:
        deep = self.depth * self.source_radius
        if self.hertz:
            return 1.25 * self.source_mass * self.speed**2 / deep**2.5
        return self.source_mass * (self.speed / deep) ** 2

    @property
    def stored_penalty(self) -> float:
        return 0.0 if self.hertz else self.stiffness

    @property
    def scale(self) -> float:
        return self.gap

    @property
    def damping(self) -> float:
        """p_nv, or chi"""
        if self.law == "undamped":
            return 0.0
        if self.hertz:
            return self.ratio / self.speed
        return 2 * self.ratio * math.sqrt(self.stiffness * self.source_mass)

    def towards(self) -> np.ndarray:
        if self.angle == TURN:
            return np.array([0.0, -1.0])
        return np.array([-math.cos(self.angle), -math.sin(self.angle)])

    def aside(self) -> np.ndarray:
        """Across the way, away from the face that the ball would meet head-on"""
        x, y = self.towards()
        return np.array([-y, x]) if self.angle > TURN / 2 else np.array([y, -x])

    def corner(self) -> np.ndarray:
        return np.array([self.destination_radius, self.length / 2])

    def reach(self) -> float:
        """How far before the point nearest to the rim the ball touches; nan: it passes"""
        if self.on_face:
            return self.source_radius
        left = (self.source_radius - self.offset) * (self.source_radius + self.offset)
        return math.sqrt(left) if left > 0 else math.nan

    @property
    def on_face(self) -> bool:
        return self.offset <= 0 and self.angle in (0.0, TURN)

    def begin(self) -> np.ndarray:
        """Of the centre, in the plane"""
        back = self.source_radius + self.gap
        return self.corner() + self.offset * self.aside() - back * self.towards()

    def configuration(self) -> dict[str, Any]:
        begin, velocity = self.begin(), self.speed * self.towards()
        values: dict[str, Any] = {
            "source.radius": self.source_radius,
            "source.mass": self.source_mass,
            "source.center": [*begin, 0.0],
            "source.initial_velocity": [*velocity, 0.0],
            "destination.radius": self.destination_radius,
            "destination.axis": [0.0, 1.0, 0.0],
            "destination.finite_length": True,
            "destination.length": self.length,
            "destination.ends": "capped",
            "gravity": [0.0, 0.0, 0.0],
        }
        if self.hertz:
            values |= {"contact.law": "hertz", "contact.hertz_stiffness": self.stiffness}
        else:
            values |= {"contact.penalty_factor": self.stiffness}
        if self.law == "undamped":
            return values | {"contact.method": "penalty"}
        factor = "contact.hunt_crossley_factor" if self.hertz else "contact.viscous_penalty_factor"
        return values | {"contact.dashpot": self.law, factor: self.damping}

    def timed(self) -> Edge:
        lasts = math.pi * self.depth * self.source_radius / self.speed
        near = (self.gap + self.source_radius) / self.speed
        return self if self.end else replace(self, end=2 * near + 4 * lasts)

    def masses(self) -> tuple[float, float | None]:
        """The second where the destination is free"""
        return self.source_mass, None

    def swings(self, time: float) -> float:
        return 0.0

    def expected(self) -> Expected:
        reach, way = self.reach(), self.speed * self.end
        if math.isnan(reach):
            place, touch = self.begin() + way * self.towards(), None
        else:
            touch = (self.source_radius + self.gap - reach) / self.speed
            place = self._after(reach, self.end - touch)
        moved = place - self.begin()
        resolution = EPSILON * (self.destination_radius + self.length + way)
        # a touch that is turned by its rounding, or that is a graze, throws the ball off elsewhere
        steep = 1.0 if math.isnan(reach) else self.source_radius / reach
        rounding = 8 * resolution * steep * (1 + way / self.source_radius)
        return Expected(
            displacement={"source": [*moved, 0.0]},
            way=max(way, float(np.linalg.norm(moved))),
            rounding=rounding + 1e-11 * way,  # of DOP853
            fastest=self.speed,
            onsets=int(touch is not None),
            sure=True,
            strong=int(touch is not None),
            last_onset=touch,
            onset_rounding=8 * resolution * steep / self.speed,
        )

    def _after(self, reach: float, left: float) -> np.ndarray:
        """The place `left` seconds after the touch"""
        arm = self.offset * self.aside() * (not self.on_face) - reach * self.towards()
        normal = arm / self.source_radius
        into = -self.speed * float(normal @ self.towards())
        momentum = self.speed * (arm[0] * self.towards()[1] - arm[1] * self.towards()[0])
        unit = self.depth * self.source_radius
        time = unit / self.speed
        bounce = self._bounce(into / self.speed, momentum * time, unit)
        if bounce.duration * time > left:
            raise ValueError("the end is within the impact")
        normal, along = _turned(normal, bounce.turned)
        if not self.on_face and min(normal) < 0:
            raise ValueError("the ball goes on over a face")
        apart = self.source_radius - bounce.depth * unit
        velocity = -bounce.rate * self.speed * normal + momentum / apart * along
        corner = self.corner() + self.offset * self.aside() * self.on_face
        return corner + apart * normal + (left - bounce.duration * time) * velocity

    def _bounce(self, into: float, momentum: float, unit: float) -> Bounce:
        """Lengths in `unit`, times in which the speed covers it"""
        radius = self.source_radius / unit
        spin = momentum / unit**2
        parts = self._parts()
        time, y, part = 0.0, np.array([0.0, into, 0.0]), 0

        def rates(force: Callable[[float, float], float]) -> Callable[[float, np.ndarray], list[float]]:
            def of(_time: float, y: np.ndarray) -> list[float]:
                r = radius - y[0]
                return [y[1], -(spin**2) / r**3 - force(y[0], y[1]), spin / r**2]

            return of

        while True:
            force, ends = parts[part]
            events = [lambda _t, y: y[0], lambda _t, y, ends=ends: ends(y[0], y[1])]
            for event in events:
                event.terminal, event.direction = True, -1.0
            found = solve_ivp(
                rates(force), (time, time + 50.0), y, events=events, max_step=0.1, first_step=1e-3, **ACCURACY
            )
            if found.status != 1:
                raise ArithmeticError("the bodies do not part")
            time, y = found.t[-1], found.y[:, -1]
            if found.t_events[0].size:
                return Bounce(time, y[1], y[2], 0.0)
            if part + 1 == len(parts):
                return Bounce(time, y[1], y[2], y[0])
            part += 1

    def _parts(self) -> list[tuple[Callable[[float, float], float], Callable[[float, float], float]]]:
        """The forces of the contact one after another, and what falls through zero where each ends"""
        c = 0.0 if self.law == "undamped" else self.ratio if self.hertz else 2 * self.ratio

        def full(s: float, v: float) -> float:
            return 1.25 * max(s, 0.0) ** 1.5 * (1 + c * v) if self.hertz else s + c * v

        def spring(s: float, v: float) -> float:
            return 1.25 * max(s, 0.0) ** 1.5 if self.hertz else s

        def pull(s: float, v: float) -> float:
            return 1 + c * v if self.hertz else s + c * v

        if self.law == "approach_only" and c > 0:
            return [(full, lambda s, v: v), (spring, lambda s, v: 1.0)]
        if self.law == "non_adhesive" and c > 0:
            return [(full, pull)]  # nothing acts from there on: it is free
        return [(full, lambda s, v: 1.0)]


def _turned(normal: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """The normal turned on, and the way along which it turns"""
    c, s = math.cos(angle), math.sin(angle)
    turned = np.array([c * normal[0] - s * normal[1], s * normal[0] + c * normal[1]])
    return turned, np.array([-turned[1], turned[0]])
