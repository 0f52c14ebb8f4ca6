"""Scenes of every family of scene_families.py with all methods, against the independent integrator.

CONTACT_SCENES is the number of scenes of a family, CONTACT_FIRST_SCENE the first one's seed.
"""

import os
from dataclasses import replace
from functools import cache

import pytest

from support.checks import METHODS
from support.scenes.scene_checks import FMU, failures
from support.scenes.scene_families import FAMILIES, drawn, expected, moves_straight

COUNT = int(os.environ.get("CONTACT_SCENES", "24"))
FIRST = int(os.environ.get("CONTACT_FIRST_SCENE", "0"))


@cache
def case(family, seed):
    scene = drawn(family, seed)
    return scene, expected(scene)


@pytest.mark.parametrize("seed", range(FIRST, FIRST + COUNT))
@pytest.mark.parametrize("family", FAMILIES)
def test_a_scene_goes_as_the_reference_says(opened, family, seed):
    scene, right = case(family, seed)
    wrong = {}
    for method in METHODS:
        fmu = opened(FMU[scene.shape])
        lines = failures(fmu, scene.values, scene.stops, method, right, scene.leaves_open)
        if lines:
            wrong[method] = lines
    assert not wrong, f"{wrong}\n{FMU[scene.shape]} {scene.values} stops {scene.stops}"


def test_the_families_reach_what_they_are_about():
    """Of the first scenes of each: contacts, both shapes, and centres passed on the way."""
    for family in FAMILIES:
        scenes, found = zip(*(case(family, seed) for seed in range(12)), strict=True)
        assert sum(one.onsets > 0 for one in found) >= 4, family
        assert len({scene.shape for scene in scenes}) == 1 + (family != "unequal masses"), family
        assert len({len(scene.stops) for scene in scenes}) > 1 or family == "set down", family
    passing = [case("through the centre", seed) for seed in range(12)]
    assert all(moves_straight(scene) for scene, _ in passing)
    assert sum("centre" in right.happened for _, right in passing) >= 4


def test_what_still_moves_is_not_taken_for_settled():
    """A scene that is damped less than its family means it: the reference says so, it does not stand still"""
    scene = drawn("set down", 1284)
    less = 0.08 * scene.values["contact.viscous_penalty_factor"]
    with pytest.raises(ValueError, match="still moves"):
        expected(replace(scene, values=scene.values | {"contact.viscous_penalty_factor": less}))
