"""Tunable parameters of FMI 3.0: in event mode where the importer uses it, else between steps."""

import pytest

from support.checks import check_close
from support.fmi3 import raw
from support.fmi3.raw import ERROR, OK, Instance

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
                with instance.expect(ERROR, name, "tunable parameter", "event mode") as got:
                    got(instance.set_one(name, value))
            assert instance.bits("parameter", "output") == before
            instance.ok("EnterEventMode")
        instance.set(CHANGED)
        check_close("force", instance.get("contact.normal_force"), 3e5 * 1e-3, 1e-9)
        work = (3e5 - 1e6) * 0.5e-6 - 2.0 * 0.599 - 9.81 * 0.599
        check_close("work", instance.get("energy.external_work"), work, 1e-12)
        with instance.expect(ERROR, "fixed after initialization") as got:
            got(instance.set_one("source.mass", 2.0))
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
    fmu.reset()
    fmu.start(DROPPED)
    fmu.step(1e-3)
    for name, value in CHANGED.items():
        fmu[name] = value
    fmu.call("doStep", 1e-3, 0.1)
    rows.append((tuple(fmu["source.position"]), fmu["energy.total"]))
    assert rows[0] == rows[1] == rows[2]
