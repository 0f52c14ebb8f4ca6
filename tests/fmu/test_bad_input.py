"""Wrong references, pointers and values: each time the status, a message that helps, and the old values. What
FMI 3.0 alone has is in tests/fmi3/test_bad_input.py.

The fixture in conftest.py checks in every one of these tests that nothing is printed.
"""

import itertools
import math
import re
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p

import pytest

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, OK, array
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
    return [
        (f"{verb}{name}", kind) for verb in ("Get", "Set") for name, kind in VERSIONS[version].TYPES.items()
    ]


def test_an_unknown_value_reference_is_named(either, version):
    before = either.bits("parameter", "input")
    for (function, kind), reference in itertools.product(
        functions(version), (1_000, UNKNOWN, 2**32 - 1, UNKNOWN_OF[version])
    ):
        with either.expect(ERROR, either.prefix + function, "unknown value reference", str(reference)) as got:
            got(either.access(function, array(c_uint, [reference]), (kind * 3)()))
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
                with either.expect(ERROR, either.prefix + function, variable.name, variable.type) as got:
                    one = array(c_uint, [variable.reference])
                    got(either.access(function, one, (kind * 3)(), length=variable.length))
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
    words = {2: ("vr", "value"), 3: ("valueReferences", "values")}[version]
    for (function, kind), count in itertools.product(functions(version), (1, 3)):
        assert either.access(function, None, None, 0, 0) == OK
        for missing, word in enumerate(words):
            arrays = [references, (kind * count)()]
            arrays[missing] = None
            with either.expect(ERROR, either.prefix + function, word, "null") as got:
                got(either.access(function, *arrays, count, count))
    assert either.bits("parameter", "input", "output") == before


OF_TIME = ("vr", None, "order", "value")
OF_DERIVATIVES = {"SetRealInputDerivatives": OF_TIME, "GetRealOutputDerivatives": OF_TIME}
OF_DERIVATIVES["GetDirectionalDerivative"] = (
    "vUnknown_ref", None, "vKnown_ref", None, "dvKnown", "dvUnknown",
)  # fmt: skip


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
            with instance.expect(ERROR, f"fmi2{function}", word, "null") as got:
                got(instance.call(function, *arguments))
    assert instance.bits() == before


def test_null_pointers_of_states_and_statuses_are_refused(fmu, instance):
    instance.initialize()
    blob = instance.save()
    state = c_void_p()
    instance.ok("GetFMUstate", byref(state))
    size = c_size_t()
    cases = [
        ("GetFMUstate", None),
        ("SetFMUstate", None),
        ("SerializedFMUstateSize", None, byref(size)),
        ("SerializedFMUstateSize", state, None),
        ("SerializeFMUstate", None, blob, len(blob)),
        ("SerializeFMUstate", state, None, len(blob)),
        ("DeSerializeFMUstate", None, len(blob), byref(state)),
        ("DeSerializeFMUstate", blob, len(blob), None),
        ("GetStatus", 0, None),
        ("GetRealStatus", 2, None),
        ("GetIntegerStatus", 0, None),
        ("GetBooleanStatus", 3, None),
        ("GetStringStatus", 1, None),
        ("SetDebugLogging", 1, 1, None),
    ]
    for function, *arguments in cases:
        with instance.expect(ERROR, f"fmi2{function}", "null") as got:
            got(instance.call(function, *arguments))
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
            with instance.expect(DISCARD, variable.name, "nan" if value != value else "inf") as got:
                got(instance.set_one(variable, value))
            assert "tested" in instance.messages[0].text
            assert _range_is_named(variable, instance.messages[0].text), instance.messages[0].text
    assert instance.bits("parameter", "input") == before
    instance.initialize()
    before = instance.bits()
    for variable in fmu.select("input", kind="Real"):
        for value in NOT_FINITE:
            with instance.expect(DISCARD, variable.name) as got:
                got(instance.set_one(variable, value))
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
                with instance.expect(DISCARD, variable.name) as got:
                    got(instance.set_one(variable, value))
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
        with instance.expect(DISCARD, "beyond the range of numbers") as got:
            got(instance.call("DoStep", 0.0, 1e160, 1))
        instance.ok("DoStep", 0.0, 1.0, 1)
        assert all(math.isfinite(number) for number in instance.get("source.position"))
