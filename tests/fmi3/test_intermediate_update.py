"""The intermediate update: the importer is told of every contact that begins or ends within a step."""

import math
from ctypes import c_double

import pytest

from support.checks import check_close
from support.fmi3 import raw
from support.fmi3.raw import ERROR, OK, Instance, reals, references
from support.scenes.head_on import GAP, SPEED, head_on

BEGINS = GAP / SPEED
ENDS = BEGINS + math.pi * 1e-3  # half a period of 1 kg on 1e6 N/m
ALLOWED = 1e-12  # s


def told_of(update, **options):
    """An instance of a head-on impact, ready to step"""
    instance = Instance(raw.load("SphereSphere"), update=update, **options)
    return instance.initialize(head_on("sphere", "outside"), 1e-10)


def test_every_contact_that_begins_or_ends_is_told():
    told = []
    with told_of(lambda *all_of_it: told.append(all_of_it)) as instance:
        step = instance.step(0.0, 0.1)
        assert (step.event, step.early) == (False, False)
    times, *flags = zip(*told, strict=True)
    check_close("times", times, [BEGINS, ENDS], ALLOWED)
    # no inputs are asked for, outputs may be read, the step is finished, and no early return was allowed
    assert flags == [(False,) * 2, (True,) * 2, (True,) * 2, (False,) * 2]


def test_outputs_read_there_are_those_of_the_instant_and_reading_changes_nothing():
    seen = []

    def read(time, *_flags):
        assert instance.get("time") == time
        seen.append({one: instance.get(one) for one in ("contact.active", "contact.gap", "source.velocity")})
        seen[-1]["mean"] = math.hypot(*instance.get("contact.mean_force"))
        instance.bits("output")
        instance.output_derivative("source.velocity", 1)

    with told_of(read) as instance, told_of(None) as plain:
        for one in (instance, plain):
            for k in range(7):
                assert one.step(k * 0.02, 0.02).status == OK
        assert instance.bits("output") == plain.bits("output")
    assert [one["contact.active"] for one in seen] == [True, False]
    for one in seen:
        check_close("gap", one["contact.gap"], 0.0, 1e-12)
        check_close("speed", math.hypot(*one["source.velocity"]), SPEED, 1e-9)
    assert seen[0]["mean"] == 0.0
    # the step began at 0.04 s; the ball turns round: 2 kg m/s
    check_close("mean force", seen[1]["mean"], 2 * SPEED / (ENDS - 0.04), 1e-6)


def test_the_importer_may_have_the_step_end_there():
    with told_of(lambda time, *_: time, early_return=True) as instance:
        first = instance.step(0.0, 0.1)
        assert (first.status, first.event, first.early) == (OK, False, True)
        check_close("first", first.time, BEGINS, ALLOWED)
        second = instance.step(first.time, 0.1 - first.time)
        check_close("second", second.time, ENDS, ALLOWED)
        assert instance.step(second.time, 0.1 - second.time).early is False


@pytest.mark.parametrize("asked, right", [(0.07, 0.07), (0.5, 0.1), (-1.0, BEGINS), (math.nan, BEGINS)])
def test_or_later(asked, right):
    """A time to come is kept to, one past the step's end is the end, one that is over is now."""
    times = iter([asked, 0.1])
    with told_of(lambda *_: next(times), early_return=True) as instance:
        if right == 0.07:
            times = iter([asked, asked])
        told = instance.step(0.0, 0.1)
        assert told.early is (right < 0.1)
        check_close("returned", told.time, right, ALLOWED)


def test_a_wish_to_return_early_counts_only_where_that_is_allowed():
    with told_of(lambda time, *_: time) as instance:
        assert instance.step(0.0, 0.1).early is False


def test_with_event_mode_the_step_ends_at_the_event_whatever_is_wished():
    told = []
    with told_of(lambda time, *_: told.append(time), event_mode=True, early_return=True) as instance:
        instance.handle_event(enter=False)
        step = instance.step(0.0, 0.1)
        assert (step.event, step.early) == (True, True)
        assert told == [step.time]


def test_only_reading_is_in_order_there():
    refused = []

    def meddle(_time, *_flags):
        calls = {
            "SetFloat64": (references([force]), 1, reals([1.0, 2.0, 3.0]), 3),
            "DoStep": (0.0, 0.1, True, None, None, None, c_double()),
            "Reset": (),
            "Terminate": (),
            "EnterEventMode": (),
            "GetFMUState": (None,),
        }
        for function, arguments in calls.items():
            refused.append((function, instance.call(function, *arguments)))
        instance.fmu.library.fmi3FreeInstance(instance.component)

    with told_of(meddle) as instance, told_of(None) as plain:
        force = instance.fmu.variables["source.external_force"]
        instance.step(0.0, 0.1)
        plain.step(0.0, 0.1)
        assert {status for _, status in refused} == {ERROR} and len(refused) == 12
        words = "called in phase step mode, intermediate update mode, allowed in:"
        assert all(
            f"fmi3{function} {words}" in text
            for (function, _), text in zip(refused, instance.texts(), strict=True)
        )
        assert instance.bits("output") == plain.bits("output")


@pytest.mark.parametrize("reference", [135, 99_999])
def test_variables_asked_for_must_exist(reference):
    """135 is the second component of source.position, which FMI 3.0 does not see."""
    with Instance(raw.load("SphereSphere"), required=[134, reference], update=lambda *_: None) as instance:
        assert instance.component is None
        assert all(one in instance.texts()[0] for one in ("requiredIntermediateVariables", str(reference)))
