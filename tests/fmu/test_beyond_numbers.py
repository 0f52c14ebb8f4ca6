"""Values within their ranges whose energies or forces would be more than a double holds: nothing read is
infinite or NaN, nothing hangs, and a run goes on once they are replaced."""

import math
from ctypes import c_double, c_int, c_uint

import pytest

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, OK, array

# A ball in a hollow one that is moved: half p_n g^2 is 5e314 J where the wall is 1e150 m away.
SHELL = {"destination.motion": "prescribed", "contact.location": "inside", "contact.penalty_factor": 1e15}
SHELL |= {"source.center": [0.05, 0.0, 0.3]}
MOVED = "destination.prescribed_displacement[1]"


def shaken(instance: raw.Instance, far: bool, method: int = 1) -> raw.Instance:
    instance.initialize({**SHELL, "solver.method": method})
    instance.set({MOVED: 1e-3})
    instance.run([0.01])
    if far:
        instance.set({MOVED: 1e150})
    return instance


def read(instance: raw.Instance, variable: raw.Variable) -> tuple[int, float]:
    value = array(c_double if variable.type == "Real" else c_int, [0])
    status = instance.call(f"Get{variable.call_type}", array(c_uint, [variable.reference]), 1, value)
    return status, value[0]


def derivatives(instance: raw.Instance) -> list[int]:
    """Statuses of those with respect to time and to an input"""
    variables = instance.fmu.variables
    gap, moved = (array(c_uint, [variables[name].reference]) for name in ("contact.gap", MOVED))
    one, value = array(c_double, [1.0]), array(c_double, [0.0])
    return [
        instance.call("GetRealOutputDerivatives", gap, 1, array(c_int, [1]), value),
        instance.call("GetDirectionalDerivative", gap, 1, moved, 1, one, value),
    ]


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder"])
def test_inputs_that_take_an_energy_beyond_are_not_in_force(scene):
    fmu = raw.load(scene)
    with shaken(raw.Instance(fmu), True) as instance:
        for variable in fmu.select("output"):
            instance.expect(DISCARD, "inputs set last", "finite energies")(read(instance, variable)[0])
        for variable in fmu.select("parameter", "input"):
            assert read(instance, variable)[0] == OK
        assert derivatives(instance) == [DISCARD, DISCARD]
        instance.expect(DISCARD, "inputs set last")(instance.call("DoStep", 0.01, 0.1, 1))
        assert instance.time() == 0.01


@pytest.mark.parametrize("method", [1, 2, 3])
def test_others_may_be_set_and_the_run_goes_on_as_if_nothing_had_been(method):
    fmu = raw.load("SphereSphere")
    with raw.Instance(fmu) as tried, raw.Instance(fmu) as plain:
        rows = []
        for instance in (tried, plain):
            shaken(instance, instance is tried, method)
            if instance is tried:
                assert instance.call("DoStep", 0.01, 0.1, 1) == DISCARD
                assert read(instance, fmu.variables["energy.total"])[0] == DISCARD
            instance.set({MOVED: 2e-3})
            rows.append(instance.run([0.01] * 20, start=0.01))
        assert rows[0] == rows[1]


def test_such_a_state_can_be_saved_and_gone_back_to():
    fmu = raw.load("SphereSphere")
    with shaken(raw.Instance(fmu), True) as instance, raw.Instance(fmu) as other:
        other.restore(instance.save())
        assert read(other, fmu.variables["contact.gap"])[0] == DISCARD
        other.set({MOVED: 2e-3})
        other.run([0.01], start=0.01)


@pytest.mark.parametrize(
    ("values", "beyond"),
    [
        ({"source.mass": 1e10, "source.initial_velocity": [1e150, 0.0, 0.0]}, {"kinetic", "total"}),
        ({"source.mass": 1e150, "source.center[3]": 1e150, "gravity[3]": -1e9}, {"potential", "total"}),
        ({"source.center": [1e150, 0.0, 0.0], "contact.location": "inside", "contact.penalty_factor": 1e15},
         {"contact", "total"}),
    ],
)  # fmt: skip
def test_a_start_beyond_is_refused_and_shows_what_is_finite(values, beyond):
    fmu = raw.load("SphereSphere")
    with raw.Instance(fmu) as instance:
        instance.enter_initialization(values)
        refused = set()
        for variable in fmu.select("output", kind="Real"):
            status, value = read(instance, variable)
            assert status in (OK, DISCARD), variable.name
            assert status == DISCARD or math.isfinite(value), variable.name
            if status == DISCARD:
                refused.add(variable.name)
        assert refused == {f"energy.{name}" for name in beyond}
        expected = instance.expect(ERROR, "start is beyond the range of numbers")
        expected(instance.call("ExitInitializationMode"))
        instance.set({"source.mass": 1.0, "source.center": [0.0, 0.0, 1.1], "contact.location": "outside"})
        instance.set({"source.initial_velocity": [0.0] * 3, "gravity[3]": -9.81})
        instance.ok("ExitInitializationMode")
        instance.run([0.1])


def test_an_axis_of_no_direction_gives_no_numbers():
    """It is refused at the end of initialization; until then what depends on it cannot be read."""
    fmu = raw.load("SphereCylinder")
    with raw.Instance(fmu) as instance:
        instance.enter_initialization({"destination.axis": [0.0, 0.0, 0.0]})
        answers = {one.name: read(instance, one) for one in fmu.select("output", kind="Real")}
        assert all(math.isfinite(value) for status, value in answers.values() if status == OK), answers
        assert answers["contact.direction[1]"][0] == DISCARD
        assert answers["source.position[1]"][0] == OK
        assert instance.call("ExitInitializationMode") == ERROR
        instance.set({"destination.axis": [0.0, 0.0, 2.0]})
        instance.ok("ExitInitializationMode")
        instance.bits()


def test_a_reading_names_the_variable_that_is_no_number():
    fmu = raw.load("SphereSphere")
    with raw.Instance(fmu) as instance:
        instance.enter_initialization({"source.mass": 1e10, "source.initial_velocity": [1e150, 0.0, 0.0]})
        references = [fmu.variables[name].reference for name in ("contact.gap", "energy.kinetic")]
        expected = instance.expect(DISCARD, "energy.kinetic", "range of numbers")
        expected(instance.call("GetReal", array(c_uint, references), 2, array(c_double, [0.0] * 2)))
