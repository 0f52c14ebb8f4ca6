"""The force element against the independent recomputation of reference/law.py, on random configurations.

Each configuration is read three times: after initialization, after new inputs without a step, and after a
step in which the inputs move as polynomials. Equality to 1e-12 of the size of the terms that are added up."""

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from support.checks import check_relative, differences, run, start
from support.reference.law import ReferenceContact, start_motion, vector
from support.scenes.agreement import seeds
from support.scenes.configurations import INPUTS, SHAPES, motion_of, random_configuration, random_inputs

RELATIVE = 1e-12
COUNT = len(seeds(600))


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
    """Returns everything that differs in the three readings of one configuration."""
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
    """X_dst - X_src is rounded once, relative to itself. Only the point's tolerance contains the offset."""
    check_random(opened(name), name, seed=100, count=60, offset=1e6)


@pytest.mark.parametrize("exponent", [-140, -100, 100, 140])
@pytest.mark.parametrize("name", SHAPES)
def test_sizes_neither_overflow_nor_underflow(opened, name, exponent):
    check_random(opened(name), name, seed=200, count=30, scale=10.0**exponent)


@pytest.mark.parametrize("name", SHAPES)
def test_inputs_hold_their_value_over_a_step_where_no_derivative_is_given(opened, name):
    """Explicit derivatives alone move a pure force element, its velocity input does not."""
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


# Mean force and peaks of a force element over its step: against closed forms, and against the law and the
# geometry written once more, sampled so densely that nothing between the samples counts.

CELLS = 40_000
# A corner of the force inside a cell of the samples: the cell squared, times the change of slope.
SAMPLED = 1e-6
EXACT = 1e-12

STIFFNESS, DAMPING = 1e6, 100.0
REACH = 0.6


def polynomial(coefficients, s):
    return sum(np.multiply.outer(s**k, np.array(c, float)) for k, c in enumerate(coefficients))


def law(values, gap, rate):
    elastic = -STIFFNESS * gap
    viscous = -DAMPING * rate
    force = {
        "non_adhesive": np.maximum(elastic + viscous, 0.0),
        "unclamped": elastic + viscous,
        "approach_only": elastic + np.where(rate < 0.0, viscous, 0.0),
    }[values["contact.dashpot"]]
    return np.where(gap < 0.0, force, 0.0)


def sampled(values, moved, times):
    """Returns force on the source, normal force and gap at `times`. `moved` maps inputs to polynomials."""
    at = {name: polynomial(terms, times) for name, terms in moved.items()}
    apart = np.subtract(values["destination.center"], values["source.center"])
    c = apart + at["destination.prescribed_displacement"] - at["source.prescribed_displacement"]
    w = at["destination.prescribed_velocity"] - at["source.prescribed_velocity"]
    axis = np.array(values["destination.axis"]) / np.linalg.norm(values["destination.axis"])
    axial = c @ axis
    across = c - np.outer(axial, axis)
    distance = np.linalg.norm(across, axis=1)
    inside = values["contact.location"] == "inside"
    radii = values["source.radius"], values["destination.radius"]
    side, reach = (-1, radii[1] - radii[0]) if inside else (1, sum(radii))
    normal = across / distance[:, None]
    gap = side * (distance - reach)
    if values["destination.finite_length"]:
        gap = np.where(np.abs(axial) <= values["destination.length"] / 2, gap, np.inf)
    force = law(values, gap, side * np.einsum("ij,ij->i", normal, w))
    return -side * force[:, None] * normal, force, gap


def expected(values, moved, length):
    """Returns the mean by the midpoint rule, the peaks, and the steps of force and gap between samples."""
    places = np.concatenate([[0.0], (np.arange(CELLS) + 0.5) / CELLS, [1.0]])
    vector, force, gap = sampled(values, moved, length * places)
    depth = np.maximum(-gap, 0.0)
    steps = [np.abs(np.diff(a)).max() for a in (force, depth)]
    return vector[1:-1].mean(axis=0), max(force.max(), 0.0), depth.max(), *steps


def configuration(random):
    values, inside = random_configuration(random, "cylinder")
    values |= {"contact.location": "inside" if inside else "outside"}
    values |= {"contact.penalty_factor": STIFFNESS, "contact.viscous_penalty_factor": DAMPING}
    return values, inside


def random_paths(random, values, inside, length):
    """Returns displacements of degree two, with velocities that are their derivatives or are not."""
    inputs = random_inputs(random, values, "cylinder", inside, 1.0)
    size = min(values["source.radius"], values["destination.radius"])
    moved = {name: [inputs[name], np.zeros(3), np.zeros(3)] for name in INPUTS}
    for body in ("source", "destination"):
        rate = size * random.normal(size=3) / length
        bend = size * random.normal(size=3) / length**2
        moved[f"{body}.prescribed_displacement"][1:] = [rate, bend]
        if random.random() < 0.8:
            moved[f"{body}.prescribed_velocity"] = [rate, 2.0 * bend, np.zeros(3)]
    return moved


def run_step(fmu, values, moved, length):
    start(fmu, {name: value for name, value in values.items() if name in fmu})
    for name, terms in moved.items():
        fmu[name] = list(terms[0])
        fmu.set_derivative(name, terms[1], order=1)
        fmu.set_derivative(name, 2.0 * np.array(terms[2]), order=2)
    fmu.step(length)
    return [np.array(fmu[f"contact.{name}"]) for name in ("mean_force", "peak_force", "peak_penetration")]


@pytest.mark.parametrize("seed", range(3))
def test_random_paths_against_samples(opened, seed):
    random = np.random.default_rng(seed)
    touched = 0
    for k in range(40):
        values, inside = configuration(random)
        length = random.choice([1e-3, 0.5])
        moved = random_paths(random, values, inside, length)
        got = run_step(opened("ForceElement"), values, moved, length)
        wanted = expected(values, moved, length)
        touched += wanted[1] > 0.0
        mean, peak, depth, force_step, depth_step = wanted
        # An end of the cylinder, or the onset under a dashpot, is a jump of the force somewhere in a cell.
        scale = 2.0 * force_step + 1e-12
        assert np.abs(got[0] - mean).max() < 4.0 * scale / CELLS + SAMPLED * peak, (seed, k, got, wanted)
        assert -1e-9 * (1.0 + peak) <= got[1] - peak < scale + 1e-9, (seed, k, got, wanted)
        assert -1e-12 <= got[2] - depth < depth_step + 1e-12, (seed, k, got, wanted)
    assert touched > 20


def head_on(fmu, dashpot, gap, rate, length):
    """The source comes along x, `gap` metres from the cylinder, at `rate`, and turns back in the middle."""
    bend = -rate / length
    moved = {name: [np.zeros(3)] * 3 for name in INPUTS}
    moved["source.prescribed_displacement"] = [np.array([x, 0, 0]) for x in (gap, rate, bend)]
    moved["source.prescribed_velocity"] = [np.array([x, 0, 0]) for x in (rate, 2 * bend, 0.0)]
    return run_step(fmu, {"source.center": [REACH, 0, 0], "contact.dashpot": dashpot}, moved, length)


@pytest.mark.parametrize("gap", [1e-3, -1e-4, 1.4e-3])
@pytest.mark.parametrize("length", [1e-3, 1.0])
def test_a_parabola_into_the_cylinder_has_the_mean_and_peaks_of_its_integral(opened, gap, length):
    """g(t) = gap + rate t (1 - t / length); an unclamped dashpot adds nothing to a closed loop."""
    rate = -6e-3 / length
    mean, peak, depth = head_on(opened("ForceElement"), "unclamped", gap, rate, length)
    turn = np.roots([rate / length, -rate, -gap])  # where gap + rate t - rate / length t^2 = 0
    first = max(turn.min(), 0.0)
    last = length - first

    def impulse(t):
        return -STIFFNESS * (gap * t + rate * t**2 / 2 - rate / length * t**3 / 3)

    assert abs(mean[0] - (impulse(last) - impulse(first)) / length) < 1e-10 * abs(mean[0])
    assert np.abs(mean[1:]).max() == 0.0
    assert abs(depth + gap + rate * length / 4) < EXACT
    # The force F = -k g - c g' is largest at the time t where k g' + c g'' = 0.
    top = length / 2 - DAMPING / STIFFNESS
    top = np.clip(top, first, last)

    def force(t):
        there = gap + rate * t * (1 - t / length)
        return -STIFFNESS * there - DAMPING * rate * (1 - 2 * t / length)

    assert abs(peak - force(top)) < 1e-10 * peak


def impulse_and_peak_in(file, configuration, velocity, acceleration, length, count):
    """Impulse and peak force of a source that moves along x; each step has the inputs of its beginning."""
    with ContactFmu(file) as fmu:
        start(fmu, configuration)
        total, peak = np.zeros(3), 0.0
        for t in np.arange(count) * length / count:
            now = velocity + acceleration * t
            fmu["source.prescribed_displacement"] = [velocity * t + 0.5 * acceleration * t**2, 0.0, 0.0]
            fmu["source.prescribed_velocity"] = [now, 0.0, 0.0]
            fmu.set_derivative("source.prescribed_displacement", [now, 0.0, 0.0], order=1)
            fmu.set_derivative("source.prescribed_displacement", [acceleration, 0.0, 0.0], order=2)
            fmu.set_derivative("source.prescribed_velocity", [acceleration, 0.0, 0.0], order=1)
            fmu.step(length / count)
            total += np.array(fmu["contact.mean_force"]) * length / count
            peak = max(peak, fmu["contact.peak_force"])
        assert "source.orientation" not in fmu or list(fmu["source.orientation"]) == [1.0, 0.0, 0.0, 0.0]
    return total, peak


SHOCK = {"contact.law": "hertz", "contact.viscous_control": "restitution", "contact.restitution": 0.1}
CAPPED = {"destination.ends": "capped", "destination.finite_length": True}
ONE_AND_MANY = {  # scene, values, place, velocity and acceleration along x, duration, number of steps
    "turns back": ("ForceElement", {}, [REACH + 1e-3, 0.0, 0.0], -12e-3, 48e-3, 0.5, 1000),
    # The onset within the step sets the dashpot, and with it whether the law has events.
    "restitution": ("MovedOverARim", SHOCK, [REACH + 1e-3, 0.0, 0.0], -0.3, 30.0, 0.02, 20),
    "over a rim": ("MovedOverARim", CAPPED, [0.45, 0.0, 0.599], 0.5, 0.0, 0.4, 400),
}


@pytest.mark.parametrize("dashpot", ["non_adhesive", "approach_only", "unclamped"])
@pytest.mark.parametrize("case", ONE_AND_MANY)
def test_one_step_has_the_mean_of_many(built, fmu_path, case, dashpot):
    scene, values, place, *motion, count = ONE_AND_MANY[case]
    file = built[scene] if scene in built else fmu_path(scene)
    values = values | {"source.center": place, "contact.dashpot": dashpot}
    one, many = (impulse_and_peak_in(file, values, *motion, n) for n in (1, count))
    check_relative("impulse", one[0], many[0], 1e-9)
    check_relative("peak", one[1], many[1], 1e-9)


def test_held_inputs_have_the_force_of_the_instant_as_mean_and_peak(opened):
    fmu = start(opened("ForceElement"), {"source.center": [0.0, 0.599, 0.0]})
    assert list(fmu["contact.mean_force"]) == [0.0, 0.0, 0.0]
    assert fmu["contact.peak_force"] == fmu["contact.normal_force"] > 0.0
    fmu["source.prescribed_velocity"] = [0.0, -0.1, 0.0]
    fmu.step(0.1)
    assert list(fmu["contact.mean_force"]) == list(fmu["contact.source_force"])
    assert fmu["contact.peak_force"] == fmu["contact.normal_force"]
    assert fmu["contact.peak_penetration"] == -fmu["contact.gap"]


def test_nothing_is_left_of_the_step_before(opened):
    fmu = run(opened("ForceElement"), {}, 0.1, 1, method=None)
    assert fmu["contact.peak_force"] > 0.0
    fmu["source.prescribed_displacement"] = [1.0, 0.0, 0.0]
    fmu.step(0.1)
    assert list(fmu["contact.mean_force"]) == [0.0, 0.0, 0.0]
    assert (fmu["contact.peak_force"], fmu["contact.peak_penetration"]) == (0.0, 0.0)
