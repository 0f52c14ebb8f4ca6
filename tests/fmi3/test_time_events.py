"""Model Exchange announces the touches of bodies in flight, in both versions of the standard alike."""

import math

import numpy as np
import pytest

from contact_fmus.fmu.files import fmu_file
from support.checks import check_close
from support.exchange_runs import simulate
from support.fmi2 import raw as raw2
from support.fmi3 import raw
from support.outside import Outside

GRAVITY, REACH = 10.0, 0.6  # m/s², m: both radii
DROP = {"gravity": [0.0, 0.0, -GRAVITY], "contact.method": "penalty", "contact.penalty_factor": 1e5}


def announced(start, scene="SphereSphere", **more):
    """What both versions say at the start, which is one number"""
    told = []
    for instance in (
        raw2.Instance(raw2.load(scene), kind=raw2.MODEL_EXCHANGE),
        raw.Instance(raw.load(scene), exchange=True),
    ):
        with instance:
            told.append(Outside(instance.initialize(start, **more)).begin().announced)
    assert told[0] == told[1]
    return told[0]


PUSHED = {"source.mass": 2.0, "source.external_force": [0.0, 0.0, -8.0]}
TOWARDS = {"gravity": [0.0, 0.0, 0.0], "source.initial_velocity": [0.0, 0.0, -3.0]}
TOWARDS |= {"destination.motion": "free", "destination.initial_velocity": [0.0, 0.0, 1.0]}
FALLS = [({}, height, math.sqrt(2 * height / GRAVITY)) for height in (1e-3, 0.3, 40.0, 1e5)]
FALLS += [(PUSHED, 0.3, math.sqrt(2 * 0.3 / (GRAVITY + 4.0))), (TOWARDS, 1.0, 0.25)]


@pytest.mark.parametrize("values, height, touch", FALLS)
def test_a_fall_ends_when_its_parabola_says(values, height, touch):
    start = {**DROP, "source.center": [0.0, 0.0, REACH + height], **values}
    check_close("touch", announced(start), touch, 1e-12 * max(1.0, height))


def test_an_oblique_flight_touches_where_its_quartic_says():
    """Thrown past the pole: |c0 + v t + g t²/2| = r_s + r_d, by the roots of a polynomial"""
    place, speed = np.array([-2.0, 0.1, 1.0]), np.array([3.0, 0.0, 3.0])
    start = {**DROP, "source.center": place.tolist(), "source.initial_velocity": speed.tolist()}
    terms = [np.array([0.0, 0.0, -GRAVITY / 2]), speed, place]
    squared = sum(np.convolve(along, along) for along in np.transpose(terms))
    squared[-1] -= REACH**2
    first = min(root.real for root in np.roots(squared) if abs(root.imag) < 1e-9 and root.real > 0)
    check_close("touch", announced(start), first, 1e-11)


@pytest.mark.parametrize("what", [
    {"source.center": [0.0, 0.0, 0.9], "destination.motion": "prescribed"},
    {"source.center": [0.0, 0.0, 0.59]},  # they touch already
    {"source.center": [0.0, 0.0, 0.9], "gravity": [0.0, 0.0, 0.0]},
    {"source.center": [0.0, 0.9, 0.0]},  # it falls past
    {"source.center": [0.0, 0.0, 0.6 + 1e-14]},  # too soon to step to
])  # fmt: skip
def test_what_is_not_known_is_not_announced(what):
    assert announced({**DROP, **what}) is None


def test_after_a_bounce_the_next_touch_is_announced():
    height, stiffness = 0.3, DROP["contact.penalty_factor"]
    fall, omega = math.sqrt(2 * height / GRAVITY), math.sqrt(stiffness)
    lasts = 2 / omega * (math.pi - math.atan(omega * fall))  # as in test_event_mode.py
    with raw.Instance(raw.load("SphereSphere"), exchange=True) as instance:
        outside = Outside(instance.initialize({**DROP, "source.center": [0.0, 0.0, REACH + height]})).begin()
        outside.run(0.27, 1e-4)
        assert instance.get("contact.onsets") == 1 and not instance.get("contact.active")
        check_close("touch", outside.announced, 3 * fall + lasts, 1e-7)


PASSES = 0.0505  # s


def graze(speed, depth):
    """Without gravity, past the pole of the sphere, in overlap for a moment in the middle of a millisecond"""
    height = REACH - depth
    half = math.sqrt(REACH**2 - height**2) / speed
    start = {"gravity": [0.0, 0.0, 0.0], "source.center": [-PASSES * speed, 0.0, height]}
    start |= {"source.initial_velocity": [speed, 0.0, 0.0], "contact.penalty_factor": 1e5}
    return {**start, "contact.method": "penalty"}, PASSES - half, 2 * half


def test_a_contact_shorter_than_a_step_is_not_missed():
    """fmpy looks at the event indicators once a millisecond; the bodies touch for a third of one."""
    start, begins, lasts = graze(100.0, 2e-4)
    assert lasts < 4e-4
    check_close("touch", announced(start), begins, 1e-12)
    names = ["contact.onsets", "contact.last_onset_time", "energy.total"]
    for file, velocity in (
        (fmu_file("SphereSphere"), "source.velocity[3]"),
        (raw.FMUS / "SphereSphere.fmu", "source.velocity"),
    ):
        outside = simulate(file, start, 0.3, [*names, velocity])
        inside = simulate(file, start, 0.3, [*names, velocity], "CoSimulation")
        assert outside["contact.onsets"][-1] == inside["contact.onsets"][-1] == 1
        check_close("onset", outside["contact.last_onset_time"][-1], begins, 1e-9)
        check_close("velocity", outside[velocity][-1], inside[velocity][-1], 1e-8)
        assert np.max(np.abs(inside[velocity][-1])) > 1e-3


def test_inputs_set_in_event_mode_are_foreseen():
    with raw.Instance(raw.load("SphereSphere"), exchange=True) as instance:
        outside = Outside(instance.initialize({**DROP, "source.center": [0.0, 0.0, REACH + 0.3]})).begin()
        instance.ok("EnterEventMode")
        instance.set({"source.external_force": [0.0, 0.0, -GRAVITY]})
        outside.update()
        check_close("touch", outside.announced, math.sqrt(2 * 0.3 / (2 * GRAVITY)), 1e-12)


@pytest.mark.parametrize("size", [6e20, 7.2e33])
def test_events_of_one_instant_end_below_a_cap_where_a_rounding_is_larger_than_the_body(size):
    """The distance from a cap is negative there, which is no negative rounding"""
    start = {"destination.radius": 1e150}
    for instance in (
        raw2.Instance(raw2.load("BallOverRoller"), kind=raw2.MODEL_EXCHANGE),
        raw.Instance(raw.load("BallOverRoller"), exchange=True),
    ):
        with instance:
            outside = Outside(instance.initialize(start)).begin()
            states = outside.states()
            states[:6] = [-89.0, -89.0, size, -89.0, 158811.0, size]
            outside.put(0.1, states)
            outside.event()  # refuses to go round for ever
