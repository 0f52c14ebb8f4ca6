"""Wrong references, pointers and values: each time the status, a message that helps, and the old values. What
FMI 3.0 alone has is in tests/fmi3/test_bad_input.py.

The fixture in conftest.py checks in every one of these tests that nothing is printed."""

import itertools
import math
import re
from ctypes import byref, c_double, c_int, c_size_t, c_uint

import pytest

from contact_fmus.fmu.files import fmus_folder
from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, OK, WARNING, array
from support.fmi3 import raw as raw3

UNKNOWN = 4_000_000_000
NOT_FINITE = [math.nan, math.inf, -math.inf]


# references and types


VERSIONS = {2: raw, 3: raw3}
# A reference of no variable: FMI 3.0 does not see components.
UNKNOWN_OF = {2: 0, 3: raw3.load("SphereSphere").variables["source.center"].reference + 1}


@pytest.fixture(params=VERSIONS)
def version(request):
    return request.param


@pytest.fixture(params=raw.KINDS)
def either(request, version):
    """An instance of one version or the other"""
    module = VERSIONS[version]
    with module.Instance(module.load(request.param)) as instance:
        yield instance


def functions(version):
    return [(f"{do}{name}", kind) for do in ("Get", "Set") for name, kind in VERSIONS[version].TYPES.items()]


def test_an_unknown_value_reference_is_named(either, version):
    before = either.bits("parameter", "input")
    for (function, kind), reference in itertools.product(
        functions(version), (1_000, UNKNOWN, 2**32 - 1, UNKNOWN_OF[version])
    ):
        expected = either.expect(ERROR, either.prefix + function, "unknown value reference", str(reference))
        expected(either.access(function, array(c_uint, [reference]), (kind * 3)()))
    assert either.bits("parameter", "input") == before


@pytest.mark.parametrize("first", range(0, 700, 50))
def test_references_are_exactly_those_of_the_description(first):
    """Every number around the known ones: readable exactly when the description has it"""
    for scene in raw.SCENES:
        fmu = raw.load(scene)
        types = {variable.reference: variable.call_type for variable in fmu.variables.values()}
        with raw.Instance(fmu) as instance:
            instance.initialize()
            for reference in range(first, first + 50):
                worked = {
                    kind
                    for kind, number in [("Real", c_double), ("Integer", c_int), ("Boolean", c_int)]
                    if instance.call(f"Get{kind}", array(c_uint, [reference]), 1, array(number, [0])) == OK
                }
                assert worked == ({types[reference]} if reference in types else set()), reference


def test_a_wrong_type_names_the_variable_and_its_type(either, version):
    either.initialize()
    before = either.bits("parameter", "input", "output")
    for variable in either.fmu.variables.values():
        for function, kind in functions(version) if variable.name != "time" else ():
            if function[3:] != variable.call_type:
                expected = either.expect(ERROR, either.prefix + function, variable.name, variable.type)
                one = array(c_uint, [variable.reference])
                expected(either.access(function, one, (kind * 3)(), length=variable.length))
    assert either.bits("parameter", "input", "output") == before


def test_one_bad_reference_spoils_the_whole_call(fmu, instance):
    radius = fmu.variables["source.radius"]
    before = instance.bits("parameter", "input")
    for bad, status in [
        ((UNKNOWN, 1.0), ERROR),
        ((radius.reference, -1.0), DISCARD),
        ((fmu.variables["contact.gap"].reference, 1.0), ERROR),
    ]:
        references = array(c_uint, [radius.reference, bad[0]])
        assert instance.call("SetReal", references, 2, array(c_double, [0.123, bad[1]])) == status
        assert instance.bits("parameter", "input") == before
    values = array(c_double, [-7.0, -7.0])
    assert instance.call("GetReal", array(c_uint, [radius.reference, UNKNOWN]), 2, values) == ERROR
    assert list(values) == [-7.0, -7.0]


# null pointers


def test_null_arrays_are_refused_unless_empty(either, version):
    either.initialize()
    before = either.bits("parameter", "input", "output")
    references = array(c_uint, [either.fmu.variables["contact.gap"].reference] * 3)
    for (function, kind), count in itertools.product(functions(version), (1, 3)):
        assert either.access(function, None, None, 0, 0) == OK
        for missing, word in enumerate(("valueReferences", "values")):
            arrays = [references, (kind * count)()]
            arrays[missing] = None
            expected = either.expect(ERROR, either.prefix + function, word, "null")
            expected(either.access(function, *arrays, count, count))
    assert either.bits("parameter", "input", "output") == before


OF_TIME = ("valueReferences", None, "orders", "values")
OF_DERIVATIVES = {"SetRealInputDerivatives": OF_TIME, "GetRealOutputDerivatives": OF_TIME}
OF_DERIVATIVES["GetDirectionalDerivative"] = ("unknowns", None, "knowns", None, "seed", "sensitivity")


@pytest.mark.parametrize("function", OF_DERIVATIVES)
def test_null_arrays_of_derivatives_are_refused_unless_empty(fmu, instance, function):
    words = OF_DERIVATIVES[function]
    gap, known = fmu.variables["contact.gap"].reference, fmu.select("input", kind="Real")[0].reference
    good = [array(c_uint, [gap]), 1, array(c_int, [1]), array(c_double, [0.0])]
    if words is not OF_TIME:
        good[2:3] = [array(c_uint, [known]), 1, array(c_double, [1.0])]
    instance.initialize()
    before = instance.bits()
    instance.ok(function, *(0 if word is None else None for word in words))
    for position, word in enumerate(words):
        if word is not None:
            arguments = [None if index == position else one for index, one in enumerate(good)]
            instance.expect(ERROR, f"fmi2{function}", word, "null")(instance.call(function, *arguments))
    assert instance.bits() == before


def test_null_pointers_of_states_and_statuses_are_refused(fmu, instance):
    instance.initialize()
    blob = instance.save()
    state = instance.taken()
    cases = [("GetFMUstate", None), ("SetFMUstate", None), ("SerializedFMUstateSize", state, None)]
    cases += [("SerializedFMUstateSize", None, byref(c_size_t())), ("SetDebugLogging", 1, 1, None)]
    cases += [("SerializeFMUstate", *one, len(blob)) for one in ((None, blob), (state, None))]
    cases += [("DeSerializeFMUstate", None, len(blob), byref(state))]
    cases += [("DeSerializeFMUstate", blob, len(blob), None), ("GetStatus", 0, None)]
    cases += [("GetRealStatus", 2, None), ("GetIntegerStatus", 0, None)]
    cases += [("GetBooleanStatus", 3, None), ("GetStringStatus", 1, None)]
    for function, *arguments in cases:
        instance.expect(ERROR, f"fmi2{function}", "null")(instance.call(function, *arguments))
    instance.ok("FreeFMUstate", None)
    instance.ok("FreeFMUstate", byref(state))
    instance.ok("FreeFMUstate", byref(state))
    fmu.library.fmi2FreeInstance(None)
    assert instance.save() == blob


# values


def test_no_real_takes_what_is_not_finite(fmu, instance):
    before = instance.bits("parameter", "input")
    reals = fmu.select("parameter", "input", kind="Real")
    assert reals
    for variable in reals:
        for value in NOT_FINITE:
            expected = instance.expect(DISCARD, variable.name, "nan" if value != value else "inf")
            expected(instance.set_one(variable, value))
            assert "tested" in instance.messages[0].text
            assert _range_is_named(variable, instance.messages[0].text), instance.messages[0].text
    assert instance.bits("parameter", "input") == before
    instance.initialize()
    before = instance.bits()
    for variable in fmu.select("input", kind="Real"):
        for value in NOT_FINITE:
            instance.expect(DISCARD, variable.name)(instance.set_one(variable, value))
    assert instance.bits() == before


def _range_is_named(variable: raw.Variable, text: str) -> bool:
    numbers = [float(word) for word in re.findall(r"[-+]?\d+(?:\.\d+)?(?:e[-+]\d+)?", text)]
    bounds = (variable.minimum, variable.maximum)
    return all(any(math.isclose(one, bound, rel_tol=1e-6) for one in numbers) for bound in bounds)


def _outside(variable: raw.Variable) -> list[float | int]:
    if variable.type == "Real":
        below = math.nextafter(variable.minimum, -math.inf)
        above = math.nextafter(variable.maximum, math.inf)
        return [below, above, -1e308 if variable.minimum > -1e308 else -math.inf, 1e308]
    low, high = int(variable.minimum), int(min(variable.maximum, 2**31 - 1))
    if variable.type == "Boolean":
        return [-1, 2, 2**31 - 1, -(2**31)]
    return [
        value
        for value in (low - 1, high + 1, -(2**31), 2**31 - 1)
        if not low <= value <= high and value < 2**31
    ]


def test_every_range_of_the_description_is_enforced(every_fmu):
    """Just outside is refused, and the ends themselves are taken"""
    with raw.Instance(every_fmu) as instance:
        for variable in every_fmu.select("parameter", "input"):
            before = instance.bits("parameter", "input")
            for value in _outside(variable):
                instance.expect(DISCARD, variable.name)(instance.set_one(variable, value))
                if variable.type != "Real":
                    assert str(value) in instance.messages[0].text
            assert instance.bits("parameter", "input") == before
            for value in (variable.minimum, variable.maximum):
                number = value if variable.type == "Real" else int(value)
                assert instance.set_one(variable, number) == OK, (variable.name, value, instance.texts())
            assert instance.set_one(variable, variable.start_value) == OK


@pytest.mark.parametrize("size", [5e-324, 1e-310, 1e-300])
def test_a_step_of_hardly_any_time_gives_numbers(universal, size):
    """1 / size would be infinite; the mean of no impulse over it is 0."""
    with raw.Instance(universal) as instance:
        instance.initialize({"source.center": [5.0, 0.0, 0.0]})
        instance.ok("DoStep", 0.0, size, 1)
        assert instance.get("contact.mean_force") == [0.0, 0.0, 0.0]


def test_a_prescribed_motion_beyond_all_numbers_is_discarded(universal):
    """Its rate is within range, and so is the length of the step; their product is not"""
    with raw.Instance(universal) as instance:
        instance.initialize({"source.motion": "prescribed", "source.prescribed_velocity": [1e150, 0.0, 0.0]})
        instance.expect(DISCARD, "beyond the range of numbers")(instance.call("DoStep", 0.0, 1e160, 1))
        instance.ok("DoStep", 0.0, 1.0, 1)
        assert all(math.isfinite(number) for number in instance.get("source.position"))


# The next tests ask wrongly for instances, experiments, steps and derivatives, are refused, and go on.

# instantiation


GUIDS = [b"{00000000-0000-0000-0000-000000000000}", b"no guid", b"50 %s %n #r1#", None, b" "]
GUIDS += [b"x" * length for length in (1, 200, 5_000, 100_000)]


@pytest.mark.parametrize("guid", GUIDS, ids=range(len(GUIDS)))
def test_a_wrong_guid_of_any_length_makes_no_instance(fmu, guid):
    instance = raw.Instance(fmu, guid=guid)
    assert instance.component is None
    (message,) = instance.messages
    assert (message.status, message.category) == (ERROR, "logStatusError")
    assert fmu.guid in message.text
    assert (guid or b"(null)").decode()[:200] in message.text


KINDS = ("fmuType", "fmi2CoSimulation or fmi2ModelExchange")
WRONG = [({"name": name}, ("instanceName",)) for name in (None, b"")]
WRONG += [({"kind": kind}, KINDS) for kind in (2, 7, -1)]


@pytest.mark.parametrize("wrong, words", WRONG)
def test_an_instance_needs_a_name_and_is_of_co_simulation_or_model_exchange(fmu, wrong, words):
    instance = raw.Instance(fmu, **wrong)
    assert instance.component is None
    assert all(word in instance.messages[0].text for word in words)


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


@pytest.mark.parametrize("told, word, given, right", EXPERIMENTS)
def test_an_experiment_has_finite_times_in_order_and_a_positive_tolerance(instance, told, word, given, right):
    instance.expect(ERROR, told, word)(instance.call("SetupExperiment", *given))
    instance.initialize(**right)


@pytest.mark.parametrize(("tolerance", "used"), [(2.0, 1e-2), (1e-300, 1e-14)])
def test_a_tolerance_beyond_the_solver_is_clipped_with_a_warning(universal, tolerance, used):
    with raw.Instance(universal) as instance:
        expected = instance.expect(WARNING, "tolerance", "solver.relative_tolerance")
        expected(instance.call("SetupExperiment", 1, tolerance, 0.0, 0, 0.0))
        instance.initialize(tolerance=tolerance)
        assert instance.get("solver.relative_tolerance") == used


SIZES = [0.0, -0.0, -1e-3, -math.inf, math.inf, math.nan, 5e-324, 1e-17]


@pytest.mark.parametrize(("size", "time"), [*((size, 1.0) for size in SIZES), (0.0, 0.9)])
def test_a_step_size_is_positive_finite_and_felt(instance, size, time):
    """At t = 1 s the last two sizes do not change the time at all. Without a size the time does not count."""
    instance.initialize(start=1.0)
    blob = instance.save()
    expected = instance.expect(DISCARD, "fmi2DoStep", "communicationStepSize", "allowed")
    expected(instance.call("DoStep", time, size, 1))
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
    expected = instance.expect(ERROR, "currentCommunicationPoint", "expected", f"{begin:g}")
    expected(instance.call("DoStep", begin + off, 0.1, 1))
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
    instance.expect(ERROR, "stopTime", "1 s", "1.25")(instance.call("DoStep", 0.75, 0.5, 1))
    assert instance.save() == blob
    instance.run([0.25], start=0.75)
    instance.expect(ERROR, "stopTime")(instance.call("DoStep", 1.0, 1e-3, 1))


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
        instance.expect(DISCARD, one.name, str(order), "1 to 2")(call(one.reference, order))
    for value in (*NOT_FINITE, 1e300) if what == "input" else ():
        instance.expect(DISCARD, one.name, "allowed")(call(one.reference, 1, value))
    for wrong in (other.name, "source.radius", "contact.active"):
        instance.expect(ERROR, wrong, f"no Real {what}")(call(fmu.variables[wrong].reference, 1))
    instance.expect(ERROR, "unknown value reference", str(UNKNOWN))(call(UNKNOWN, 1))
    assert instance.save() == blob
