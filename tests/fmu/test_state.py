"""Saved states hold everything: a restored run has the bits of the run that went on, wherever restored."""

import math
import pickle
import random
import struct
from ctypes import byref

import pytest

from support.fmi2 import raw, runs
from support.fmi2.raw import ERROR, OK
from support.fmi2.runs import RUNS, begin, digest, go_on
from support.fmi2.states import HEADER_SIZE, forge, header
from support.programs import environment, finished, python


@pytest.fixture(params=RUNS)
def run(request) -> runs.Run:
    return RUNS[request.param]


def bring(run: runs.Run) -> raw.Instance:
    """An instance where the run is to be saved, checked to be in the regime that the run is about"""
    instance = begin(run)
    go_on(instance, run, 0, run.saved_at)
    assert runs.touches(instance) == run.touching
    return instance


def test_restored_runs_have_the_bits_of_the_run_that_went_on(run):
    with bring(run) as instance, raw.Instance(instance.fmu) as fresh:
        state = instance.taken()
        blob = instance.save()
        went_on = go_on(instance, run, run.saved_at)
        assert len({digest([row]) for row in went_on}) > 1
        for _ in range(2):
            instance.ok("SetFMUstate", state)
            assert go_on(instance, run, run.saved_at) == went_on
        instance.ok("FreeFMUstate", byref(state))
        fresh.restore(blob)
        assert go_on(fresh, run, run.saved_at) == went_on


def test_another_process_goes_on_with_the_same_bits():
    saved, went_on = {}, {}
    for name, run in RUNS.items():
        with bring(run) as instance:
            saved[name] = instance.save()
            went_on[name] = digest(go_on(instance, run, run.saved_at))
    given = {"input": pickle.dumps(saved), "text": False, "env": environment()}
    assert pickle.loads(finished(python("support.fmi2.runs"), check=True, **given).stdout) == went_on


def test_saving_twice_gives_the_same_bytes(run):
    with bring(run) as instance, raw.Instance(instance.fmu) as other:
        blob = instance.save()
        assert instance.save() == blob
        other.restore(blob)
        assert other.save() == blob
        assert other.bits() == instance.bits()


def test_saving_is_only_looking_with_event_driven(run):
    """A state saved before every step, and one after reading, change not one bit of what follows"""
    if "solver.method" in raw.load(run.scene).variables:
        run = run._replace(values={**run.values, "solver.method": "event_driven"})
    with begin(run) as saving, begin(run) as other:
        for index in range(run.steps):
            saving.save()
            assert go_on(saving, run, index, index + 1) == go_on(other, run, index, index + 1), index
            saving.save()


def test_all_steps_back_to_the_start(run):
    """States of every tenth step, restored in reverse order"""
    with begin(run) as instance:
        saved = {}
        rows = {}
        for index in range(0, run.steps - 10, 10):
            saved[index] = instance.save()
            rows[index] = go_on(instance, run, index, index + 10)
        for index in reversed(saved):
            instance.restore(saved[index])
            assert go_on(instance, run, index, index + 10) == rows[index]


def test_reset_equals_a_fresh_instance(run):
    """Not a byte is left of a run before, whose steps have other stages than those that are kept after it."""
    spheres = run.scene == "SphereSphere"
    before = RUNS["spinning off a sphere, the tangential stiffness follows"] if spheres else run
    with begin(run) as fresh, bring(before) as used:
        untouched = raw.Instance(fresh.fmu)
        used.ok("Reset")
        assert used.save() == untouched.save()
        assert used.bits("parameter", "input") == untouched.bits("parameter", "input")
        untouched.free()
        used.initialize({**run.values, **run.inputs(0.0)}, tolerance=run.tolerance)
        assert go_on(used, run, 0) == go_on(fresh, run, 0)
        assert used.save() == fresh.save()


def test_reset_from_any_phase(fmu):
    with raw.Instance(fmu) as instance, raw.Instance(fmu) as fresh:
        first = fresh.save()
        expected = fresh.initialize().run([0.1] * 4)
        steps = ["SetupExperiment", "EnterInitializationMode", "ExitInitializationMode", "DoStep"]
        steps += ["Terminate"]
        arguments = {"SetupExperiment": (1, 1e-3, 5.0, 1, 7.0), "DoStep": (5.0, 0.5, 1)}
        for count in range(len(steps) + 1):
            for variable in fmu.select("parameter", kind="Real")[:1]:
                instance.set_one(variable, 0.02)
            for function in steps[:count]:
                instance.ok(function, *arguments.get(function, ()))
            instance.ok("Reset")
            assert instance.save() == first
        assert instance.initialize().run([0.1] * 4) == expected


def test_the_phase_is_part_of_the_state(fmu):
    """Saved in each phase and restored in each: what is allowed then is what was allowed when saving."""
    follow_up = {"instantiated": ("EnterInitializationMode",), "initialization": ("ExitInitializationMode",)}
    follow_up |= {"stepping": ("DoStep", 0.5, 0.25, 1), "terminated": ("Reset",)}
    blobs = {}
    with raw.Instance(fmu) as instance:
        instance.ok("SetupExperiment", 0, 0.0, 0.5, 1, 1.0)
        blobs["instantiated"] = instance.save()
        instance.ok("EnterInitializationMode")
        blobs["initialization"] = instance.save()
        instance.ok("ExitInitializationMode")
        blobs["stepping"] = instance.save()
        instance.ok("Terminate")
        blobs["terminated"] = instance.save()
    for before in blobs.values():
        for phase, blob in blobs.items():
            with raw.Instance(fmu) as instance:
                instance.restore(before)
                instance.restore(blob)
                assert header(instance.save())["phase"] == header(blob)["phase"]
                for other, call in follow_up.items():
                    if other != phase and other != "terminated":
                        assert instance.call(*call) == ERROR, (phase, call)
                instance.ok(*follow_up[phase])


def test_whether_the_experiment_is_set_up_is_part_of_the_state(fmu):
    with raw.Instance(fmu) as instance, raw.Instance(fmu) as other:
        before = instance.save()
        instance.ok("SetupExperiment", 0, 0.0, 0.5, 1, 1.0)
        after = instance.save()
        for blob in (before, after, before):
            other.restore(blob)
            assert other.save() == blob
        other.expect(ERROR, "before fmi2SetupExperiment")(other.call("EnterInitializationMode"))
        other.restore(after)
        other.ok("EnterInitializationMode")


def test_the_stop_time_is_part_of_the_state(fmu):
    with raw.Instance(fmu) as instance, raw.Instance(fmu) as other:
        instance.initialize(stop=1.0)
        other.initialize()
        other.restore(instance.save())
        other.expect(ERROR, "stopTime")(other.call("DoStep", 0.0, 1.5, 1))


# damaged states


@pytest.fixture
def saved(fmu):
    with raw.Instance(fmu) as instance:
        instance.initialize()
        instance.run([0.1] * 3)
        blob = instance.save()
        yield instance, blob
        assert instance.save() == blob, "a refused state changed the instance"
        instance.run([0.1], start=0.1 + 0.1 + 0.1)


def refused(instance: raw.Instance, blob: bytes, *words: str) -> None:
    expected = instance.expect(ERROR, "fmi2DeSerializeFMUstate", *words)
    status, state = instance.deserialize(blob)
    assert state.value is None
    expected(status)


HEADERS = {"version": (0, 8, 2**32 - 1), "magic": (1,), "scene": (0,), "size": (0, 2**63), "checksum": (0,)}
HEADERS |= {"phase": (0, 6, 64, 2**31), "set_up": (2,)}
HEADERS |= {"start_time": (math.nan, math.inf), "stop_time": (math.nan, -1.0)}
WORDS = {"scene": "model"} | dict.fromkeys(("phase", "set_up", "start_time", "stop_time"), "header")


@pytest.mark.parametrize(("field", "value"), [(field, one) for field in HEADERS for one in HEADERS[field]])
def test_a_state_with_another_header_is_refused(saved, field, value):
    instance, blob = saved
    assert header(blob)["version"] == 10
    refused(instance, forge(blob, **{field: value}), WORDS.get(field, field))


def test_a_state_of_another_version_says_both_versions(saved):
    instance, blob = saved
    refused(instance, forge(blob, version=77), "version 77", "expected 10")


def test_a_state_of_another_fmu_is_refused():
    with (
        raw.Instance(raw.load("SphereSphere")) as sphere,
        raw.Instance(raw.load("SphereCylinder")) as cylinder,
    ):
        refused(cylinder, sphere.save(), "model")
        refused(sphere, cylinder.save(), "model")


def test_a_state_cut_short_or_too_long_is_refused(saved):
    instance, blob = saved
    lengths = [*range(HEADER_SIZE + 2), *range(HEADER_SIZE, len(blob), 97), len(blob) - 8, len(blob) - 1]
    for length in lengths:
        refused(instance, blob[:length], "size", str(length), str(len(blob)))
    refused(instance, blob + b"\0", "size")
    refused(instance, blob * 2, "size")


def test_every_flipped_bit_is_found(saved):
    instance, blob = saved
    for position in range(len(blob)):
        damaged = bytearray(blob)
        damaged[position] ^= 1 << (position % 8)
        status, state = instance.deserialize(bytes(damaged))
        assert (status, state.value) == (ERROR, None), position


def test_a_forged_model_part_never_crashes(saved):
    """Random changes behind the header with a checksum that fits: the model refuses them or takes them"""
    instance, blob = saved
    source = random.Random(7)
    for _ in range(500):
        damaged = bytearray(blob)
        for _ in range(source.randint(1, 16)):
            position = source.randrange(HEADER_SIZE, len(blob))
            damaged[position] = source.randrange(256)
        status, state = instance.deserialize(forge(bytes(damaged)))
        assert status == OK
        assert instance.call("SetFMUstate", state) in (OK, ERROR)
        instance.ok("FreeFMUstate", byref(state))
    instance.restore(blob)


def test_a_buffer_too_small_is_not_written(saved):
    instance, blob = saved
    state = instance.taken()
    buffer = bytes(len(blob))
    expected = instance.expect(ERROR, "fmi2SerializeFMUstate", str(len(blob) - 1), str(len(blob)))
    expected(instance.call("SerializeFMUstate", state, buffer, len(blob) - 1))
    assert buffer == bytes(len(blob))
    instance.ok("FreeFMUstate", byref(state))


def test_the_size_is_told_and_small(every_fmu):
    with raw.Instance(every_fmu) as instance:
        blob = instance.save()
        assert struct.unpack_from("<Q", blob, 16)[0] == len(blob) < 13_500
