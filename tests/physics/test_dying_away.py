"""Contacts that nothing loads, unclamped and at or beyond critical damping: they die away and never part,
wherever the importer stops on the way, in whatever frame."""

import math

import numpy as np
import pytest

from support.checks import FMU, start
from support.reference.pressed import unit

FRAMES = ["fixed", "prescribed", "pair", "flying pair"]


def dying_scene(draw, shape, inside, frame):
    """Returns a configuration, the rate of the slower decay, and the frame's velocity."""
    ratio = float(draw.choice([1.0, 1.001, 1.02, 1.05, 1.2, 1.5, 3.0, 10.0, 100.0]))
    stiffness = 10.0 ** draw.uniform(2.0, 12.0)
    mass = 10.0 ** draw.uniform(-3.0, 3.0)
    other = 10.0 ** draw.uniform(-3.0, 3.0) if "pair" in frame else math.inf
    reduced = 1.0 / (1.0 / mass + 1.0 / other)
    angular = math.sqrt(stiffness / reduced)
    normal, reach, side = unit(draw.normal(size=3)), (0.4 if inside else 0.6), (-1.0 if inside else 1.0)
    values = {"contact.location": "inside" if inside else "outside", "contact.method": "penalty_dynamic"}
    values |= {"contact.dashpot": "unclamped", "contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": 2.0 * ratio * math.sqrt(stiffness * reduced)}
    values |= {"source.mass": mass, "gravity": [0.0, 0.0, 0.0]}
    if shape == "cylinder":
        axis = unit(draw.normal(size=3))
        values["destination.axis"] = list(axis)
        normal = unit(np.cross(axis, draw.normal(size=3)))
    depth = float(draw.choice([0.0, 1e-2, 1e-4, 1e-7]))
    speed = 0.0 if depth else 10.0 ** draw.uniform(-3.0, 0.5)
    drift = unit(draw.normal(size=3)) * 10.0 ** draw.uniform(-1.0, 2.0)
    drift = drift if frame in ("prescribed", "flying pair") else np.zeros(3)
    values["source.center"] = list((reach - side * depth) * normal)
    values["source.initial_velocity"] = list(drift - side * speed * normal)
    if "pair" in frame:
        values["destination.motion"] = "free"
        values["destination.mass"] = other
        values["destination.initial_velocity"] = list(drift)
    if frame == "prescribed":
        values["destination.motion"] = "prescribed"
        values["destination.prescribed_velocity"] = list(drift)
    values["solver.max_internal_steps"] = 20_000
    return values, angular / (ratio + math.sqrt(ratio**2 - 1.0)), drift


def step_to(fmu, frame, drift, time):
    if frame == "prescribed":
        fmu["destination.prescribed_displacement"] = list(drift * fmu.time)
        fmu.set_derivative("destination.prescribed_displacement", list(drift))
    fmu.step(time - fmu.time)


def check_died(fmu):
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.events"] <= 3
    assert fmu["solver.steps"] <= 150


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("inside", [True, False])
def test_a_contact_dies_away_once(opened, shape, inside, frame, seed):
    """Communication points lie from a hundredth to thousands of the slower decay's times."""
    draw = np.random.default_rng([seed, FRAMES.index(frame), inside, shape == "sphere"])
    values, rate, drift = dying_scene(draw, shape, inside, frame)
    fmu = start(opened(FMU[shape]), values, None, "event_driven")
    for time in np.cumsum(10.0 ** draw.uniform(-2.0, 3.5, size=draw.integers(1, 5))) / rate:
        step_to(fmu, frame, drift, time)
    check_died(fmu)


@pytest.mark.parametrize("seed", range(40))
def test_a_stop_one_rounding_beside_the_touch(opened, seed):
    """The ball flies to the wall. The importer stops at the touch, or a rounding before or after it."""
    draw = np.random.default_rng(seed)
    shape, inside = str(draw.choice(list(FMU))), bool(draw.integers(2))
    values, rate, _ = dying_scene(draw, shape, inside, "fixed")
    normal, side = unit(values["source.center"]), (-1.0 if inside else 1.0)
    away, speed = 10.0 ** draw.uniform(-6.0, -1.0), 10.0 ** draw.uniform(-3.0, 1.0)
    values["source.center"] = list(((0.4 if inside else 0.6) + side * away) * normal)
    values["source.initial_velocity"] = list(-side * speed * normal)
    touch = away / speed
    time = {-1: np.nextafter(touch, 0.0), 0: touch, 1: np.nextafter(touch, 1e9)}[int(draw.integers(-1, 2))]
    fmu = start(opened(FMU[shape]), values, None, "event_driven")
    fmu.step(time)
    for wait in (1e-3, 1.0, 100.0, 1e4):
        fmu.step(wait / rate)
    check_died(fmu)
