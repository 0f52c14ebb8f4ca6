"""A parameter that was set while nothing reads it is warned of once, naming the choice by which it would be
read: of every row of variables.toml with `when`, under every combination of the choices that it names."""

import itertools
import tomllib

import pytest

from contact_fmus.fmu.files import repository
from support.fmi2 import raw as fmi2
from support.fmi2.raw import WARNING
from support.fmi3 import raw as fmi3

ROWS = tomllib.loads((repository() / "modelDescription" / "variables.toml").read_text())
TYPES, VARIABLES = ROWS["type"], ROWS["variable"]
# That of a compound alone is in no FMU of a pair; tests/physics/test_compound.py has its warning.
CONDITIONAL = [
    key
    for key, row in VARIABLES.items()
    if row["causality"] == "parameter" and "when" in row and row.get("shape") != ["compound"]
]
SCENES = ("SphereSphere", "SphereCylinder", "SpherePlane")
BODIES = ("source", "destination")


def _named(key, element):
    """body.mass of the source: source.mass"""
    return key.replace("body.", f"{element}.", 1)


def _choices(condition, element):
    """The variables that an entry of `when` speaks of, of which one is to have the item."""
    if condition.startswith("any body."):
        return [_named(condition.removeprefix("any "), body) for body in BODIES]
    return [_named(condition.removeprefix("any "), element)]


def _in_force(row, element, values):
    return any(
        all(
            any(name in values and values[name] in items for name in _choices(condition, element))
            for condition, items in alternative.items()
        )
        for alternative in row["when"]
    )


def _items(key):
    kind = TYPES[VARIABLES[key]["type"]]
    return list(kind["items"]) if kind["base"] == "Enumeration" else [False, True]


def _row_key(choice):
    group, _, field = choice.partition(".")
    return f"body.{field}" if group in BODIES else choice


def _other_value(key, start):
    """One that is allowed and is not the start value."""
    kind = TYPES[VARIABLES[key]["type"]]
    if kind["base"] == "Enumeration":
        return next(item for item in kind["items"] if item != start)
    if kind["base"] == "Boolean":
        return not start
    if kind["base"] == "Integer":
        return int(start) + 1
    if isinstance(start, list):
        return [start[0], start[1] + 0.25, start[2]]
    larger = key == "contact.static_friction_coefficient"  # it may not be below the other coefficient
    return (2.0 if larger else 0.5) * start if start else 0.25


VERSIONS = {"2.0": fmi2, "3.0": fmi3}


def _has(fmu, name):
    return name in fmu.variables or f"{name}[1]" in fmu.variables


def _warnings(version, scene, values):
    """The texts at the end of initialization; None where it is refused."""
    with VERSIONS[version].Instance(VERSIONS[version].load(scene)) as instance:
        instance.enter_initialization(values)
        return instance.texts() if instance.call("ExitInitializationMode") <= WARNING else None


def _check(version, scene, key, element):
    """How often the parameter was in force, how often not; refused outright counts as not."""
    row, name = VARIABLES[key], _named(key, element)
    start = row.get("start_destination", row["start"]) if element == "destination" else row["start"]
    conditions = {condition for alternative in row["when"] for condition in alternative}
    choices = sorted({one for condition in conditions for one in _choices(condition, element)})
    choices = [one for one in choices if _has(VERSIONS[version].load(scene), one)]
    seen = {True: 0, False: 0}
    for combination in itertools.product(*(_items(_row_key(one)) for one in choices)):
        values = dict(zip(choices, combination, strict=True))
        used = _in_force(row, element, values)
        told = _warnings(version, scene, values | {name: _other_value(key, start)})
        if told is None:
            seen[False] += 0 if used else 1
            continue
        told = [text.partition(": ")[2] for text in told]
        about = [text for text in told if text.startswith((f"{name} = ", f"{name}["))]
        about = [text for text in about if "not in force" in text]
        assert len(about) == (0 if used else 1), (values, told)
        for text in about:
            needed = text.partition(" unless ")[2]
            assert any(f"{one} = " in needed for one in choices), text
        seen[used] += 1
    return seen


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("key", CONDITIONAL)
def test_what_nothing_reads_is_warned_of_once(key, version):
    seen = {True: 0, False: 0}
    for scene in SCENES:
        for element in BODIES if key.startswith("body.") else ("contact",):
            if _has(VERSIONS[version].load(scene), _named(key, element)):
                found = _check(version, scene, key, element)
                seen = {used: seen[used] + found[used] for used in seen}
    assert seen[True] and seen[False], f"{key} was never in force, or always: {seen}"


@pytest.mark.parametrize("version", VERSIONS)
def test_the_choice_that_would_put_it_in_force_is_named(version):
    told = _warnings(version, "SpherePlane", {"contact.characteristic_slip_velocity": 0.01})
    assert [text.partition(": ")[2] for text in told] == [
        "contact.characteristic_slip_velocity = 0.01 was set and is not in force: nothing reads it unless "
        "contact.friction = regularized and contact.slip_velocity_control = user_defined."
    ]


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_set_to_their_start_values_are_not_warned_of(version):
    """As some importers set all of them."""
    starts = {
        _named(key, element): row["start"]
        for key, row in VARIABLES.items()
        if row["causality"] == "parameter"
        for element in (BODIES if key.startswith("body.") else ("contact",))
        if "start_destination" not in row
    }
    starts = {name: value for name, value in starts.items() if _has(fmi2.load("SphereSphere"), name)}
    assert _warnings(version, "SphereSphere", starts) == []
