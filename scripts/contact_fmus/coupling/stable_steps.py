"""The largest communication step that keeps a lasting contact quiet: by theory and measured on the FMU.

Theory: with F = -k u - c v a step of a scheme is a linear map of (u, v, last F), found column by column
from a linear stand-in of the FMU; it keeps quiet while no eigenvalue is outside the unit circle. Measured:
a ball pressed on a wall is pushed a little; the step is bisected between growing and not growing.
"""

from __future__ import annotations

import math

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file

from .driven_contact import DrivenContact
from .outer_integrators import Ball, Outside, Scheme, run

LEAST, MOST = 1e-2, 30.0  # in h omega; below: none, above: any
PRESS = {
    "source.radius": 0.1,
    "source.center": [0.0, 0.0, 0.6],
    "destination.radius": 0.5,
    "contact.method": "penalty_dynamic",
    "contact.dashpot": "unclamped",
    "contact.penalty_factor": 1e6,
}


class LinearElement:
    """F = -k u - c v with the calls of DrivenContact"""

    def __init__(self, stiffness: float, damping: float):
        self.stiffness, self.damping = stiffness, damping

    def force_at(self, displacement, velocity):
        return -self.stiffness * displacement - self.damping * velocity

    def force_after(self, size, displacement, velocity, rate=0.0, curvature=0.0, acceleration=0.0):
        end = displacement + rate * size + 0.5 * curvature * size**2
        return self.force_at(end, velocity + acceleration * size)

    def mean_force(self, size, displacement, velocity, rate, curvature, acceleration):
        mean = displacement + rate * size / 2.0 + curvature * size**2 / 6.0
        return self.force_at(mean, velocity + acceleration * size / 2.0)

    def go_on(self, size):
        pass

    remember = take_back = lambda self: None


def spectral_radius(scheme: Scheme, step: float, damping_ratio: float) -> float:
    """Of one step for m = k = 1, so that the step is h omega"""
    damping = 2.0 * damping_ratio
    outside = Outside(1.0, np.zeros(1), 1.0, damping)
    element = LinearElement(1.0, damping)
    columns = []
    for unit in np.eye(3):
        ball = scheme.step(element, outside, Ball(*(unit[k : k + 1] for k in range(3))), step)
        columns.append(np.concatenate(ball))
    return float(np.max(np.abs(np.linalg.eigvals(np.array(columns).T))))


def bisected(quiet) -> float:
    """The step in h omega where quiet(step) ends: 0 for none, infinite for any"""
    steps = np.geomspace(LEAST, MOST, 25)
    if not quiet(steps[0]):
        return 0.0
    loud = next((k for k, step in enumerate(steps) if not quiet(step)), None)
    if loud is None:
        return math.inf
    low, high = steps[loud - 1], steps[loud]
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if quiet(middle) else (low, middle)
    return float(low)


def stable_step_of_theory(scheme: Scheme, damping_ratio: float) -> float:
    return bisected(lambda step: spectral_radius(scheme, step, damping_ratio) <= 1.0 + 1e-9)


def stable_step_measured(scheme: Scheme, damping_ratio: float, steps: int) -> float:
    stiffness = PRESS["contact.penalty_factor"]
    omega = math.sqrt(stiffness)
    damping = 2.0 * damping_ratio * omega
    outside = Outside(1.0, np.array([0.0, 0.0, -9.81]), stiffness, damping)
    depth = 9.81 / stiffness
    push = 0.01 * depth

    with ContactFmu(fmu_file("SphereSphere")) as fmu:

        def quiet(step: float) -> bool:
            element = DrivenContact(fmu, {**PRESS, "contact.viscous_penalty_factor": damping})
            largest = [0.0]

            def noted(ball: Ball) -> bool:
                size = math.hypot(ball.displacement[2] + depth, ball.velocity[2] / omega)
                largest[-1] = max(largest[-1], size)
                return size > 30.0 * push

            ball = Ball(np.array([0.0, 0.0, push - depth]), np.zeros(3), np.zeros(3))
            ball = run(scheme, element, outside, ball, step / omega, steps // 2, noted)
            largest.append(0.0)
            run(scheme, element, outside, ball, step / omega, steps // 2, noted)
            element.close()
            return largest[1] <= 1.02 * largest[0] and largest[1] < 20.0 * push

        return bisected(quiet)
