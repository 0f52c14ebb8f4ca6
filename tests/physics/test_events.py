"""Contacts begin when they must, none is missed however long the communication step, and finite cylinders
end where they end."""

import math

import numpy as np
import pytest

from support.checks import FMU, check_close, run
from support.reference.integrator import Reference
from support.scenes.head_on import GAP, GEOMETRIES, SPEED, approach, head_on

EXACT = 1e-11  # s


@pytest.mark.parametrize("seed", range(12))
def test_a_long_throw_comes_down_on_a_small_body_in_one_step(opened, shape, seed, method):
    """A parabola of many seconds aimed within a radius or so of a small body: hit or miss as in the
    reference."""
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
    """A ball lying at the bottom of a finite tube along y, sunk in by m g / k, sliding along with 1 m/s."""
    values = {"source.radius": 0.1, "source.center": [0.0, 0.0, -0.4 - 9.81e-4]}
    values |= {"source.initial_velocity": [0.0, 1.0, 0.0], "destination.radius": 0.5}
    values |= {"destination.axis": [0.0, 1.0, 0.0], "destination.finite_length": True}
    values |= {"destination.length": 1.0, "contact.penalty_factor": 1e4, "contact.method": "penalty_dynamic"}
    return {**values, **more}


@pytest.mark.parametrize("steps", [1, 10, 1000])
def test_a_ball_slides_to_the_tubes_end_and_falls(opened, steps, method):
    """The force ends at t = L / 2v = 0.5 s; from there on free fall, and the stored energy is booked as
    dissipated."""
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
    """Sliding in from outside at a depth held by nothing: the booked work is minus the energy the
    contact then stores."""
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
    """The cylinder moves, the ball floats at its wall's depth: within while |c.e_d| <= L/2, 0.1 s to 0.6
    s."""
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
    """When a step ends the bodies stand at the touch to rounding, be it by 1e-17 m too deep, where an
    impact goes no deeper than SPEED / rate: it gives back the speed it takes"""
    mass = 1e-9
    values = head_on(shape, location, source_mass=mass, contact_penalty_factor=mass * rate**2)
    fmu = run(opened(FMU[shape]), values, 2 * GAP, 2 * steps, None, "event_driven")
    assert fmu["contact.onsets"] == 1
    check_close("velocity", fmu["source.velocity"], -SPEED * approach(location), 1e-12)
