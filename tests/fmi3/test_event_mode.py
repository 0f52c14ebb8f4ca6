"""Event mode: fmi3DoStep returns at the instant at which a contact begins or ends, known in closed form."""

import math

import fmpy
import numpy as np
import pytest

from support.checks import FMU, check_close
from support.fmi3 import raw
from support.fmi3.raw import ERROR, OK, Instance
from support.scenes.head_on import GAP, GEOMETRIES, SPEED, head_on

TOLERANCE = 1e-10
# s: a gap error of 1e-12 m at 1 m/s; CVODE holds its tolerance by the step
ALLOWED = {"event_driven": 1e-12, "cvode_bdf": 1e-7, "cvode_adams": 1e-7}
LASTS = math.pi * 1e-3  # s, half a period of 1 kg on 1e6 N/m


def with_events(shape, values, method="event_driven", **options):
    options = {"event_mode": True, "early_return": True, **options}
    instance = Instance(raw.load(FMU[shape]), **options)
    instance.initialize({**values, "solver.method": method}, TOLERANCE)
    if options["event_mode"]:
        instance.handle_event(enter=False)  # a run with event mode begins there
    return instance


def events_until(instance, end, step):
    """Steps of one length, cut short by early returns, and the times of the events on the way"""
    found, time = [], 0.0
    while time < end * (1 - 1e-12):
        told = instance.step(time, min(step, end - time))
        assert told.status == OK, instance.texts()
        assert told.early is False or told.event
        if told.event:
            found.append(told.time)
            instance.handle_event()
        time = told.time
    return found


@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_steps_end_where_a_contact_begins_and_ends(shape, location, method):
    with with_events(shape, head_on(shape, location), method) as instance:
        begins = instance.step(0.0, 0.1)
        assert (begins.status, begins.event, begins.early, begins.terminate) == (OK, True, True, False)
        check_close("begins", begins.time, GAP / SPEED, ALLOWED[method])
        assert instance.get("contact.active")
        assert instance.get("contact.last_onset_time") == instance.get("time") == begins.time
        check_close("gap", instance.get("contact.gap"), 0.0, ALLOWED[method])
        instance.handle_event()
        ends = instance.step(begins.time, 0.1 - begins.time)
        assert (ends.status, ends.event, ends.early) == (OK, True, True)
        check_close("ends", ends.time, GAP / SPEED + LASTS, ALLOWED[method])
        assert not instance.get("contact.active")
        check_close("duration", instance.get("contact.last_duration"), LASTS, ALLOWED[method])
        instance.handle_event()
        after = instance.step(ends.time, 0.1 - ends.time)
        assert (after.status, after.event, after.early) == (OK, False, False)
        check_close("end", after.time, 0.1, 0.0)
        assert instance.get("contact.onsets") == 1


@pytest.mark.parametrize("step", [0.7, 0.01, 0.003])
def test_a_bouncing_ball_returns_at_every_impact(step):
    """Dropped on the top of a sphere: the flights between the bounces last 2 v / g, the contacts as long as a
    spring under the ball's weight takes, and no event is told twice."""
    gravity, height, stiffness = 10.0, 0.2, 1e5
    values = {"source.center": [0.0, 0.0, 0.6 + height], "gravity": [0.0, 0.0, -gravity]}
    values |= {"contact.method": "penalty", "contact.penalty_factor": stiffness}
    fall = math.sqrt(2 * height / gravity)
    omega = math.sqrt(stiffness)  # of 1 kg
    lasts = 2 / omega * (math.pi - math.atan(omega * fall))  # x'' + omega² x = -g, from x = 0 at speed g fall
    with with_events("sphere", values) as instance:
        found = events_until(instance, 0.7, step)
        begins = [fall, 3 * fall + lasts]
        right = [begins[0], begins[0] + lasts, begins[1], begins[1] + lasts]
        assert len(found) == len([time for time in right if time < 0.7])
        check_close("events", found, right[: len(found)], 1e-11)
        assert instance.get("contact.onsets") == (len(found) + 1) // 2


def test_a_cylinder_that_slides_away_ends_the_contact_at_its_end(method):
    """It moves along its axis at 1 m/s and leaves the ball, deep in a soft contact, after 0.1 s."""
    values = {"source.mass": 1000.0, "source.center": [0.59, 0.0, 0.0], "destination.motion": "prescribed"}
    values |= {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
    values |= {"destination.length": 0.2, "contact.method": "penalty", "contact.penalty_factor": 1000.0}
    values |= {"gravity": [0.0, 0.0, 0.0]}
    with with_events("cylinder", values, method) as instance:
        instance.set({"destination.prescribed_velocity": [0.0, 0.0, -1.0]})
        told = instance.step(0.0, 0.3)
        assert (told.event, told.early) == (True, True)
        check_close("passes the end", told.time, 0.1, ALLOWED[method])
        assert not instance.get("contact.active")


def test_an_event_at_the_end_of_a_step_is_told_without_early_return():
    values = head_on("sphere", "outside")
    with with_events("sphere", values) as first, with_events("sphere", values) as second:
        time = first.step(0.0, 0.1).time
        told = second.step(0.0, time)
        assert (told.status, told.event, told.early, told.time) == (OK, True, False, time)
        second.handle_event()
        assert second.get("contact.onsets") == first.get("contact.onsets") == 1
        assert second.step(time, 0.01).time == first.step(time, 0.01).time


@pytest.mark.parametrize("event_mode, early_return", [(False, False), (False, True), (True, False)], ids=str)
def test_nobody_else_is_interrupted(event_mode, early_return):
    """Without event mode or without early return the step goes on, to the same bits."""
    values = head_on("sphere", "outside")
    with (
        with_events("sphere", values, event_mode=event_mode, early_return=early_return) as instance,
        with_events("sphere", values, event_mode=False, early_return=False) as plain,
    ):
        for told in (instance.step(0.0, 0.1), plain.step(0.0, 0.1)):
            assert (told.status, told.event, told.early) == (OK, False, False)
            check_close("end", told.time, 0.1, 0.0)
        assert instance.bits("output") == plain.bits("output")


def test_a_run_cut_at_its_events_is_the_same_motion():
    """Impulses of the pieces add up, and the ball is where it is without event mode."""
    values = head_on("sphere", "outside")
    with with_events("sphere", values) as cut, with_events("sphere", values, event_mode=False) as whole:
        whole.step(0.0, 0.1)
        impulse, time = np.zeros(3), 0.0
        while time < 0.1:
            told = cut.step(time, 0.1 - time)
            impulse += (told.time - time) * np.array(cut.get("contact.mean_force"))
            time = told.time
            if told.event:
                cut.handle_event()
        for name in ("source.position", "source.velocity"):
            check_close(name, cut.get(name), whole.get(name), 1e-10)
        check_close("impulse", impulse, 0.1 * np.array(whole.get("contact.mean_force")), 1e-10)


def test_inputs_may_jump_in_event_mode():
    with with_events("sphere", head_on("sphere", "outside", speed=0.0)) as instance:
        instance.step(0.0, 0.01)
        instance.ok("EnterEventMode")
        instance.set({"source.external_force": [1.0, 0.0, 0.0]})
        instance.handle_event(enter=False)
        instance.step(0.01, 0.01)
        check_close("velocity", instance.get("source.velocity"), [0.01, 0.0, 0.0], 1e-14)


def test_a_state_saved_in_event_mode_goes_on_there():
    values = head_on("sphere", "outside")
    with (
        with_events("sphere", values) as first,
        with_events("sphere", values) as second,
        with_events("sphere", values, event_mode=False) as plain,
    ):
        time = first.step(0.0, 0.1).time
        first.ok("EnterEventMode")
        blob = first.save()
        for other in (second, plain):
            assert other.restore(blob) == OK
        refused = second.expect(ERROR, "fmi3DoStep called in phase event mode, allowed in: step mode")
        refused(second.step(time, 0.01).status)
        for instance in (first, second):
            instance.handle_event(enter=False)
        # An instance without event mode has no such phase: it is in step mode.
        told = [instance.step(time, 0.001) for instance in (first, second, plain)]
        assert told[0] == told[1] == told[2]
        assert first.bits("output") == second.bits("output") == plain.bits("output")


def test_event_mode_is_refused_where_it_was_not_asked_for(pair):
    with Instance(pair) as instance:
        instance.initialize()
        refused = instance.expect(ERROR, "fmi3EnterEventMode", "step mode", "eventModeUsed = false")
        refused(instance.call("EnterEventMode"))
        assert instance.step(0.0, 0.01).status == OK


def test_a_force_element_has_no_event_mode():
    with Instance(raw.load("ForceElement"), event_mode=True) as instance:
        assert instance.component is None
        assert "eventModeUsed" in instance.texts()[0] and "hasEventMode" in instance.texts()[0]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("event_mode", [False, True])
def test_a_step_that_is_not_cut_short_tells_the_end_that_was_asked_for(seed, event_mode):
    """Deferred flights and impacts: a master that goes on while t < T, by the times it is told, gets to T."""
    random = np.random.default_rng(seed)
    stop = float(random.uniform(0.5, 1.5))
    options = {"event_mode": event_mode, "early_return": event_mode}
    with with_events("sphere", head_on("sphere", "outside"), **options) as instance:
        time, steps = 0.0, 0
        while time < stop:
            size = min(float(random.uniform(1e-4, 1e-2)), stop - time)
            told = instance.step(time, size)
            assert told.status == OK, instance.texts()
            assert told.time == time + size or (told.early and told.event)
            if told.event:
                instance.handle_event()
            time, steps = told.time, steps + 1
            assert steps < 20_000  # two hundred times as many as it takes


def test_fmpy_records_the_impact():
    """A ball falls 0.3 m on a sphere; fmpy shortens its step to the instant at which they touch."""
    settings = {"stop_time": 1.0, "output_interval": 0.05, "relative_tolerance": 1e-10}
    settings |= {"start_values": {"source.center": [0.0, 0.0, 0.9], "gravity": [0.0, 0.0, -10.0]}}
    settings |= {"early_return_allowed": True, "use_event_mode": True}
    settings |= {"output": ["contact.onsets", "contact.gap"]}
    rows = fmpy.simulate_fmu(str(raw.FMUS / "SphereSphere.fmu"), **settings)
    first = rows[np.flatnonzero(rows["contact.onsets"])[0]]
    check_close("time", first["time"], math.sqrt(2 * 0.3 / 10.0), 1e-12)
    check_close("gap", first["contact.gap"], 0.0, 1e-12)


# The next tests change tunable parameters of FMI 3.0: in event mode where there is one, else between steps.

DROPPED = {"source.center": [0.0, 0.0, 0.599], "contact.method": "penalty", "gravity": [0.0, 0.0, -9.81]}
CHANGED = {"contact.penalty_factor": 3e5, "gravity": [0.0, 1.0, 2.0], "contact.dashpot": "unclamped"}


@pytest.mark.parametrize("event_mode", [True, False])
def test_they_are_set_where_the_standard_has_them(event_mode):
    """FMI 3.0.2, section 2.4.7.4: with an event if events are supported, else at communication points."""
    with Instance(raw.load("SphereSphere"), event_mode=event_mode) as instance:
        instance.initialize(DROPPED)
        if event_mode:
            instance.handle_event(enter=False)
        before = instance.bits("parameter", "output")
        if event_mode:
            for name, value in CHANGED.items():
                instance.expect(ERROR, name, "tunable parameter", "event mode")(instance.set_one(name, value))
            assert instance.bits("parameter", "output") == before
            instance.ok("EnterEventMode")
        instance.set(CHANGED)
        check_close("force", instance.get("contact.normal_force"), 3e5 * 1e-3, 1e-9)
        work = (3e5 - 1e6) * 0.5e-6 - 2.0 * 0.599 - 9.81 * 0.599
        check_close("work", instance.get("energy.external_work"), work, 1e-12)
        instance.expect(ERROR, "fixed after initialization")(instance.set_one("source.mass", 2.0))
        if event_mode:
            instance.handle_event(enter=False)
        assert instance.step(0.0, 1e-3).status == OK


def test_both_ways_and_fmi_2_give_the_same_bits(opened):
    rows = []
    for event_mode in (True, False):
        with Instance(raw.load("SphereSphere"), event_mode=event_mode) as instance:
            instance.initialize(DROPPED)
            if event_mode:
                instance.handle_event(enter=False)
            instance.step(0.0, 1e-3)
            if event_mode:
                instance.ok("EnterEventMode")
            instance.set(CHANGED)
            if event_mode:
                instance.handle_event(enter=False)
            instance.step(1e-3, 0.1)
            rows.append((tuple(instance.get("source.position")), instance.get("energy.total")))
    fmu = opened("SphereSphere")
    fmu.start(DROPPED)
    fmu.step(1e-3)
    for name, value in CHANGED.items():
        fmu[name] = value
    fmu.call("doStep", 1e-3, 0.1)
    rows.append((tuple(fmu["source.position"]), fmu["energy.total"]))
    assert rows[0] == rows[1] == rows[2]
