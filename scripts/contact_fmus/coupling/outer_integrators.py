"""Integrators of a free ball whose contact force comes from a force element, step by step.

u, v: displacement and velocity of the ball, w its inverse mass, g gravity, h the communication step, F the
force. Where the force comes from (the coupling):

at once           F(u, v) as soon as inputs are set, without a step: as a force law inside the tool
held              the FMU steps beside the tool with the inputs held: the force of the step's start comes at
                  its end
derivative 1      the same with u' = v and v' = a, the tool's present acceleration, given as input
                  derivatives: the force of u + h v, v + h a
derivatives 1, 2  and with u'' = a
mean, predicted   the FMU steps first, along the straight line u + v t; the tool then applies the mean force
mean, iterated    the FMU repeats the step along the straight line to the tool's new u until that is where
                  the mean force brings it. With v1 = v + h (g + w F) and u1 = u + h (v + v1)/2 the work of
                  F along the line is the change of kinetic energy: an undamped contact keeps its energy at
                  every h
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

MOST_REPEATS = 60


@dataclass(frozen=True)
class Outside:
    """What acts on the ball besides the contact, and what the iteration starts from"""

    mass: float
    gravity: np.ndarray
    stiffness: float  # penalty factor and viscous penalty factor of the contact
    damping: float


class Ball(NamedTuple):
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray  # the last one received


Step = Callable[[object, Outside, Ball, float], Ball]


class Scheme(NamedTuple):
    integrator: str
    coupling: str
    step: Step
    order: int  # of convergence in a lasting contact

    @property
    def name(self) -> str:
        return f"{self.integrator}, {self.coupling}"


def _acceleration(outside: Outside, force: np.ndarray) -> np.ndarray:
    return outside.gravity + force / outside.mass


def euler_at_once(element, outside: Outside, ball: Ball, h: float) -> Ball:
    force = element.force_at(ball.displacement, ball.velocity)
    element.go_on(h)
    velocity = ball.velocity + h * _acceleration(outside, force)
    return Ball(ball.displacement + h * velocity, velocity, force)


def verlet_at_once(element, outside: Outside, ball: Ball, h: float) -> Ball:
    """Velocity Verlet; a dashpot is given the velocity that the old acceleration leads to."""
    a = _acceleration(outside, ball.force)
    displacement = ball.displacement + h * ball.velocity + 0.5 * h * h * a
    force = element.force_at(displacement, ball.velocity + h * a)
    element.go_on(h)
    velocity = ball.velocity + 0.5 * h * (a + _acceleration(outside, force))
    return Ball(displacement, velocity, force)


def runge_kutta_at_once(element, outside: Outside, ball: Ball, h: float) -> Ball:
    """The classical method of fourth order; the force is asked for at each of its four stages."""
    u, v = ball.displacement, ball.velocity

    def rate(at_u, at_v):
        return at_v, _acceleration(outside, element.force_at(at_u, at_v))

    u1, v1 = rate(u, v)
    u2, v2 = rate(u + 0.5 * h * u1, v + 0.5 * h * v1)
    u3, v3 = rate(u + 0.5 * h * u2, v + 0.5 * h * v2)
    u4, v4 = rate(u + h * u3, v + h * v3)
    element.go_on(h)
    weigh = h / 6.0
    return Ball(u + weigh * (u1 + 2 * u2 + 2 * u3 + u4), v + weigh * (v1 + 2 * v2 + 2 * v3 + v4), ball.force)


def _force_beside(element, ball: Ball, a: np.ndarray, h: float, derivatives: int) -> np.ndarray:
    u, v = ball.displacement, ball.velocity
    if derivatives == 0:
        return element.force_after(h, u, v)
    if derivatives == 1:
        return element.force_after(h, u, v, v, 0.0 * a, a)
    return element.force_after(h, u, v, v, a, a)


def euler_beside(derivatives: int) -> Step:
    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        a = _acceleration(outside, ball.force)
        force = _force_beside(element, ball, a, h, derivatives)
        velocity = ball.velocity + h * a
        return Ball(ball.displacement + h * velocity, velocity, force)

    return step


def verlet_beside(derivatives: int) -> Step:
    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        a = _acceleration(outside, ball.force)
        force = _force_beside(element, ball, a, h, derivatives)
        displacement = ball.displacement + h * ball.velocity + 0.5 * h * h * a
        return Ball(displacement, ball.velocity + 0.5 * h * (a + _acceleration(outside, force)), force)

    return step


def exact_beside(derivatives: int) -> Step:
    """The tool integrates exactly, as RK4 does, with the force it has, held until the next point."""

    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        a = _acceleration(outside, ball.force)
        force = _force_beside(element, ball, a, h, derivatives)
        displacement = ball.displacement + h * ball.velocity + 0.5 * h * h * a
        return Ball(displacement, ball.velocity + h * a, force)

    return step


def _moved(outside: Outside, ball: Ball, force: np.ndarray, h: float, weight: float) -> Ball:
    """Over a step with the mean force; the displacement by weight v + (1 - weight) v1."""
    velocity = ball.velocity + h * _acceleration(outside, force)
    mixed = weight * ball.velocity + (1.0 - weight) * velocity
    return Ball(ball.displacement + h * mixed, velocity, force)


def mean_predicted(weight: float) -> Step:
    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        v, last = ball.velocity, _acceleration(outside, ball.force)
        force = element.mean_force(h, ball.displacement, v, v, 0.0 * v, last)
        return _moved(outside, ball, force, h, weight)

    return step


def mean_iterated(weight: float) -> Step:
    """Irons and Tuck's relaxation: the secant method along the last correction. It starts from the share of
    the correction that the whole contact, half of its spring and all of its dashpot, would leave.
    """

    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        u = ball.displacement
        inertia = outside.mass / ((1.0 - weight) * h * h)
        share = inertia / (inertia + 0.5 * outside.stiffness + outside.damping / h)
        target, last = _moved(outside, ball, ball.force, h, weight).displacement, None
        element.remember()
        for repeat in range(MOST_REPEATS):
            if repeat > 0:
                element.take_back()
            way = (target - u) / h
            force = element.mean_force(h, u, way, way, 0.0 * u, 0.0 * u)
            moved = _moved(outside, ball, force, h, weight)
            missing = moved.displacement - target
            if last is not None and np.any(missing != last):
                change = missing - last
                share = -share * float(last @ change) / float(change @ change)
            if abs(share) * math.sqrt(missing @ missing) <= 1e-14 * math.sqrt(1.0 + u @ u):
                return moved
            target, last = target + share * missing, missing
        raise ArithmeticError(f"no mean force found after {MOST_REPEATS} repeats of a step of {h} s")

    return step


EULER, VERLET, RUNGE_KUTTA = "semi-implicit Euler", "velocity Verlet", "Runge-Kutta 4"
SCHEMES = [
    Scheme(EULER, "at once", euler_at_once, 1),
    Scheme(EULER, "held", euler_beside(0), 1),
    Scheme(EULER, "derivative 1", euler_beside(1), 1),
    Scheme(EULER, "derivatives 1, 2", euler_beside(2), 1),
    Scheme(EULER, "mean, predicted", mean_predicted(0.0), 1),
    Scheme(EULER, "mean, iterated", mean_iterated(0.0), 1),
    Scheme(VERLET, "at once", verlet_at_once, 2),
    Scheme(VERLET, "held", verlet_beside(0), 1),
    Scheme(VERLET, "derivative 1", verlet_beside(1), 2),
    Scheme(VERLET, "derivatives 1, 2", verlet_beside(2), 2),
    Scheme(VERLET, "mean, predicted", mean_predicted(0.5), 2),
    Scheme(VERLET, "mean, iterated", mean_iterated(0.5), 2),
    Scheme(RUNGE_KUTTA, "at once", runge_kutta_at_once, 4),
    Scheme(RUNGE_KUTTA, "held", exact_beside(0), 1),
    Scheme(RUNGE_KUTTA, "derivative 1", exact_beside(1), 1),
    Scheme(RUNGE_KUTTA, "derivatives 1, 2", exact_beside(2), 1),
]


def run(scheme: Scheme, element, outside: Outside, ball: Ball, h: float, steps: int, enough=None) -> Ball:
    """`steps` steps of h; it ends early where enough(ball) says so."""
    ball = ball._replace(force=element.force_at(ball.displacement, ball.velocity))
    for _ in range(steps):
        ball = scheme.step(element, outside, ball, h)
        if enough is not None and enough(ball):
            break
    return ball
