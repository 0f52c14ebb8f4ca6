"""Bounce trains that die out: as many contacts as there are, when they are, in one step or 997.

A ball is dropped by 1 m with a restitution of one half, on and in spheres and cylinders; plane_motion.py
has each bounce in closed form, in sixty digits."""

import math
from decimal import Decimal
from functools import cache

import numpy as np
import pytest
from mpmath import mpf, workdps
from scipy.optimize import brentq

from support.checks import FMU, check_close, check_relative, run
from support.reference.integrator import Reference
from support.reference.plane_motion import plane_motion
from support.scenes.head_on import ACROSS, AXIS, GEOMETRIES, oscillator

METHOD, TOLERANCE = "event_driven", 1e-10
DROP, RESTITUTION, WEIGHT = 1.0, 0.5, 9.81
END = 2.0  # s, of which the train takes 1.35
DASHPOTS = ["unclamped", "non_adhesive"]
STIFFNESSES = [1e4, 1e6, 1e8, 1e10, 1e13, 1e15]
WORK = 200_000  # internal steps of a run at most
EXACT = 1e-10  # s


def damping(dashpot, stiffness):
    """Returns p_nv for 1 kg that leaves half of the speed without gravity."""

    def excess(share):
        given = 2 * share * math.sqrt(stiffness)
        return oscillator(dashpot, 1.0, stiffness, given).restitution - RESTITUTION

    return 2 * math.sqrt(stiffness) * brentq(excess, 1e-3, 0.9)


@cache
def train(dashpot, stiffness, height=DROP):
    return plane_motion(height, 0, -WEIGHT, 1, stiffness, damping(dashpot, stiffness), dashpot, END)


def durations(train):
    return [end - begin for begin, end in zip(train.onset_times, train.end_times, strict=False)]


def drop(shape, location, dashpot, stiffness):
    """The ball falls along -ACROSS onto the outside, and along ACROSS in a hollow body of 2 m."""
    inside = location == "inside"
    radius = 2.0 if inside else 0.5
    outward = 1.0 if inside else -1.0
    distance = radius - 0.1 - DROP if inside else radius + 0.1 + DROP
    values = {"source.center": (distance * ACROSS).tolist(), "destination.radius": radius}
    values |= {"contact.location": location, "contact.dashpot": dashpot, "contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": damping(dashpot, stiffness)}
    values |= {"gravity": (outward * WEIGHT * ACROSS).tolist()}
    return {**values, "destination.axis": AXIS.tolist()} if shape == "cylinder" else values


def late(expected):
    """Returns the allowed error of the last onset, whose path is rounded and slow."""
    flight = expected.onset_times[-1] - expected.end_times[-1]
    return EXACT + 16 * np.finfo(float).eps * 2.0 / float(WEIGHT * flight / 2)


@pytest.mark.parametrize("dashpot", DASHPOTS)
def test_the_closed_form_is_the_reference_integrators(dashpot):
    """Two independent methods agree in many digits."""
    expected = train(dashpot, 1e6)
    values = drop("sphere", "outside", dashpot, 1e6)
    values.update({"source.center": [0.0, 0.0, 1.6], "gravity": [0.0, 0.0, -WEIGHT]})
    followed = Reference(values, "sphere", number=Decimal, order=30).run(1.4)
    assert followed.onsets == len(expected.onset_times)
    with workdps(40):
        height = mpf(1.6) - mpf(0.1) - mpf(0.5)  # of the numbers given
    given = train(dashpot, 1e6, height)
    check_close("onset times", np.float64(followed.onset_times), [float(t) for t in given.onset_times], 1e-15)
    check_close("durations", np.float64(followed.durations), [float(t) for t in durations(given)], 1e-15)


@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("dashpot", DASHPOTS)
def test_rounding_does_not_decide_the_count(dashpot, stiffness):
    counts = {len(train(dashpot, stiffness, DROP * (1 + nudge)).onset_times) for nudge in (-1e-9, 0.0, 1e-9)}
    assert len(counts) == 1
    assert len(train(dashpot, stiffness).end_times) == counts.pop() - 1


@pytest.mark.parametrize("steps", [1, 997])
@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("dashpot", DASHPOTS)
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_each_bounce_is_counted_until_the_ball_rests(opened, shape, location, dashpot, stiffness, steps):
    values = drop(shape, location, dashpot, stiffness)
    values["solver.max_internal_steps"] = WORK // steps
    expected = train(dashpot, stiffness)
    fmu = run(opened(FMU[shape]), values, END, steps, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == len(expected.onset_times)
    last = float(expected.onset_times[-1])
    check_close("last_onset_time", fmu["contact.last_onset_time"], last, late(expected))
    check_close("last_duration", fmu["contact.last_duration"], END - last, late(expected))
    assert fmu["contact.active"] is True
    rest = WEIGHT / stiffness
    swing = 2 * rest * math.exp(-damping(dashpot, stiffness) / 2 * (END - last))  # what is left of it at most
    check_close("gap", fmu["contact.gap"], -rest, swing + 1e-15)
    check_close("velocity", fmu["source.velocity"], [0, 0, 0], (swing + 1e-14) * math.sqrt(stiffness))


@pytest.mark.parametrize("steps", [1, 997])
@pytest.mark.parametrize("dashpot", DASHPOTS)
def test_the_train_is_told_bounce_by_bounce(opened, dashpot, steps):
    """Between two onsets of the closed form the FMU has counted the first one only."""
    fmu, expected = opened("SphereSphere"), train(dashpot, 1e6)
    times = [float(t) for t in expected.onset_times]
    run(fmu, drop("sphere", "outside", dashpot, 1e6), times[0] / 2, 1, TOLERANCE, METHOD)
    middles = [(a + b) / 2 for a, b in zip(times, [*times[1:], END], strict=True)]
    for count, (time, middle) in enumerate(zip(times, middles, strict=True), start=1):
        size = (middle - fmu.time) / steps
        for _ in range(steps):
            fmu.step(size)
        assert fmu["contact.onsets"] == count
        check_close("last_onset_time", fmu["contact.last_onset_time"], time, EXACT)
        lasts = float(durations(expected)[count - 1]) if count <= len(expected.end_times) else END
        check_close("last_duration", fmu["contact.last_duration"], min(lasts, fmu.time - time), EXACT)


@pytest.mark.parametrize("steps", [1, 997])
def test_a_ball_whispers_around_a_hollow_body(opened, shape, steps):
    """Without gravity and damping each bounce is like the first, a graze at a hundredth of the speed
    along the wall; the period is the reference integrator's, and hundreds of them fit."""
    values = {
        "destination.radius": 0.5,
        "source.center": (0.4 * ACROSS).tolist(),
        "source.initial_velocity": (1.0 * np.cross(AXIS, ACROSS) + 0.01 * ACROSS).tolist(),
        "contact.location": "inside", "contact.method": "penalty", "contact.penalty_factor": 1e10,
        "gravity": [0.0, 0.0, 0.0],
    }  # fmt: skip
    if shape == "cylinder":
        values["destination.axis"] = AXIS.tolist()
    first = Reference(values, shape, number=Decimal, order=30).run(0.03)
    assert first.onsets >= 3
    start = first.onset_times[0]
    period = first.onset_times[2] - first.onset_times[1]
    end = 2.0
    bounces = int((Decimal(end) - start) / period) + 1
    fmu = run(opened(FMU[shape]), values, end, steps, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == bounces > 200
    last = float(start + (bounces - 1) * period)
    # Rounded energy rounds the speed at the wall, a hundredth of that along it: the period is 0.8 s of it.
    allowed = 32 * np.finfo(float).eps / 0.01 * 2 * 0.4 * bounces**2 / 2
    check_close("last_onset_time", fmu["contact.last_onset_time"], last, allowed)
    check_relative("speed", np.linalg.norm(fmu["source.velocity"]), math.hypot(1.0, 0.01), 1e-12)
