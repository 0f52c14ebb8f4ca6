"""Instances, experiments, steps and derivatives asked for wrongly: refused, told, and the run goes on.

The fixture in conftest.py checks in every one of these tests that nothing is printed.
"""

import math
from ctypes import c_double, c_int, c_uint

import pytest

from contact_fmus.fmu.files import fmus_folder
from support.fmi2 import raw
from support.fmi2.raw import CO_SIMULATION, DISCARD, ERROR, WARNING, array

UNKNOWN = 4_000_000_000
NOT_FINITE = [math.nan, math.inf, -math.inf]


# instantiation


@pytest.mark.parametrize(
    "guid", [b"{00000000-0000-0000-0000-000000000000}", b"no guid", b"50 %s %n #r1#", None]
)
def test_a_wrong_guid_makes_no_instance(fmu, guid):
    instance = raw.Instance(fmu, guid=guid)
    assert instance.component is None
    (message,) = instance.messages
    assert (message.status, message.category) == (ERROR, "logStatusError")
    assert fmu.guid in message.text
    assert (guid or b"(null)").decode() in message.text


def test_a_guid_of_any_length_makes_no_instance(fmu):
    for length in (0, 1, 200, 5_000, 100_000):
        instance = raw.Instance(fmu, guid=b"x" * length or b" ")
        assert instance.component is None
        assert fmu.guid in instance.messages[0].text


KINDS = ("fmuType", "fmi2CoSimulation or fmi2ModelExchange")
WRONG = [({"name": name}, ("instanceName",)) for name in (None, b"")]
WRONG += [({"kind": kind}, KINDS) for kind in (2, 7, -1)]


@pytest.mark.parametrize("wrong, words", WRONG)
def test_an_instance_needs_a_name_and_is_of_co_simulation_or_model_exchange(fmu, wrong, words):
    instance = raw.Instance(fmu, **wrong)
    assert instance.component is None
    assert all(word in instance.messages[0].text for word in words)


def test_an_instance_needs_callbacks(fmu):
    assert fmu.library.fmi2Instantiate(b"a", CO_SIMULATION, fmu.guid.encode(), b"", None, 0, 0) is None


def test_an_instance_without_a_logger_works_and_refuses(fmu):
    with raw.Instance(fmu, with_logger=False) as instance:
        instance.initialize()
        assert instance.call("DoStep", 0.0, -1.0, 1) == DISCARD
        instance.run([0.1])
    assert raw.Instance(fmu, with_logger=False, guid=b"wrong").component is None


@pytest.mark.parametrize("resources", [
    None, b"", b"file:///with space/and%20space", b"file:///100%/%s%n%d", "file:///Übergröße/ñ/汉字".encode(),
    b"file:///C:/windows\\style", b"http://elsewhere/resources", b"relative", b"\xff\xfe not utf-8",
    b"/" * 70_000,
])  # fmt: skip
def test_the_resource_location_does_not_matter(fmu, resources):
    with raw.Instance(fmu, resources=resources) as odd, raw.Instance(fmu) as plain:
        assert odd.initialize().run([0.25] * 3) == plain.initialize().run([0.25] * 3)
        assert odd.messages == []


def test_an_fmu_in_a_folder_with_an_odd_name_works(fmu, tmp_path):
    folder = tmp_path / "50 % große Kugel #1 %s"
    folder.mkdir()
    path = folder / "a b%d ü.fmu"
    path.write_bytes((fmus_folder() / f"{fmu.name}.fmu").read_bytes())
    moved = raw.Fmu(path)
    with raw.Instance(moved, resources=(moved.folder / "resources").as_uri().encode()) as instance:
        assert len(instance.initialize().run([0.1])) == 1


# experiment and steps


EXPERIMENTS = [
    *(("fmi2SetupExperiment", "startTime", (0, 0.0, start, 0, 0.0), {}) for start in NOT_FINITE),
    *(("fmi2SetupExperiment", "stopTime", (0, 0.0, 1.0, 1, stop), {"start": 1.0}) for stop in (*NOT_FINITE,
        0.999, -1.0)),
    *(("", "tolerance", (1, one, 0.0, 0, 0.0), {"tolerance": 1e-6}) for one in (*NOT_FINITE, 0.0, -1e-6)),
]  # fmt: skip


@pytest.mark.parametrize("told, word, arguments, right", EXPERIMENTS)
def test_an_experiment_has_finite_times_in_order_and_a_positive_tolerance(
    instance, told, word, arguments, right
):
    with instance.expect(ERROR, told, word) as got:
        got(instance.call("SetupExperiment", *arguments))
    instance.initialize(**right)


@pytest.mark.parametrize(("tolerance", "used"), [(2.0, 1e-2), (1e-300, 1e-14)])
def test_a_tolerance_beyond_the_solver_is_clipped_with_a_warning(universal, tolerance, used):
    with raw.Instance(universal) as instance:
        with instance.expect(WARNING, "tolerance", "solver.relative_tolerance") as got:
            got(instance.call("SetupExperiment", 1, tolerance, 0.0, 0, 0.0))
        instance.initialize(tolerance=tolerance)
        assert instance.get("solver.relative_tolerance") == used


@pytest.mark.parametrize("size", [0.0, -0.0, -1e-3, -math.inf, math.inf, math.nan, 5e-324, 1e-17])
def test_a_step_size_is_positive_finite_and_felt(instance, size):
    """At t = 1 s the last two sizes do not change the time at all."""
    instance.initialize(start=1.0)
    blob = instance.save()
    with instance.expect(DISCARD, "fmi2DoStep", "communicationStepSize", "allowed") as got:
        got(instance.call("DoStep", 1.0, size, 1))
    assert instance.save() == blob
    instance.run([0.1], start=1.0)


def test_a_step_that_overflows_the_time_is_refused(instance):
    instance.initialize(start=1.7e308)
    assert instance.call("DoStep", 1.7e308, 1.7e308, 1) == DISCARD


@pytest.mark.parametrize("begin", [0.0, 3.5])
@pytest.mark.parametrize("off", [0.5, -0.5, -3.5, 1e-3, 1e300, *NOT_FINITE])
def test_a_step_starts_where_the_last_one_ended(instance, off, begin):
    """The first one starts at the start time."""
    instance.initialize(start=begin)
    blob = instance.save()
    with instance.expect(ERROR, "currentCommunicationPoint", "expected", f"{begin:g}") as got:
        got(instance.call("DoStep", begin + off, 0.1, 1))
    assert instance.save() == blob
    instance.run([0.1], start=begin)


def test_rounded_communication_points_are_taken(fmu):
    """Importers compute i*h or add h up: both differ from the FMU's own time by roundings."""
    with raw.Instance(fmu) as added, raw.Instance(fmu) as multiplied:
        added.initialize()
        multiplied.initialize()
        time = 0.0
        for index in range(1000):
            added.ok("DoStep", time, 1e-3, 1)
            multiplied.ok("DoStep", index * 1e-3, 1e-3, 1)
            time += 1e-3


def test_no_step_goes_past_the_stop_time(instance):
    instance.initialize(stop=1.0)
    instance.run([0.75])
    blob = instance.save()
    with instance.expect(ERROR, "stopTime", "1 s", "1.25") as got:
        got(instance.call("DoStep", 0.75, 0.5, 1))
    assert instance.save() == blob
    instance.run([0.25], start=0.75)
    with instance.expect(ERROR, "stopTime") as got:
        got(instance.call("DoStep", 1.0, 1e-3, 1))


def test_added_up_steps_may_reach_the_stop_time(fmu):
    """Ten times 0.1 is a little less than 1, three times 0.1 a little more than 0.3."""
    for stop, count in [(1.0, 10), (0.3, 3), (0.7, 7)]:
        with raw.Instance(fmu) as instance:
            instance.initialize(stop=stop)
            instance.run([0.1] * count)


# derivatives


@pytest.mark.parametrize("what", ["input", "output"])
def test_derivatives_are_checked(fmu, instance, what):
    instance.initialize()
    blob = instance.save()
    known = [fmu.select("input", kind="Real")[0], fmu.variables["contact.gap"]]
    one, other = known if what == "input" else reversed(known)
    function = "SetRealInputDerivatives" if what == "input" else "GetRealOutputDerivatives"

    def call(reference, order, value=1.0):
        orders, values = array(c_int, [order]), array(c_double, [value])
        return instance.call(function, array(c_uint, [reference]), 1, orders, values)

    for order in (0, -1, 3, 2**31 - 1):
        with instance.expect(DISCARD, one.name, str(order), "1 to 2") as got:
            got(call(one.reference, order))
    for value in (*NOT_FINITE, 1e300) if what == "input" else ():
        with instance.expect(DISCARD, one.name, "allowed") as got:
            got(call(one.reference, 1, value))
    for wrong in (other.name, "source.radius", "contact.active"):
        with instance.expect(ERROR, wrong, f"no Real {what}") as got:
            got(call(fmu.variables[wrong].reference, 1))
    with instance.expect(ERROR, "unknown value reference", str(UNKNOWN)) as got:
        got(call(UNKNOWN, 1))
    assert instance.save() == blob
