"""Random scenes of every kind against the independent integrator, in all that a run says, by all methods."""

from functools import cache

import pytest

from support.checks import METHODS, check_close, run
from support.reference.integrator import Reference
from support.scenes.random_scenes import DELICATE, SCENES, random_scene
from support.scenes.scene_checks import FMU, failures
from support.scenes.scene_parts import even

ALLOWED = 1e-6  # m, at tolerance 1e-10


@cache
def reference(shape, kind, seed, steps=1):
    configuration, end = random_scene(shape, kind, seed)
    made = Reference(configuration, shape)
    made.window = [0.0, *even(end, steps)][-2]
    return made.run(end)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("steps", [1, 10])
@pytest.mark.parametrize("shape, kind, seed", SCENES)
def test_a_run_says_what_the_reference_says(opened, shape, kind, seed, steps, method):
    configuration, end = random_scene(shape, kind, seed)
    expected = reference(shape, kind, seed, steps)
    assert expected.onsets > 0
    assert failures(opened(FMU[shape]), configuration, even(end, steps), method, expected) == []


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape, kind, seed", DELICATE)
def test_no_tolerance_finds_another_motion(opened, shape, kind, seed, method, tolerance):
    """A wrong branch after a switch does not care for tolerances; it comes and goes with them."""
    configuration, end = random_scene(shape, kind, seed)
    fmu = run(opened(FMU[shape]), configuration, end, 1, tolerance, method)
    position = reference(shape, kind, seed).position["source"]
    check_close("source.position", fmu["source.position"], position, max(ALLOWED, 1e3 * tolerance))
