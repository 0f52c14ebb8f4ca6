"""event_driven under Hertz's law: closed forms at every speed and modulus, and the work of lasting contact
whatever the modulus. Benchmarks and random scenes are test_law_scenes.py's."""

from math import log1p, sqrt

import pytest
from scipy.integrate import solve_ivp

from contact_fmus.bench.problems import law_benchmarks
from support.checks import check_close, check_relative, run
from support.reference.hertz import restitution_of
from support.scenes.law_scenes import by_hertz

METHOD = "event_driven"
MODULI = (1e5, 1e7, 1e9, 1e11, 1e13)
SPEEDS = (1e-6, 1e-3, 1.0, 1e3)
RADIUS, OTHER, MASS = 0.1, 0.5, 1.0
EFFECTIVE_RADIUS = RADIUS * OTHER / (RADIUS + OTHER)


def stiffness_of(modulus):
    """k_h = 4/3 E* sqrt(R*)"""
    return 4 / 3 * modulus * sqrt(EFFECTIVE_RADIUS)


def ball(modulus, speed, chi=0.0, dashpot="unclamped"):
    return {
        "source.radius": RADIUS,
        "source.mass": MASS,
        "source.motion": "free",
        "source.center": [0.0, 0.0, RADIUS + OTHER],
        "source.initial_velocity": [0.0, 0.0, -speed],
        "destination.radius": OTHER,
        "destination.motion": "fixed",
        "contact.dashpot": dashpot,
        "gravity": [0.0, 0.0, 0.0],
        **by_hertz(stiffness_of(modulus), chi),
    }


def deepest_of(modulus, speed):
    return (1.25 * MASS * speed**2 / stiffness_of(modulus)) ** 0.4


def on_the_way(modulus, speed):
    return deepest_of(modulus, speed) < OTHER


@pytest.mark.parametrize("dashpot", ["unclamped", "non_adhesive", "approach_only"])
@pytest.mark.parametrize("damped", [0.1, 1.0, 10.0])
def test_a_damped_impact_is_that_of_hunt_and_crossley(opened, damped, dashpot):
    for modulus in MODULI:
        for speed in SPEEDS:
            if not on_the_way(modulus, speed):
                continue
            chi, stiffness = damped / speed, stiffness_of(modulus)
            deepest = (2.5 * MASS / stiffness * (damped - log1p(damped)) / chi**2) ** 0.4
            e = restitution_of(damped, dashpot)
            values = ball(modulus, speed, chi, dashpot)
            fmu = run(
                opened("SphereSphere"), values, 20 * deepest_of(modulus, speed) / speed, 1, 1e-8, METHOD
            )
            check_relative("depth", fmu["contact.peak_penetration"], deepest, 1e-11)
            check_relative("speed", fmu["source.velocity"][2], e * speed, 1e-11)
            kinetic = 0.5 * MASS * speed**2
            check_close("energy", fmu["energy.total"], kinetic, 1e-12 * kinetic)


def pushed_out(stiffness, chi, pull, deepest, end):
    """Gap and rate at `end` of a unit mass that leaves an overlap against a dashpot that never pulls, while a
    load pulls it out: by Dormand and Prince's method to where the force is zero, free from there on."""

    def rates(_t, y):
        return y[1], pull + stiffness * (-y[0]) ** 1.5 * (1 - chi * y[1])

    def margin(_t, y):
        return 1 - chi * y[1]

    margin.terminal = True
    found = solve_ivp(
        rates, (0, end), (-deepest, 0.0), "DOP853", events=margin, rtol=1e-13, atol=1e-18, max_step=5e-5
    )
    left, (gap, rate) = end - found.t[-1], found.y[:, -1]
    return gap + rate * left + 0.5 * pull * left**2, rate + pull * left


@pytest.mark.parametrize("pull", [1e-7, 5e-6, 1e-3])
def test_a_light_load_adds_to_the_speed_at_which_a_deep_overlap_is_left(opened, pull):
    """The load is down to 1e-10 of the spring's force, which the dashpot holds back to a speed of 1/chi."""
    stiffness, chi, deepest, end = 1e6, 20.0, 0.01, 0.1
    values = ball(1.0, 0.0) | by_hertz(stiffness, chi)
    values |= {"contact.dashpot": "non_adhesive", "gravity": [0.0, 0.0, pull]}
    values["source.center"] = [0.0, 0.0, RADIUS + OTHER - deepest]
    gap, rate = pushed_out(stiffness, chi, pull, deepest, end)
    fmu = run(opened("SphereSphere"), values, end, 1, 1e-10, METHOD)
    check_close("speed", fmu["source.velocity"][2], rate, 1e-12)
    check_close("gap", fmu["contact.gap"], gap, 1e-13)
    assert fmu["solver.events"] == 1


def test_an_oscillation_is_followed_as_long_as_the_tolerance_asks(opened):
    """P3 slides on after its oscillation has died away: a coarser tolerance sees that sooner, and force and
    position are as good as it asks."""
    problem = law_benchmarks()["P3 Hertz"]
    fmu, values, end = problem.fmu, problem.start, problem.stop
    steps = []
    for time in (0.25 * end, end):  # while it dies away, and long after
        fine = run(opened(fmu), values, time, 1, 1e-12, METHOD)["contact.normal_force"]
        for tolerance in (1e-4, 1e-6, 1e-9):
            made = run(opened(fmu), values, time, 1, tolerance, METHOD)
            check_relative("force", made["contact.normal_force"], fine, 3 * tolerance)
            steps.append(made["solver.steps"])
    check_close("position", made["source.position"], problem.position, 1e-12)
    assert steps[3] < 0.9 * steps[5]


def resting(modulus, share):
    """A ball in a hollow cylinder at the depth that its load presses it to, sliding along and about the axis,
    with so much of the critical damping there."""
    speed, mass, reach = 0.5, 0.1, OTHER - RADIUS
    stiffness = 4 / 3 * modulus * sqrt(RADIUS * OTHER / reach)
    load = 9.81 + speed**2 / reach
    depth = (mass * load / stiffness) ** (2 / 3)
    critical = 2 * sqrt(1.5 * stiffness * sqrt(depth) * mass)
    return {
        "source.radius": RADIUS,
        "source.mass": mass,
        "source.motion": "free",
        "source.center": [0.0, 0.0, -reach - depth],
        "source.initial_velocity": [speed, 0.1, 0.0],
        "destination.radius": OTHER,
        "destination.motion": "fixed",
        "destination.axis": [0.0, 1.0, 0.0],
        "contact.location": "inside",
        "contact.dashpot": "unclamped",
        **by_hertz(stiffness, share * critical / (stiffness * depth**1.5)),
    }


@pytest.mark.parametrize("share", [0.1, 1.0, 20.0])
def test_the_work_does_not_follow_the_modulus(opened, share):
    """Internal steps; at 1e13 Pa the contact oscillates 1e5 times a second."""
    steps = []
    for modulus in (1e7, 1e9, 1e11, 1e13):
        fmu = run(opened("SphereCylinder"), resting(modulus, share), 2.0, 1, 1e-8, METHOD)
        steps.append(fmu["solver.steps"])
        assert fmu["solver.fallbacks"] == 0
    assert max(steps) <= 1.5 * steps[0] + 20, steps
