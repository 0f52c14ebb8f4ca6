"""Random scenes of every kind against the independent integrator, in all that a run says, by all methods."""

from dataclasses import replace
from functools import cache

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.checks import by_methods, check_close, run
from support.reference import tumbling
from support.reference.integrator import Reference
from support.scenes.agreement import seeds
from support.scenes.random_scenes import DELICATE, SCENES, even, random_scene
from support.scenes.scene_checks import FMU, failures
from support.scenes.scene_families import FAMILIES, drawn, expected, moves_straight

ALLOWED = 1e-6  # m, at tolerance 1e-10


@cache
def reference(shape, kind, seed, steps=1):
    configuration, end = random_scene(shape, kind, seed)
    made = Reference(configuration, shape)
    made.window = [0.0, *even(end, steps)][-2]
    return made.run(end)


@pytest.mark.parametrize("steps", [1, 10])
@pytest.mark.parametrize("shape, kind, seed", SCENES)
def test_a_run_says_what_the_reference_says(opened, shape, kind, seed, steps, method):
    configuration, end = random_scene(shape, kind, seed)
    expected = reference(shape, kind, seed, steps)
    assert expected.onsets > 0
    assert failures(opened(FMU[shape]), configuration, even(end, steps), method, expected) == []


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12])
@pytest.mark.parametrize("shape, kind, seed", DELICATE)
def test_no_tolerance_finds_another_motion(opened, shape, kind, seed, method, tolerance):
    """A wrong branch after a switch does not care for tolerances. It comes and goes with them."""
    configuration, end = random_scene(shape, kind, seed)
    fmu = run(opened(FMU[shape]), configuration, end, 1, tolerance, method)
    position = reference(shape, kind, seed).position["source"]
    check_close("source.position", fmu["source.position"], position, max(ALLOWED, 1e3 * tolerance))


# The next test compares scenes of every family of scene_families.py, by all methods, with the integrator.


@cache
def case(family, seed):
    scene = drawn(family, seed)
    return scene, expected(scene)


@pytest.mark.parametrize("seed", seeds(24))
@pytest.mark.parametrize("family", FAMILIES)
def test_a_scene_goes_as_the_reference_says(opened, family, seed):
    scene, right = case(family, seed)
    run_of = (opened(FMU[scene.shape]), scene.values, scene.stops)
    wrong = by_methods(lambda method: failures(*run_of, method, right, scene.leaves_open))
    assert not wrong, f"{wrong}\n{FMU[scene.shape]} {scene.values} stops {scene.stops}"


def test_the_families_reach_what_they_are_about():
    """The first scenes of each family have contacts, both shapes, and centres passed on the way."""
    for family in FAMILIES:
        scenes, found = zip(*(case(family, seed) for seed in range(12)), strict=True)
        assert sum(one.onsets > 0 for one in found) >= 4, family
        assert len({scene.shape for scene in scenes}) == 1 + (family != "unequal masses"), family
        assert len({len(scene.stops) for scene in scenes}) > 1 or family == "set down", family
    passing = [case("through the centre", seed) for seed in range(12)]
    assert all(moves_straight(scene) for scene, _ in passing)
    assert sum("centre" in right.happened for _, right in passing) >= 4


def test_what_still_moves_is_not_taken_for_settled():
    """The reference says that a scene damped less than its family means does not stand still."""
    scene = drawn("set down", 1284)
    less = 0.08 * scene.values["contact.viscous_penalty_factor"]
    with pytest.raises(ValueError, match="still moves"):
        expected(replace(scene, values=scene.values | {"contact.viscous_penalty_factor": less}))


# A ball fired at a cylinder that tumbles, in one communication step of 10 s: no touch is missed or made up.
#
# scripts/studies/tumbling.py runs a thousand of these scenes.

CASES = [
    ("event_driven", "open", range(60)),
    ("event_driven", "capped", range(20)),
    ("cvode_bdf", "open", range(60, 70)),
]
AT_ONCE = 10
RUNS = [(method, ends, i) for method, ends, seeds in CASES for i in seeds[::AT_ONCE]]


@pytest.mark.parametrize("method,ends,first", RUNS)
def test_onsets_are_those_of_an_independent_reference(method, ends, first):
    lines = []
    with ContactFmu(fmu_file("SphereCylinder")) as fmu:
        for seed in range(first, first + AT_ONCE):
            lines += tumbling.failures(fmu, seed, method, ends)[0]
    assert not lines, "\n".join(lines)
