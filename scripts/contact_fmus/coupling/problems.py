"""Problems for a force element beside an outer integrator, each with its exact answer.

press   a ball pressed on a wall by gravity and pushed once: a damped oscillation that never leaves the wall
bounce  one impact with a dashpot, gravity off: the speed afterwards, the worst of several places of the
        impact between two communication points
P1, P3  of problems.py: eight impacts, and lasting contact in a hollow cylinder
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_fmus.bench.problems import benchmarks
from contact_fmus.scenarios import closed_forms

from .outer_integrators import Ball, Outside

GRAVITY = np.array([0.0, 0.0, -9.81])
WALL = {
    "source.radius": 0.1,
    "source.center": [0.0, 0.0, 0.6],  # touching
    "destination.radius": 0.5,
    "contact.method": "penalty_dynamic",
    "contact.penalty_factor": 1e6,
}
DAMPING_RATIO = 0.1  # of press and bounce
PLACES = 8  # of the impact of bounce between two communication points


@dataclass(frozen=True)
class Trial:
    """One run: where it starts, how many steps, and what the end is measured by"""

    ball: Ball
    size: float  # of a step, s
    steps: int
    error: Callable[[Ball], float]


@dataclass(frozen=True)
class CoupledProblem:
    name: str
    title: str
    fmu: str
    values: dict[str, Any]
    outside: Outside
    what: str  # the error is of
    unit: str
    length: float  # m, what is large for the ball to be away from its start
    trials: Callable[[float], Iterator[Trial]]  # of a communication step

    @property
    def omega(self) -> float:
        return math.sqrt(self.outside.stiffness / self.outside.mass)


def _ball(displacement: float = 0.0, velocity: float = 0.0) -> Ball:
    return Ball(np.array([0.0, 0.0, displacement]), np.array([0.0, 0.0, velocity]), np.zeros(3))


def damped_oscillation(time: float, push: float, omega: float, damping_ratio: float) -> tuple[float, float]:
    """s and s' of s'' + 2 zeta omega s' + omega^2 s = 0 with s(0) = push, s'(0) = 0, for zeta < 1"""
    turning, decay = omega * math.sqrt(1.0 - damping_ratio**2), damping_ratio * omega
    size, sine = push * math.exp(-decay * time), math.sin(turning * time)
    return size * (math.cos(turning * time) + decay / turning * sine), -size * omega**2 / turning * sine


def press() -> CoupledProblem:
    stiffness = WALL["contact.penalty_factor"]
    omega = math.sqrt(stiffness)
    damping = 2.0 * DAMPING_RATIO * omega
    depth, end = 9.81 / stiffness, 10.0 / omega
    push = 0.1 * depth
    exact, exact_rate = damped_oscillation(end, push, omega, DAMPING_RATIO)

    def error(ball: Ball) -> float:
        off = ball.displacement[2] + depth - exact, (ball.velocity[2] - exact_rate) / omega
        return math.hypot(*off) / push

    def trials(step: float) -> Iterator[Trial]:
        steps = max(1, round(end / step))
        yield Trial(_ball(push - depth), end / steps, steps, error)

    values = {**WALL, "contact.viscous_penalty_factor": damping, "contact.dashpot": "unclamped"}
    title = "a damped oscillation in lasting contact"
    what = "position and velocity/omega, of the push"
    outside = Outside(1.0, GRAVITY, stiffness, damping)
    return CoupledProblem("press", title, "SphereSphere", values, outside, what, "1", 0.01, trials)


def bounce() -> CoupledProblem:
    stiffness, speed = WALL["contact.penalty_factor"], 1.0
    omega = math.sqrt(stiffness)
    damping = 2.0 * DAMPING_RATIO * omega
    exact = closed_forms.restitution("non_adhesive", DAMPING_RATIO) * speed
    lasts = closed_forms.overlap_duration("non_adhesive", 1.0, stiffness, damping)

    def trials(step: float) -> Iterator[Trial]:
        for place in range(PLACES):
            gap = speed * step * (place + 0.5) / PLACES
            steps = math.ceil(2.0 * lasts / step) + 4
            yield Trial(_ball(gap, -speed), step, steps, lambda ball: abs(ball.velocity[2] - exact) / speed)

    values = {**WALL, "contact.viscous_penalty_factor": damping, "contact.dashpot": "non_adhesive"}
    outside = Outside(1.0, np.zeros(3), stiffness, damping)
    title = "one impact with a dashpot"
    what = "speed after the impact, of that before"
    return CoupledProblem("bounce", title, "SphereSphere", values, outside, what, "1", 1.0, trials)


def benchmark(name: str) -> CoupledProblem:
    """A problem of problems.py whose ball the tool moves"""
    base = benchmarks()[name]
    moved = ("source.mass", "source.initial_velocity")
    values = {key: value for key, value in base.start.items() if key not in moved}
    outside = Outside(
        base.start["source.mass"], GRAVITY, base.penalty_factor, base.start.get("contact.viscous_penalty_factor", 0.0)
    )
    center = np.array(base.start["source.center"])
    velocity = np.array(base.start.get("source.initial_velocity", [0.0, 0.0, 0.0]))

    def trials(step: float) -> Iterator[Trial]:
        steps = max(1, round(base.stop / step))
        start = Ball(np.zeros(3), velocity, np.zeros(3))
        yield Trial(start, base.stop / steps, steps, lambda ball: base.error(center + ball.displacement))

    return CoupledProblem(name, base.title, base.fmu, values, outside, "position at the end", "m", 1.0, trials)
