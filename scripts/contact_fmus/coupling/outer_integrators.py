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


# Displacement and velocity after a step, from the acceleration before and the one with the force that came. A tool
# that integrates exactly, as Runge-Kutta does, has the old force until the next point.
Move = Callable[[Ball, np.ndarray, np.ndarray, float], tuple[np.ndarray, np.ndarray]]
EULER, VERLET, RUNGE_KUTTA = "semi-implicit Euler", "velocity Verlet", "Runge-Kutta 4"


def _parabola(ball: Ball, a: np.ndarray, h: float) -> np.ndarray:
    return ball.displacement + h * ball.velocity + 0.5 * h * h * a


MOVES: dict[str, Move] = {
    EULER: lambda ball, a, _new, h: (ball.displacement + h * (ball.velocity + h * a), ball.velocity + h * a),
    VERLET: lambda ball, a, new, h: (_parabola(ball, a, h), ball.velocity + 0.5 * h * (a + new)),
    RUNGE_KUTTA: lambda ball, a, _new, h: (_parabola(ball, a, h), ball.velocity + h * a),
}


def beside(integrator: str, derivatives: int) -> Step:
    """The FMU steps beside the tool, which moves the ball with the force that comes"""

    def step(element, outside: Outside, ball: Ball, h: float) -> Ball:
        a = _acceleration(outside, ball.force)
        force = _force_beside(element, ball, a, h, derivatives)
        return Ball(*MOVES[integrator](ball, a, _acceleration(outside, force), h), force)

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


BESIDE = ("held", "derivative 1", "derivatives 1, 2")
# Orders of the couplings beside the tool
ORDERS = {EULER: (1, 1, 1), VERLET: (1, 2, 2), RUNGE_KUTTA: (1, 1, 1)}
AT_ONCE = {EULER: (euler_at_once, 1), VERLET: (verlet_at_once, 2), RUNGE_KUTTA: (runge_kutta_at_once, 4)}
WEIGHTS = {EULER: 0.0, VERLET: 0.5}  # of the old velocity, where the mean force is used


def _schemes(integrator: str) -> list[Scheme]:
    step, order = AT_ONCE[integrator]
    found = [Scheme(integrator, "at once", step, order)]
    for number, coupling in enumerate(BESIDE):
        found.append(Scheme(integrator, coupling, beside(integrator, number), ORDERS[integrator][number]))
    if integrator in WEIGHTS:
        weight = WEIGHTS[integrator]
        found.append(Scheme(integrator, "mean, predicted", mean_predicted(weight), order))
        found.append(Scheme(integrator, "mean, iterated", mean_iterated(weight), order))
    return found


SCHEMES = [scheme for integrator in MOVES for scheme in _schemes(integrator)]


def run(scheme: Scheme, element, outside: Outside, ball: Ball, h: float, steps: int, enough=None) -> Ball:
    """`steps` steps of h; it ends early where enough(ball) says so."""
    ball = ball._replace(force=element.force_at(ball.displacement, ball.velocity))
    for _ in range(steps):
        ball = scheme.step(element, outside, ball, h)
        if enough is not None and enough(ball):
            break
    return ball
