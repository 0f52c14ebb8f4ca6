"""fmi2GetStatus and its kin, asked after steps that went well, were refused, or ended early."""

import math
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_uint, cast

import pytest

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, OK, array
from support.fmi2.runs import RUNS, begin, go_on

KINDS = {raw.DO_STEP_STATUS: "fmi2DoStepStatus", raw.PENDING_STATUS: "fmi2PendingStatus"}
KINDS |= {raw.LAST_SUCCESSFUL_TIME: "fmi2LastSuccessfulTime", raw.TERMINATED: "fmi2Terminated"}
# The function, its answer's type, a value it would not give, and the kind it answers.
FUNCTIONS = {
    "GetStatus": (c_int, -7, raw.DO_STEP_STATUS),
    "GetRealStatus": (c_double, -7.5, raw.LAST_SUCCESSFUL_TIME),
    "GetIntegerStatus": (c_int, -7, None),
    "GetBooleanStatus": (c_int, -7, raw.TERMINATED),
    "GetStringStatus": (c_char_p, b"untouched", None),
}


def busy(scene: str, limit: int = 3) -> dict:
    """A ball that falls on the other body and bounces, with too few internal steps for one step"""
    lying = {"destination.axis": [0.0, 1.0, 0.0]} if scene == "SphereCylinder" else {}
    soft = {} if scene == "HertzImpact" else {"contact.penalty_factor": 1e5}
    return {**soft, "solver.max_internal_steps": limit, **lying}


def ask(instance: raw.Instance, function: str, kind: int):
    """(status, value)"""
    ctype, value, _ = FUNCTIONS[function]
    holder = ctype(value)
    return instance.call(function, kind, cast(byref(holder), POINTER(ctype))), holder.value


def answers(instance: raw.Instance) -> tuple:
    """Status of the last step, last successful time, terminated"""
    found = [ask(instance, name, kind) for name, (_, _, kind) in FUNCTIONS.items() if kind is not None]
    assert [status for status, _ in found] == [OK] * 3
    return tuple(value for _, value in found)


def test_each_function_answers_its_own_kind_and_leaves_the_value_alone_otherwise(instance):
    instance.initialize()
    instance.run([0.25])
    for function, (_, untouched, answered) in FUNCTIONS.items():
        for kind in (*KINDS, 4, -1, 77):
            del instance.messages[:]
            status, value = ask(instance, function, kind)
            if kind == answered:
                assert (status, instance.messages) == (OK, [])
                assert value != untouched
            else:
                assert (status, value) == (DISCARD, untouched)
                (message,) = instance.messages
                for word in (f"fmi2{function}", KINDS.get(kind, "(unknown)"), "not available"):
                    assert word in message.text


def test_before_the_first_step_all_is_well(instance):
    instance.initialize(start=1.5)
    assert answers(instance) == (OK, 1.5, 0)


def test_refused_steps_show_and_good_ones_end_it(instance):
    instance.initialize()
    instance.run([0.25])
    for arguments, status in [((0.25, -1.0, 1), DISCARD), ((7.0, 0.1, 1), ERROR)]:
        assert instance.call("DoStep", *arguments) == status
        assert answers(instance) == (status, 0.25, 0)
    instance.run([0.25], start=0.25)
    assert answers(instance) == (OK, 0.5, 0)
    instance.ok("Terminate")
    assert answers(instance) == (OK, 0.5, 0)
    instance.ok("Reset")
    instance.initialize(start=3.0)
    assert answers(instance) == (OK, 3.0, 0)


def stop_early(instance: raw.Instance, end: float) -> float:
    """Steps towards `end` until one stops early; the time reached"""
    time = answers(instance)[1]
    assert instance.call("DoStep", time, end - time, 1) == DISCARD
    status, reached, ended = answers(instance)
    assert (status, ended) == (DISCARD, 0)
    assert time <= reached < end
    return reached


@pytest.mark.parametrize("scene", raw.SOLVER_SCENES)
def test_an_interrupted_step_is_resumed_where_it_stopped(scene):
    """Going on after each fmi2Discard leads where an uninterrupted run ends."""
    with raw.Instance(raw.load(scene)) as whole, raw.Instance(raw.load(scene)) as broken:
        whole.initialize(busy(scene, 1_000_000), tolerance=1e-12)
        whole.ok("DoStep", 0.0, 1.0, 1)
        broken.initialize(busy(scene), tolerance=1e-12)
        stops = 0
        time, status = 0.0, DISCARD
        while status == DISCARD:
            status = broken.call("DoStep", time, 1.0 - time, 1)
            before, (told, time, _) = time, answers(broken)
            assert told == status
            assert time > before
            stops += 1
            assert stops < 10_000
        assert (status, time) == (OK, 1.0)
        assert stops > 1
        for name in ("source.position", "source.velocity"):
            assert broken.get(name) == pytest.approx(whole.get(name), rel=1e-7, abs=1e-7)
        for name in ("energy.total", "contact.onsets"):
            assert broken.get(name) == pytest.approx(whole.get(name), rel=1e-9)


@pytest.mark.parametrize("scene", raw.SOLVER_SCENES)
def test_the_values_after_an_early_stop_are_those_of_the_last_successful_time(scene):
    with raw.Instance(raw.load(scene)) as stopped, raw.Instance(raw.load(scene)) as there:
        stopped.initialize(busy(scene), tolerance=1e-12)
        reached = stop_early(stopped, 1.0)
        there.initialize(busy(scene, 1_000_000), tolerance=1e-12)
        there.ok("DoStep", 0.0, reached, 1)
        for name in ("source.position", "source.velocity", "energy.total"):
            assert stopped.get(name) == pytest.approx(there.get(name), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("scene", raw.SOLVER_SCENES)
def test_an_early_stop_can_be_undone_by_a_saved_state(scene):
    with raw.Instance(raw.load(scene)) as instance:
        instance.initialize(busy(scene))
        blob = instance.save()
        reached = stop_early(instance, 1.0)
        instance.restore(blob)
        assert answers(instance)[1] == 0.0
        assert stop_early(instance, 1.0) == reached


def test_the_time_is_that_of_the_motion_at_every_step():
    run = RUNS["off a cylinder's end"]
    with begin(run) as instance:
        for index in range(20):
            go_on(instance, run, index, index + 1)
            time = answers(instance)[1]
            assert instance.get("source.position")[1] == pytest.approx(0.3 + time, rel=1e-13)


# The FMU does steps and readings in flight by shorter ways. The next tests hold that the answers are alike.


def test_refused_steps_leave_no_trace_in_a_run(fmu):
    """Between good steps, most of them in flight, which an FMU may look at less closely than at others."""
    bad = [(-0.5, 1.0, ERROR), (1e-3, 1.0, ERROR), (math.nan, 1.0, ERROR), (-1e-5, 1.0, ERROR)]
    bad += [(0.0, factor, DISCARD) for factor in (0.0, -0.0, -1.0, math.nan, -math.inf, math.inf, 1e-17)]
    bad += [(0.0, 81.0, ERROR), (0.0, 1e300, ERROR)]  # past the stop time
    step, stop = 2.0**-10, 80 * 2.0**-10
    with raw.Instance(fmu) as disturbed, raw.Instance(fmu) as calm:
        disturbed.initialize(stop=stop)
        calm.initialize(stop=stop)
        for index in range(80):
            time = index * step
            if index % 3 == 2:
                shift, factor, status = bad[index // 3 % len(bad)]
                assert disturbed.call("DoStep", time + shift, factor * step, 1) == status, (shift, factor)
            disturbed.ok("DoStep", time, step, 1)
            calm.ok("DoStep", time, step, 1)
            if index >= 3 * len(bad):
                assert disturbed.bits("output") == calm.bits("output")
        assert disturbed.call("DoStep", stop, step, 1) == ERROR
        assert disturbed.save() == calm.save()


def test_reals_are_the_same_however_many_are_read_at_once(fmu, instance):
    reals = [variable.reference for variable in fmu.select("output", kind="Real")]
    instance.initialize()
    for index in range(20):
        instance.ok("DoStep", index * 1e-3, 1e-3, 1)
        alone = {
            one: instance.get_one(variable)
            for variable in fmu.variables.values()
            if (one := variable.reference) in reals
        }
        for count in (2, 3, 4, 6):
            for first in range(len(reals) - count + 1):
                for chosen in (reals[first : first + count], reals[first : first + count][::-1]):
                    values = array(c_double, [math.nan] * count)
                    instance.ok("GetReal", array(c_uint, chosen), count, values)
                    assert list(values) == [alone[one] for one in chosen]
