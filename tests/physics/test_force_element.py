"""The force element against the independent recomputation of reference/law.py, on random configurations:
CONTACT_SCENES of each FMU.

Each configuration is read three times: after initialization, after new inputs without a step, and after a
step in which the inputs move as polynomials. Equality to 1e-12 of the size of the terms that are added up.
"""

import os

import numpy as np
import pytest

from support.checks import differences, start
from support.reference.law import ReferenceContact, start_motion, vector
from support.scenes.configurations import INPUTS, SHAPES, motion_of, random_configuration, random_inputs

RELATIVE = 1e-12
COUNT = int(os.environ.get("CONTACT_SCENES", "600"))


def outputs_that_differ(fmu, when, expected):
    wrong = []
    for name, (value, size) in expected.items():
        if name not in fmu:
            continue
        got = fmu[name]
        if size is None:
            wrong += [] if got is value else [f"{when}: {name}: got {got}, expected {value}"]
        else:
            wrong += differences(f"{when}: {name}", got, value, RELATIVE * size)
    return wrong


def wrong_in(fmu, random, values, shape, inside, scale=1.0):
    """Everything that differs in the three readings of one configuration."""
    contact = ReferenceContact(values, shape)
    assert (contact.location == "inside") == inside
    start(fmu, {name: value for name, value in values.items() if name in fmu})
    wrong = outputs_that_differ(fmu, "initialized", contact.constants())
    wrong += outputs_that_differ(fmu, "initialized", contact.evaluate(start_motion(values)))

    inputs = random_inputs(random, values, shape, inside, scale)
    for name in INPUTS:
        fmu[name] = inputs[name]
    wrong += outputs_that_differ(fmu, "inputs set", contact.evaluate(motion_of(inputs)))

    step = random.choice([1e-3, 0.5])
    moved = {name: vector(value) for name, value in inputs.items()}
    for name in random.permutation(INPUTS)[: random.integers(0, 3)]:
        for order in (1, 2):
            rate = 0.01 * random.normal(size=3) * (scale if name.endswith("displacement") else 1.0)
            fmu.set_derivative(str(name), rate, order=order)
            moved[str(name)] = moved[str(name)] + vector(rate) * np.longdouble(step) ** order / order
    fmu.step(step)
    return wrong + outputs_that_differ(fmu, "stepped", contact.evaluate(motion_of(moved)))


def check_random(fmu, name, seed, count, scale=1.0, offset=0.0):
    random = np.random.default_rng(seed)
    for k in range(count):
        values, inside = random_configuration(random, SHAPES[name], scale, offset)
        if name == "ForceElement":  # pinned
            pinned = {"contact.penalty_control": "user_defined", "contact.viscous_control": "user_defined"}
            values.update(pinned, **{"contact.method": "penalty_dynamic"})
        wrong = wrong_in(fmu, random, values, SHAPES[name], inside, scale)
        assert not wrong, f"configuration {k} of seed {seed}: {values}\n" + "\n".join(wrong)


@pytest.mark.parametrize("name", SHAPES)
def test_force_element_equals_the_recomputation(opened, name):
    check_random(opened(name), name, seed=0, count=COUNT)


@pytest.mark.parametrize("name", SHAPES)
def test_a_common_offset_of_a_million_metres_costs_no_digits(opened, name):
    """X_dst - X_src is rounded once, relative to itself; the offset itself appears in no tolerance but
    the point's."""
    check_random(opened(name), name, seed=100, count=60, offset=1e6)


@pytest.mark.parametrize("exponent", [-140, -100, 100, 140])
@pytest.mark.parametrize("name", SHAPES)
def test_sizes_neither_overflow_nor_underflow(opened, name, exponent):
    check_random(opened(name), name, seed=200, count=30, scale=10.0**exponent)


@pytest.mark.parametrize("name", SHAPES)
def test_inputs_hold_their_value_over_a_step_where_no_derivative_is_given(opened, name):
    """A pure force element is moved by explicit derivatives only, not by its velocity input."""
    values, _ = random_configuration(np.random.default_rng(5), SHAPES[name])
    fmu = start(opened(name), {key: value for key, value in values.items() if key in opened(name)})
    before = fmu["contact.gap"], fmu["contact.gap_rate"], fmu["contact.normal_force"]
    fmu.step(0.7)
    assert (fmu["contact.gap"], fmu["contact.gap_rate"], fmu["contact.normal_force"]) == before


def test_derivatives_are_forgotten_when_the_input_is_set_again(opened):
    fmu = start(opened("ForceElement"), {"source.prescribed_displacement": [0.0, 0.0, 0.0]})
    fmu.set_derivative("source.prescribed_displacement", [1.0, 0.0, 0.0], order=1)
    fmu.step(0.5)
    fmu["source.prescribed_displacement"] = [0.25, 0.0, 0.0]
    gap = fmu["contact.gap"]
    fmu.step(0.5)
    assert fmu["contact.gap"] == gap
