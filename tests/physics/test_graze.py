"""Grazes: the impact speed is a small part of the speed along the surface, down to 1e-12 of it. They are
counted, last as long and push as hard as the closed form or the reference integrator says, and nothing hangs.
"""

import math
from decimal import Decimal

import numpy as np
import pytest

from support.checks import FMU, check_close, run
from support.reference.integrator import Reference
from support.scenes.head_on import AXIS, head_on, oscillator, passing

METHOD, TOLERANCE = "event_driven", 1e-10
EPSILON = np.finfo(float).eps
ROUNDING = 32  # units in the last place of a coordinate that its sums and products may be off by
STEPS = [1, 997]


def reference(values, shape, end):
    return Reference(values, shape, number=Decimal, order=30).run(end)


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("damping", [0.0, 400.0])
@pytest.mark.parametrize("share", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("location", ["outside", "inside"])
def test_a_graze_along_a_cylinder(opened, location, share, damping, steps):
    """1000 m/s along the axis and `share` of that towards the surface: head-on, but for the rounding of
    50 m."""
    along, stiffness, end = 1000.0, 1e6, 0.05
    speed = share * along
    values = head_on("cylinder", location, gap=0.01 * speed, speed=speed)
    values["source.initial_velocity"] = (np.array(values["source.initial_velocity"]) + along * AXIS).tolist()
    values.update({"contact.viscous_penalty_factor": damping, "contact.dashpot": "non_adhesive"})
    values["contact.method"] = "penalty_dynamic" if damping else "penalty"
    fmu = run(opened("SphereCylinder"), values, end, steps, TOLERANCE, METHOD)
    expected = reference(values, "cylinder", end)
    assert fmu["contact.onsets"] == expected.onsets == 1
    length = ROUNDING * EPSILON * along * end
    check_close(
        "onset", fmu["contact.last_onset_time"], float(expected.onset_times[0]), length / speed + 1e-15
    )
    duration = oscillator("non_adhesive", 1.0, stiffness, damping).duration
    check_close("duration of the reference", float(expected.durations[0]), duration, 1e-15)
    check_close("last_duration", fmu["contact.last_duration"], duration, length / speed + 1e-12 * duration)
    change = np.float64(expected.velocity["source"]) - values["source.initial_velocity"]
    given = ROUNDING * EPSILON * along + length * math.sqrt(stiffness)
    check_close("change of speed", fmu["source.velocity"] - values["source.initial_velocity"], change, given)
    impulse = np.float64(expected.impulse)
    if steps == 1:
        check_close("impulse", fmu["contact.mean_force"] * end, impulse, given)


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("overlap", [1e-3, 1e-6, 1e-9, 1e-11, 1e-12, 1e-13])
def test_a_straight_pass_that_dips_in(opened, shape, overlap, steps):
    """At the deepest by `overlap`: the impact speed is sqrt(2 overlap / 0.6 m) of the speed, down to 6e-7."""
    values, end = passing(shape, -overlap), 1.5
    expected = reference(values, shape, end)
    fmu = run(opened(FMU[shape]), values, end, steps, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == expected.onsets == 1
    impact = 3.0 * math.sqrt(2 * overlap / 0.6)
    late = ROUNDING * EPSILON * 2.6 / impact  # a distance of 2.6 m is rounded
    check_close("onset", fmu["contact.last_onset_time"], float(expected.onset_times[0]), late + 1e-15)
    check_close("last_duration", fmu["contact.last_duration"], float(expected.durations[0]), 2 * late + 1e-15)
    check_close("velocity", fmu["source.velocity"], np.float64(expected.velocity["source"]), 1e-12)
    check_close("position", fmu["source.position"], np.float64(expected.position["source"]), 1e-12)


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("clear", [1e-6, 1e-9, 1e-12, 1e-13])
def test_a_straight_pass_that_just_does_not(opened, shape, clear, steps):
    fmu = run(opened(FMU[shape]), passing(shape, clear), 1.5, steps, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == 0
    assert fmu["solver.events"] == 0


def skimming(location, share, speed):
    """Touching exactly at the start, with `share` of the speed into the other body, no gravity"""
    inside = location == "inside"
    values = {"destination.radius": 0.5, "source.center": [0.0, 0.0, 0.4 if inside else 0.6]}
    values |= {"source.initial_velocity": [speed, 0.0, (1 if inside else -1) * share * speed]}
    values |= {"contact.location": location, "contact.method": "penalty", "gravity": [0.0, 0.0, 0.0]}
    return values


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("share", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("location, speed, allowed", [("outside", 10.0, 1e-12), ("inside", 1.0, 1e-11)])
def test_a_graze_that_starts_touching(opened, location, speed, allowed, share, steps):
    """Outside it is away within 2 share R / v, of which the depth, R share^2 / 2, is far below the last digit
    of R for most. Inside it is thrown round against the wall and comes off again at each turn of its
    oscillation, if only just, or, where `share` is below rounding, never; the motion is the same."""
    values, end = skimming(location, share, speed), 0.1
    expected = reference(values, "sphere", end)
    fmu = run(opened("SphereSphere"), values, end, steps, TOLERANCE, METHOD)
    assert fmu["contact.onsets"] == expected.onsets
    if location == "outside":
        assert (expected.onsets, fmu["contact.last_onset_time"]) == (1, 0.0)
        late = math.sqrt(2 * ROUNDING * EPSILON * 0.6 * 0.6) / speed  # until the surface is a rounding away
        check_close("last_duration", fmu["contact.last_duration"], float(expected.durations[0]), late)
    check_close("velocity", fmu["source.velocity"], np.float64(expected.velocity["source"]), allowed)
    check_close("position", fmu["source.position"], np.float64(expected.position["source"]), 1e-12)
