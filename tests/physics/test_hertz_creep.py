"""Contact under Hertz's law far beyond critical damping: what it creeps by is followed in few steps, and the
force is as exact as the motion"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.checks import check_close, check_relative, run, start
from support.scenes.law_scenes import by_hertz

RADIUS, OTHER = 0.1, 0.5


def values_of(stiffness, chi, depth, speed, load, dashpot):
    return {
        "source.radius": RADIUS,
        "source.mass": 1.0,
        "source.center": [0.0, 0.0, RADIUS + OTHER - depth],
        "source.initial_velocity": [0.0, 0.0, -speed],
        "destination.radius": OTHER,
        "contact.dashpot": dashpot,
        "gravity": [0.0, 0.0, -load],
        "solver.max_internal_steps": 20_000,
        **by_hertz(stiffness, chi),
    }


def creep(stiffness, chi, depth, speed, load, end):
    """Depth, its rate and the force of a unit mass by Radau's method of scipy, in parts of depth and 1/chi"""

    def force(y):
        return stiffness * max(depth * y[0], 0.0) ** 1.5 * (1 + y[1])

    def rates(_t, y):
        return y[1] / (chi * depth), chi * (load - force(y))

    y = solve_ivp(rates, (0, end), (1.0, chi * speed), "Radau", rtol=1e-11, atol=1e-13).y[:, -1]
    return depth * y[0], y[1] / chi, force(y)


@pytest.mark.parametrize(
    "chi, depth, speed, load, end, most",
    [
        (1e6, 1e-4, 0.0, 9.81, 0.1, 20),  # less deep than at rest: it sinks
        (1e5, 4e-3, 0.0, 9.81, 0.05, 40),  # deeper: it rises
        (1e3, 0.03, 0.0, 0.0, 15.0, 40),  # pushed out without a load
        (1e3, 0.03, 0.0, -20.0, 15.0, 40),  # and pulled
        (1e7, 1e-7, 0.2, 9.81, 0.2, 100),  # an impact that hardly ends
    ],
)
def test_it_creeps_in_few_steps(opened, chi, depth, speed, load, end, most):
    stiffness, fmu = 1e6, opened("SphereSphere")
    deep, rate, force = creep(stiffness, chi, depth, speed, load, end)
    values = values_of(stiffness, chi, depth, speed, load, "unclamped")
    total = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    for steps in (1, 3):
        run(fmu, values, end, steps, 1e-10)
        check_close("depth", -fmu["contact.gap"], deep, 1e-10)
        check_close("rate", -fmu["contact.gap_rate"], rate, 1e-10)
        largest = max(abs(force), stiffness * deep**1.5)
        check_close("force", fmu["contact.normal_force"], force, 1e-8 * largest)
        check_close("energy", fmu["energy.total"], total, 1e-10 * abs(total))
        assert fmu["solver.steps"] <= most


@pytest.mark.parametrize("damped", [30.0, 1e3, 1e5])
def test_the_force_of_a_ball_that_settles(opened, damped):
    """Beyond critical damping by so much; it is set down at the depth at rest"""
    stiffness, load = 1e8, 9.81
    depth = (load / stiffness) ** (2 / 3)
    chi = 2 * damped * np.sqrt(1.5 * stiffness * depth**0.5) / load
    values = values_of(stiffness, chi, 0.5 * depth, 0.0, load, "unclamped")
    _, _, force = creep(stiffness, chi, 0.5 * depth, 0.0, load, 0.01)
    fmu = run(opened("SphereSphere"), values, 0.01, 1, 1e-10, "event_driven")
    check_relative("force", fmu["contact.normal_force"], force, 1e-9)
