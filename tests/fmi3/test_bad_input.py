"""Wrong counts, pointers and values of arrays, and what only FMI 3.0 has. Wrong references, types and null
arrays are tests/fmu/test_bad_input.py's, of both versions."""

import math
from ctypes import c_double, c_int64, c_uint32, c_void_p

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.files import fmu_file
from support.fmi3 import raw
from support.fmi3.raw import DISCARD, ERROR, OK, TYPES, Instance, reals, references

UNKNOWN = 4_000_000_000


@pytest.fixture
def instance(fmu):
    with Instance(fmu) as made:
        yield made


@pytest.mark.parametrize("count", [0, 1, 2, 4])
def test_an_array_is_read_and_written_as_a_whole(instance, count):
    center = instance.fmu.variables["source.center"]
    before = instance.get("source.center")
    for verb in ("Get", "Set"):
        refused = instance.expect(ERROR, f"fmi3{verb}Float64", f"nValues = {count}", "expected 3")
        refused(instance.call(f"{verb}Float64", references([center]), 1, reals([7.0] * count), count))
    assert instance.get("source.center") == before


def test_many_variables_in_one_call(instance):
    """A scalar between two arrays, and time"""
    names = ["source.center", "source.radius", "destination.center"]
    chosen = [instance.fmu.variables[name] for name in names]
    instance.ok("SetFloat64", references(chosen), 3, reals([1.5, 2.5, 3.5, 0.25, -1.0, -2.0, -3.0]), 7)
    chosen.insert(1, instance.fmu.variables["time"])
    told = reals([math.nan] * 8)
    instance.ok("GetFloat64", references(chosen), 4, told, 8)
    assert list(told) == [1.5, 2.5, 3.5, 0.0, 0.25, -1.0, -2.0, -3.0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, -1e200])
def test_one_bad_component_spoils_the_whole_call(instance, bad):
    before = instance.get("source.center"), instance.get("source.radius")
    chosen = references([instance.fmu.variables[name] for name in ("source.radius", "source.center")])
    refused = instance.expect(DISCARD, "source.center[2]", "allowed:", "it stays as it was")
    refused(instance.call("SetFloat64", chosen, 2, reals([0.2, 1.0, bad, 2.0]), 4))
    assert (instance.get("source.center"), instance.get("source.radius")) == before


@pytest.mark.parametrize("value", [0, 9, -1, 2**31, 2**40, -(2**63), 2**63 - 1])
def test_an_enumeration_takes_its_items_only(pair, value):
    with Instance(pair) as instance:
        motion = instance.fmu.variables["source.motion"]
        before = instance.get("source.motion")
        refused = instance.expect(DISCARD, "source.motion", str(value), "allowed: 1 .. 3")
        refused(instance.call("SetInt64", references([motion]), 1, (c_int64 * 1)(value), 1))
        assert instance.get("source.motion") == before


def test_time_is_read_and_never_set(instance):
    instance.initialize()
    instance.step(0.0, 0.25)
    assert instance.get("time") == 0.25
    time = references([instance.fmu.variables["time"]])
    refused = instance.expect(ERROR, "fmi3SetFloat64", "time", "independent")
    refused(instance.call("SetFloat64", time, 1, reals([1.0]), 1))


def test_null_pointers_of_a_step_are_refused(instance):
    instance.initialize()
    flag, time = (TYPES["Boolean"] * 1)(), (c_double * 1)()
    names = ["eventHandlingNeeded", "terminateSimulation", "earlyReturn", "lastSuccessfulTime"]
    for missing, name in enumerate(names):
        results = [flag, flag, flag, time]
        results[missing] = None
        instance.expect(ERROR, "fmi3DoStep", name, "null")(instance.call("DoStep", 0.0, 0.1, True, *results))
    assert instance.get("time") == 0.0


@pytest.mark.parametrize("scene", ["SphereSphere", "BallOnSphere"])
def test_a_step_that_gets_stuck_is_undone(scene):
    """fmi3Discard leaves the instance as it was before the call, and smaller steps go on."""
    values = {"solver.method": "cvode_bdf", "solver.max_internal_steps": 5, "gravity": [0.0, 0.0, -9.81]}
    fmu = raw.load(scene)
    with Instance(fmu) as instance:
        instance.initialize({name: value for name, value in values.items() if name in fmu.variables})
        assert instance.step(0.0, 0.01).status == OK
        before = instance.bits("output")
        refused = instance.expect(DISCARD, "is undone", "solver.max_internal_steps = 5")
        told = instance.step(0.01, 3.0)
        refused(told.status)
        assert (told.time, told.early, instance.get("time")) == (0.01, False, 0.01)
        after = {
            name: np.frombuffer(value)
            for name, value in instance.bits("output").items()
            if len(value) % 8 == 0
        }
        for name, value in after.items():
            assert np.allclose(value, np.frombuffer(before[name]), rtol=1e-14, atol=1e-15), name
        assert instance.step(0.01, 0.001).status == OK


def test_categories_are_switched_one_by_one(pair):
    with Instance(pair) as instance:
        bad = (references([instance.fmu.variables["source.radius"]]), 1, reals([-1.0]), 1)
        unknown = ((c_uint32 * 1)(UNKNOWN), 1, reals([0.0]), 1)

        def heard():
            del instance.messages[:]
            instance.call("SetFloat64", *bad)
            instance.call("SetFloat64", *unknown)
            return [category for _, category, _ in instance.messages]

        both = ["logStatusDiscard", "logStatusError"]
        assert heard() == both
        instance.ok("SetDebugLogging", False, 1, (TYPES["String"] * 1)(b"logStatusDiscard"))
        assert heard() == ["logStatusError"]
        instance.ok("SetDebugLogging", False, 0, None)
        assert heard() == []
        instance.ok("SetDebugLogging", True, 1, (TYPES["String"] * 1)(b"logStatusDiscard"))
        assert heard() == ["logStatusDiscard"]
        instance.ok("SetDebugLogging", True, 0, None)
        assert heard() == both
        refused = instance.expect(ERROR, "fmi3SetDebugLogging", "unknown category", "nonsense")
        refused(instance.call("SetDebugLogging", True, 1, (TYPES["String"] * 1)(b"nonsense")))


def test_a_message_is_plain_text():
    """FMI 3.0 has no printf format: nothing is doubled."""
    with Instance(raw.load("SphereSphere"), name=b"100 % #1#") as instance:
        assert instance.call("SetFloat64", (c_uint32 * 1)(UNKNOWN), 1, reals([0.0]), 1) == ERROR
        assert instance.texts()[0].startswith("100 % #1# at 0 s: fmi3SetFloat64")


def test_a_state_of_the_other_version_is_refused(pair):
    with ContactFmu(fmu_file("SphereSphere")) as second, Instance(pair) as third:
        second.start({})
        third.initialize()
        state, blob = c_void_p(), bytes(second.save())
        third.expect(ERROR, "fmi3DeserializeFMUState", "magic number")(third.restore(blob))
        assert state.value is None
        with pytest.raises(FmuError, match="magic number"):
            second.restore(third.save())
