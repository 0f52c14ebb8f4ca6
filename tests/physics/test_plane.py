"""A sphere and a plane: everything is closed form, and holds to rounding whatever the communication step."""

import math
from decimal import Decimal
from functools import cache

import numpy as np
import pytest

from support.checks import DASHPOTS, check_close, run, start
from support.reference.integrator import Reference
from support.scenes.random_scenes import random_scene

FMU = "SpherePlane"
TILTED = np.array([0.36, -0.48, 0.8])  # unit, to rounding
GRAVITY = np.array([0.0, 0.0, -9.81])
STEPS = [1, 997]


def bounce(normal=(0.0, 0.0, 1.0), gap=0.5, **more):
    """A ball is over a plane through the origin."""
    normal = np.array(normal)
    values = {"source.center": ((0.1 + gap) * normal).tolist(), "source.initial_velocity": [0.3, -0.2, 0.0]}
    values |= {"destination.axis": normal.tolist(), "contact.penalty_factor": 1e6}
    values |= {"contact.viscous_penalty_factor": 60.0, **more}
    return values


MOVED = {
    "free": {"destination.motion": "free", "destination.mass": 2.5,
        "destination.initial_velocity": [0.1, 0.2, 0.9], "destination.external_force": [0.0, 1.0, 3.0]},
    "moved steadily": {"destination.motion": "prescribed",
        "destination.prescribed_velocity": [0.2, -0.1, 0.4],
        "destination.prescribed_displacement.derivatives": [[0.2, -0.1, 0.4]]},
    "fixed": {},
}  # fmt: skip


@cache
def bounced(normal, motion, method):
    """Returns the values, their end, and the motion in many digits."""
    law = {"contact.method": "penalty"} if method == "penalty" else {"contact.dashpot": method}
    values, end = bounce(normal, **MOVED[motion], **law), 2.0 if motion == "fixed" else 1.5
    return values, end, Reference(values, "plane", Decimal, 28).run(end)


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("method", ["penalty", *DASHPOTS])
@pytest.mark.parametrize("motion", MOVED)
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), TILTED], ids=["level", "inclined"])
def test_bounces_on_a_plane_are_those_of_the_reference(opened, normal, motion, method, steps):
    """A free plane of finite mass takes its share, and one that is moved bats the ball."""
    values, end, right = bounced(tuple(normal), motion, method)
    fmu = run(opened(FMU), values, end, steps)
    for body in ("source", "destination"):
        check_close("position", fmu[f"{body}.position"], [float(x) for x in right.position[body]], 1e-12)
        check_close("velocity", fmu[f"{body}.velocity"], [float(x) for x in right.velocity[body]], 1e-11)
    assert fmu["contact.onsets"] == right.onsets
    check_close("onset", fmu["contact.last_onset_time"], float(right.onset_times[-1]), 1e-12)
    check_close("energy", fmu["energy.total"], start(opened(FMU), values)["energy.total"], 1e-12)


@pytest.mark.parametrize("kind", ["driven by a force", "moving destination"])
def test_polynomial_inputs_are_followed_to_rounding(opened, kind):
    """A force grows, or a plane speeds up: forty digits are the reference."""
    values, end = random_scene("plane", kind, 100)
    right = Reference(values, "plane", Decimal, 28).run(end)
    place = [float(x) for x in right.position["source"]]
    for steps in STEPS:
        fmu = run(opened(FMU), values, end, steps)
        check_close("position", fmu["source.position"], place, 1e-11)
        assert fmu["contact.onsets"] == right.onsets


@pytest.mark.parametrize("share", [0.0, 0.05, 2.0])
@pytest.mark.parametrize("stiffness", [1e5, 1e8, 1e11])
def test_a_growing_load_costs_no_more_on_a_stiffer_plane(opened, stiffness, share):
    """The ball swings about the load without damping and follows it with damping, two seconds in one step."""
    values = bounce(gap=0.0, **{"contact.penalty_factor": stiffness})
    values |= {"source.initial_velocity": [0.0, 0.0, 0.0]}
    values |= {"contact.viscous_penalty_factor": 2 * share * math.sqrt(stiffness)}
    values |= {"source.external_force": [0.0, 0.0, -1.0]}
    values |= {"source.external_force.derivatives": [[2.0, 0.0, -3.0], [0.0, -1.0, 1.0]]}
    fmu = run(opened(FMU), values, 2.0, 1)
    assert fmu["solver.steps"] < 20
    # x'' + 2 z w x' + w^2 x = a + b t + t^2 / 2 for the penetration -x, from rest at 0: powers of t, and an
    # oscillation that is left where nothing damps it
    a, b, two_z = -10.81, -3.0, 2 * share / math.sqrt(stiffness)
    third = 1 / (2 * stiffness)
    second = b / stiffness - 2 * two_z * third
    first = a / stiffness - two_z * second - 2 * third / stiffness
    gap = first + 2.0 * second + 4.0 * third
    if share == 0.0:
        omega = math.sqrt(stiffness)
        gap -= first * math.cos(2 * omega) + second / omega * math.sin(2 * omega)
    # Two seconds are omega times so many radians, which are known to rounding.
    phase = 0.0 if share else 1e-15 * 2 * math.sqrt(stiffness) * abs(first)
    check_close("gap", fmu["contact.gap"], gap, 1e-16 + phase)
    check_close("energy", fmu["energy.total"], start(fmu, values)["energy.total"], 1e-13)


def test_a_contact_that_lasts_takes_few_steps_at_any_stiffness(opened):
    """A damped ball set down on a slope slides for ten seconds, at 1e3 to 1e15 N/m."""
    for stiffness in (1e3, 1e7, 1e11, 1e15):
        values = bounce(TILTED, 0.0, **{"contact.penalty_factor": stiffness})
        values["source.initial_velocity"] = [0.0, 0.0, 0.0]
        values["contact.viscous_penalty_factor"] = 0.4 * math.sqrt(stiffness)
        fmu = run(opened(FMU), values, 10.0, 1)
        assert fmu["solver.steps"] < 100
        slope = GRAVITY - (GRAVITY @ TILTED) * TILTED
        check_close("slid", fmu["source.displacement"], 50 * slope - 9.81 * 0.8 / stiffness * TILTED, 1e-10)


def test_below_the_surface_is_but_a_deeper_contact(opened, method):
    """The centre starts 0.05 m below the plane and passes through its height: no direction is lost."""
    values = bounce(gap=-0.15, **{"contact.method": "penalty", "contact.penalty_factor": 2000.0})
    fmu = opened(FMU)
    start(fmu, values, 1e-10, method)
    check_close("distance", fmu["contact.distance"], -0.05, 1e-15)
    check_close("direction", fmu["contact.direction"], [0.0, 0.0, -1.0], 0.0)
    check_close("force", fmu["contact.source_force"], [0.0, 0.0, 300.0], 1e-9)
    run(fmu, values, 0.3, 3, method=method)
    omega = math.sqrt(2000.0)
    still = -9.81 / 2000.0
    leaves = math.acos(still / (0.15 + still)) / omega  # still - (0.15 + still) cos(omega t) = 0
    speed = (0.15 + still) * omega * math.sin(omega * leaves)
    expected = speed * (0.3 - leaves) - 4.905 * (0.3 - leaves) ** 2
    check_close("gap", fmu["contact.gap"], expected, 1e-6 if method != "event_driven" else 1e-12)
    assert not any("no defined normal" in str(message) for message in fmu.messages)


def test_passing_the_surface_exactly_at_its_centre(opened):
    """The motion is prescribed: d = 0 to the last bit at a communication point."""
    held = {"source.motion": "fixed", "contact.penalty_factor": 1e3, "contact.method": "penalty"}
    fmu = run(opened(FMU), bounce(gap=-0.1, **held), 0.1, 2)
    assert fmu["contact.distance"] == 0.0
    check_close("force", fmu["contact.normal_force"], 100.0, 1e-12)


def test_a_ball_slides_along_a_plane_that_may_turn_where_it_just_touches_it(opened):
    along = bounce(gap=0.0, **{"destination.rotation": "prescribed", "gravity": [1.0, 0.0, 0.0]})
    assert run(opened(FMU), along, 1.0, 1)["contact.onsets"] == 0
