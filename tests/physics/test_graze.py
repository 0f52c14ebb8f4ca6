"""Grazes: the impact speed is a small part of the speed along the surface, down to 1e-12 of it. They are
counted, last as long and push as hard as the closed form or the reference integrator says. None hangs."""

import math
from decimal import Decimal

import numpy as np
import pytest

from support.checks import FMU, check_close, run
from support.reference.integrator import Reference
from support.scenes.head_on import AXIS, GAP, GEOMETRIES, SPEED, approach, head_on, oscillator, passing

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
    """The ball has 1000 m/s along the axis, `share` of it towards the surface: head-on but for rounding."""
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
    onset = float(expected.onset_times[0])
    check_close("onset", fmu["contact.last_onset_time"], onset, length / speed + 1e-15)
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
    """The depth is at most `overlap`: the impact has sqrt(2 overlap / 0.6 m) of the speed, down to 6e-7."""
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
    """The bodies touch exactly at the start, with `share` of the speed into the other body and no gravity."""
    inside = location == "inside"
    values = {"destination.radius": 0.5, "source.center": [0.0, 0.0, 0.4 if inside else 0.6]}
    values |= {"source.initial_velocity": [speed, 0.0, (1 if inside else -1) * share * speed]}
    values |= {"contact.location": location, "contact.method": "penalty", "gravity": [0.0, 0.0, 0.0]}
    return values


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("share", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("location, speed, allowed", [("outside", 10.0, 1e-12), ("inside", 1.0, 1e-11)])
def test_a_graze_that_starts_touching(opened, location, speed, allowed, share, steps):
    """Outside, the ball is away within 2 share R / v, at a depth of R share^2 / 2, mostly far below the last
    digit of R. Inside, it is thrown against the wall and comes off at each turn of its oscillation, or never
    where `share` is below rounding. The motion is the same."""
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


# Contacts begin when they must, none is missed in long communication steps, and finite cylinders have ends.

EXACT = 1e-11  # s


@pytest.mark.parametrize("seed", range(12))
def test_a_long_throw_comes_down_on_a_small_body_in_one_step(opened, shape, seed, method):
    """A parabola of seconds is aimed near a small body. It hits or misses as in the reference."""
    random = np.random.default_rng(seed)
    flight, gravity = random.uniform(5, 20), np.array([0.0, 0.0, -9.81])
    aim = 0.012 * random.uniform(-1, 1, size=3)
    velocity = np.array([*random.uniform(-20, 20, size=2), 9.81 * flight * random.uniform(0.2, 0.8)])
    values = {
        "source.radius": 0.002, "destination.radius": 0.01, "source.mass": 0.1,
        "source.center": (aim - velocity * flight - gravity * flight**2 / 2).tolist(),
        "source.initial_velocity": velocity.tolist(), "contact.penalty_factor": 1e9,
        "contact.method": "penalty_dynamic", "contact.viscous_penalty_factor": 300.0,
    }  # fmt: skip
    if shape == "cylinder":
        values["destination.axis"] = random.normal(size=3).tolist()
    end = flight + 0.1
    expected = Reference(values, shape).run(end)
    fmu = run(opened(FMU[shape]), values, end, 1, method=method)
    assert fmu["contact.onsets"] == expected.onsets
    if not expected.onsets:
        check_close("position", fmu["source.position"], expected.position["source"], 1e-6)
        return
    # 1e-10 of a throw of 1000 m, at 100 m/s; where it hits the 1 cm body decides where it goes.
    check_close("last_onset_time", fmu["contact.last_onset_time"], expected.onset_times[-1], 1e-8)
    check_close("position", fmu["source.position"], expected.position["source"], 1e-3)


def tube(**more):
    """A ball lies at the bottom of a finite tube along y, m g / k deep, and slides along it with 1 m/s."""
    values = {"source.radius": 0.1, "source.center": [0.0, 0.0, -0.4 - 9.81e-4]}
    values |= {"source.initial_velocity": [0.0, 1.0, 0.0], "destination.radius": 0.5}
    values |= {"destination.axis": [0.0, 1.0, 0.0], "destination.finite_length": True}
    values |= {"destination.length": 1.0, "contact.penalty_factor": 1e4, "contact.method": "penalty_dynamic"}
    return {**values, **more}


@pytest.mark.parametrize("steps", [1, 10, 1000])
def test_a_ball_slides_to_the_tubes_end_and_falls(opened, steps, method):
    """The force ends at t = L / 2v = 0.5 s; then it falls, and the stored energy is booked as dissipated."""
    fmu = run(opened("SphereCylinder"), tube(), 1.0, steps, method=method)
    expected = [0.0, 1.0, -0.4 - 9.81e-4 - 9.81 * 0.5**2 / 2]
    check_close("position", fmu["source.position"], expected, 1e-9)
    check_close("velocity", fmu["source.velocity"], [0.0, 1.0, -9.81 * 0.5], 1e-8)
    assert (fmu["contact.onsets"], fmu["contact.within_extents"], fmu["contact.active"]) == (1, False, False)
    check_close("last_duration", fmu["contact.last_duration"], 0.5, EXACT)
    check_close("dissipated", fmu["energy.dissipated"], 1e4 * 9.81e-4**2 / 2, 1e-10)
    assert fmu["contact.gap"] == fmu["contact.gap_beyond_ends"] == 1e30
    assert (fmu["energy.contact"], fmu["contact.normal_force"]) == (0, 0)


def test_a_ball_that_enters_overlapping_gets_the_stored_energy(opened, method):
    """Sliding in from outside at a given depth: the work is minus the energy the contact then stores."""
    depth, stiffness = 1e-3, 1e4
    values = tube(**{"gravity": [0.0, 0.0, 0.0], "contact.method": "penalty"})
    values.update({"source.center": [0.0, -0.7, -0.4 - depth]})
    fmu = run(opened("SphereCylinder"), values, 0.2 + 1e-9, 1, method=method)
    check_close("energy.dissipated", fmu["energy.dissipated"], -stiffness * depth**2 / 2, 1e-12)
    check_close("last_onset_time", fmu["contact.last_onset_time"], 0.2, EXACT)
    fmu.step(0.1)  # half an oscillation at most: thrown off the wall with all of it
    check_close("speed off the wall", fmu["source.velocity"][2], depth * math.sqrt(stiffness), 1e-8)
    check_close("speed along", fmu["source.velocity"][1], 1.0, 1e-13)


def test_a_tube_drawn_over_a_resting_ball_begins_and_ends_with_its_ends(opened, method):
    """The ball floats at the moving wall's depth while |c.e_d| <= L/2, from 0.1 s to 0.6 s."""
    values = tube(**{"gravity": [0.0, 0.0, 0.0], "source.initial_velocity": [0.0, 0.0, 0.0]})
    values.update({"source.center": [0.0, 0.0, -0.3], "destination.center": [0.0, -0.7, 0.0]})
    values.update({"destination.motion": "prescribed", "destination.prescribed_velocity": [0.0, 2.0, 0.0]})
    fmu = run(opened("SphereCylinder"), values, 0.05, 1, method=method)
    inside = []
    for end in (0.0999999, 0.1000001, 0.5999999, 0.6000001):
        fmu.step(end - fmu.time)
        inside.append(fmu["contact.within_extents"])
    assert inside == [False, True, True, False]
    assert fmu["contact.onsets"] == 0
    check_close("position", fmu["source.position"], [0.0, 0.0, -0.3], 1e-12)


@pytest.mark.parametrize("steps", range(1, 24))
@pytest.mark.parametrize("rate", [1e13, 1e17, 1e21])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_touch_at_a_communication_point_is_not_below_it(opened, shape, location, rate, steps):
    """A step ends at the touch to rounding, maybe 1e-17 m too deep. An impact there goes no deeper than SPEED
    / rate and gives back the speed that it takes."""
    mass = 1e-9
    values = head_on(shape, location, source_mass=mass, contact_penalty_factor=mass * rate**2)
    fmu = run(opened(FMU[shape]), values, 2 * GAP, 2 * steps, None, "event_driven")
    assert fmu["contact.onsets"] == 1
    check_close("velocity", fmu["source.velocity"], -SPEED * approach(location), 1e-12)
