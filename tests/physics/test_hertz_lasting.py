"""Lasting contact under Hertz's law: what creeps is followed in few steps, its force is as exact as the
motion, an oscillation is followed as long as it matters, and the work does not follow the modulus"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contact_fmus.bench.problems import law_benchmarks
from support.checks import check_close, check_relative, run, start
from support.reference.hertz import follow
from support.scenes.law_scenes import by_hertz

RADIUS, OTHER = 0.1, 0.5


def values_of(stiffness, chi, depth, speed, load, dashpot):
    values = {"source.radius": RADIUS, "source.mass": 1.0}
    values |= {"source.center": [0.0, 0.0, RADIUS + OTHER - depth]}
    values |= {"source.initial_velocity": [0.0, 0.0, -speed], "destination.radius": OTHER}
    values |= {"contact.dashpot": dashpot, "gravity": [0.0, 0.0, -load], "solver.max_internal_steps": 20_000}
    values |= {**by_hertz(stiffness, chi)}
    return values


def creep(stiffness, chi, depth, speed, load, end):
    """Depth, its rate and the force of a unit mass by Radau's method of scipy, in parts of depth and 1/chi"""

    def force(y):
        return stiffness * max(depth * y[0], 0.0) ** 1.5 * (1 + y[1])

    def rates(_t, y):
        return y[1] / (chi * depth), chi * (load - force(y))

    y = solve_ivp(rates, (0, end), (1.0, chi * speed), "Radau", rtol=1e-11, atol=1e-13).y[:, -1]
    return depth * y[0], y[1] / chi, force(y)


@pytest.mark.parametrize("chi, depth, speed, load, end, most", [
    (1e6, 1e-4, 0.0, 9.81, 0.1, 20),  # less deep than at rest: it sinks
    (1e5, 4e-3, 0.0, 9.81, 0.05, 40),  # deeper: it rises
    (1e3, 0.03, 0.0, 0.0, 15.0, 40),  # pushed out without a load
    (1e3, 0.03, 0.0, -20.0, 15.0, 40),  # and pulled
    (1e7, 1e-7, 0.2, 9.81, 0.2, 100),  # an impact that hardly ends
])  # fmt: skip
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


@pytest.mark.parametrize("pull", [1e-7, 5e-6, 1e-3])
def test_a_light_load_adds_to_the_speed_at_which_a_deep_overlap_is_left(opened, pull):
    """The load is down to 1e-10 of the spring's force, which the dashpot holds back to a speed of 1/chi."""
    stiffness, chi, deepest, end = 1e6, 20.0, 0.01, 0.1
    values = values_of(stiffness, chi, deepest, 0.0, -pull, "non_adhesive")
    right, _ = follow("SphereSphere", values, end)
    fmu = run(opened("SphereSphere"), values, end, 1, 1e-10)
    check_close("speed", fmu["source.velocity"][2], right[8], 1e-12)
    check_close("place", fmu["source.position"][2], right[2], 1e-13)
    assert fmu["solver.events"] == 1


def test_an_oscillation_is_followed_as_long_as_the_tolerance_asks(opened):
    """P3 slides on after its oscillation has died away: a coarser tolerance sees that sooner, and force and
    position are as good as it asks."""
    problem = law_benchmarks()["P3 Hertz"]
    fmu, values, end = problem.fmu, problem.start, problem.stop
    steps = []
    for time in (0.25 * end, end):  # while it dies away, and long after
        fine = run(opened(fmu), values, time, 1, 1e-12)["contact.normal_force"]
        for tolerance in (1e-4, 1e-6, 1e-9):
            made = run(opened(fmu), values, time, 1, tolerance)
            check_relative("force", made["contact.normal_force"], fine, 3 * tolerance)
            steps.append(made["solver.steps"])
    check_close("position", made["source.position"], problem.position, 1e-12)
    assert steps[3] < 0.9 * steps[5]


def resting(modulus, share):
    """A ball in a hollow cylinder at the depth that its load presses it to, sliding along and about the axis,
    with so much of the critical damping there."""
    speed, mass, reach = 0.5, 0.1, OTHER - RADIUS
    stiffness = 4 / 3 * modulus * np.sqrt(RADIUS * OTHER / reach)
    load = 9.81 + speed**2 / reach
    depth = (mass * load / stiffness) ** (2 / 3)
    critical = 2 * np.sqrt(1.5 * stiffness * np.sqrt(depth) * mass)
    values = {"source.radius": RADIUS, "source.mass": mass, "source.motion": "free"}
    values |= {"source.center": [0.0, 0.0, -reach - depth], "source.initial_velocity": [speed, 0.1, 0.0]}
    values |= {"destination.radius": OTHER, "destination.motion": "fixed"}
    values |= {"destination.axis": [0.0, 1.0, 0.0], "contact.location": "inside"}
    values |= {"contact.dashpot": "unclamped"}
    values |= {**by_hertz(stiffness, share * critical / (stiffness * depth**1.5))}
    return values


@pytest.mark.parametrize("share", [0.1, 1.0, 20.0])
def test_the_work_does_not_follow_the_modulus(opened, share):
    """Internal steps; at 1e13 Pa the contact oscillates 1e5 times a second."""
    steps = []
    for modulus in (1e7, 1e9, 1e11, 1e13):
        fmu = run(opened("SphereCylinder"), resting(modulus, share), 2.0, 1, 1e-8)
        steps.append(fmu["solver.steps"])
        assert fmu["solver.fallbacks"] == 0
    assert max(steps) <= 1.5 * steps[0] + 20, steps
