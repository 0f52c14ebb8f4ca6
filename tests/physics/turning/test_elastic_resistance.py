"""Elastic resistance to rolling and spinning of a ball on a plane: by the reference and by closed forms."""

import functools
import math

import numpy as np
import pytest

from support.checks import check_close, check_relative, run
from support.reference.turning import TurningRun

G, MASS, RADIUS, MU, STIFFNESS = 9.81, 1.0, 0.1, 0.05, 2.25
INERTIA = 0.4 * MASS * RADIUS**2
LIMIT = MU * RADIUS * MASS * G  # N m
BALL = {
    "source.rotation": "free", "source.mass": MASS, "source.radius": RADIUS,
    "source.center": [0.0, 0.0, RADIUS - MASS * G / 1e6],  # lies on its spring
    "contact.penalty_factor": 1e6,
}  # fmt: skip


def resisting(kind, stiffness=STIFFNESS, damping=0.0):
    values = {f"contact.{kind}": "elastic", f"contact.{kind}_coefficient": MU}
    values |= {f"contact.{kind}_stiffness": stiffness, f"contact.{kind}_damping": damping}
    return values


FRICTION = {"contact.friction": "elastic", "contact.friction_coefficient": 0.5}
FRICTION |= {"contact.static_friction_coefficient": 0.5, "contact.tangential_stiffness": 1e5}
FRICTION |= {"contact.tangential_damping": 100.0}
SPEED, RATE = 0.3, 5.0
MOVED = {
    "spinning": {"source.initial_angular_velocity": [0.0, 0.0, RATE]},
    "rolling": FRICTION | {"source.initial_velocity": [SPEED, 0.0, 0.0],
        "source.initial_angular_velocity": [0.0, SPEED / RADIUS, 0.0]},
}  # fmt: skip
ENERGY = {"spinning": 0.5 * INERTIA * RATE**2, "rolling": 0.7 * MASS * SPEED**2}
# Before it slides, while it does, just before it sticks, and while it swings on its spring. Without a dashpot
# spinning comes back to its limit, but for rounding, after half a swing at 0.54 s.
TIMES = {"spinning": (0.002, 0.01, 0.3, 0.407, 0.43, 0.53), "rolling": (0.002, 0.43, 0.856, 0.89, 1.25)}
# The third slides from the start on.
DAMPINGS = {"spinning": (0.0, 0.002, 0.02), "rolling": (0.0, 0.01, 0.2)}
MOTIONS = [(kind, damping) for kind, dampings in DAMPINGS.items() for damping in dampings]


@functools.cache
def followed(kind, damping):
    """Figures of the reference at all times, and the names of its events"""
    made = TurningRun(BALL | resisting(kind, damping=damping) | MOVED[kind], "plane")
    return [made.run(time).figures() for time in TIMES[kind]], [name for _, name in made.events]


@pytest.mark.parametrize("kind, damping", MOTIONS)
def test_a_ball_slides_and_then_swings_on_its_spring(opened, kind, damping, method):
    expected, events = followed(kind, damping)
    slides = [f"{kind} slips"] * (damping != DAMPINGS[kind][2])
    assert events == [*slides, f"{kind} sticks"]
    values = BALL | resisting(kind, damping=damping) | MOVED[kind]
    for time, right in zip(TIMES[kind], expected, strict=True):
        fmu = run(opened("SpherePlane"), values, time, 2, 1e-11, method)
        for name in ("source.position", "source.velocity", "source.angular_velocity"):
            turns = kind == "rolling" and "angular" in name
            check_close(name, fmu[name], right[name], 1e-8 if turns else 1e-9)
        for name in ("energy.tangential", "energy.friction"):
            check_close(name, fmu[name], right[name], 1e-9 * ENERGY[kind])
    fmu = run(opened("SpherePlane"), values, time + 0.4, 2, 1e-11, method)
    assert fmu["solver.events"] == len(events)


def rolled(opened, speed, stiffness, damping, end, method, more=None):
    values = BALL | resisting("rolling", stiffness, damping) | FRICTION
    values |= {
        "source.initial_velocity": [speed, 0.0, 0.0],
        "source.initial_angular_velocity": [0.0, speed / RADIUS, 0.0],
    }
    return run(opened("SpherePlane"), values | (more or {}), end, 2, 1e-11, method)


def test_a_ball_on_a_sticking_spring_swings_with_the_period_of_rolling_without_slip(opened):
    """2 pi sqrt((I + m r^2)/k), but for the friction spring's part k/(k_t r^2) = 2e-3 of the compliance."""
    omega = math.sqrt(STIFFNESS / (1.4 * MASS * RADIUS**2))
    period = 2 * math.pi / omega
    speed = 0.5 * RADIUS * omega * LIMIT / STIFFNESS  # half of what would break it away
    fmu = rolled(opened, speed, STIFFNESS, 0.0, period, "event_driven")
    check_relative("velocity after a period", fmu["source.velocity"][0], speed, 1e-3)
    fmu = rolled(opened, speed, STIFFNESS, 0.0, 0.25 * period, "event_driven")
    check_relative("way of a quarter", fmu["source.position"][0], speed / omega, 2e-3)
    check_close("solver.events", fmu["solver.events"], 0, 0)


@pytest.mark.parametrize("stiffness", [20.0, 200.0])
def test_the_way_of_rolling_approaches_that_of_a_rigid_resistance(opened, stiffness):
    """7 v^2/(10 mu_r g): L takes all energy, since the dashpot lets the spring slide from the start on; then
    the ball rolls back by the spring's angle L/k. Friction, whose spring is stiff, adds 1e-7 m."""
    speed, inertia = 0.3, 1.4 * MASS * RADIUS**2
    rigid = {"contact.tangential_stiffness": 1e7, "contact.tangential_damping": 2000.0}
    damping = 2.0 * math.sqrt(stiffness * inertia)
    assert damping * speed / RADIUS > LIMIT
    fmu = rolled(opened, speed, stiffness, damping, 3.0, "event_driven", rigid)
    assert np.linalg.norm(fmu["source.velocity"]) < 1e-9
    way = 7 * speed**2 / (10 * MU * G) - fmu["source.position"][0]
    check_close("way", way, RADIUS * LIMIT / stiffness, 1e-7)
