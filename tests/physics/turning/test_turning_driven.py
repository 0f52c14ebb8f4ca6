"""Contacts that turn and rub while the importer moves both bodies, against the reference's integration.

The source comes to touch, presses, slides or sticks, and parts again, all within few communication steps: mean
force and torques, energies, springs, onsets and durations.
"""

import numpy as np
import pytest

from support.reference.turning_run import TurningRun
from support.scenes.scene_checks import FMU
from support.scenes.scene_parts import moved_by
from support.scenes.turning_checks import failures
from support.scenes.turning_scenes import FRICTIONS, PLACES, friction_law, normal_law, place

SCENES = range(len(PLACES) * len(FRICTIONS))


def driven_scene(seed):
    """The source flies a parabola that dips some millimetres into the destination; both turn steadily."""
    random = np.random.default_rng([16, seed])
    shape, inside = PLACES[seed % len(PLACES)]
    outward, values = place(random, shape, inside)
    towards = (1.0 if inside else -1.0) * outward
    across = np.cross(towards, random.normal(size=3))
    speed, depth = random.uniform(0.5, 2.0), random.uniform(1e-3, 4e-3)
    gap = 0.05  # at most (turning_scenes.place): it dips in by `depth` more than that leaves
    back = speed**2 / (2.0 * (gap + depth))
    values |= moved_by("source", speed * towards + 0.1 * across, -back * towards)
    values |= {"source.rotation": "prescribed", "destination.rotation": "prescribed"}
    values["source.prescribed_angular_velocity"] = (10.0 * random.normal(size=3)).tolist()
    values["destination.prescribed_angular_velocity"] = (0.5 * random.normal(size=3)).tolist()
    if shape != "sphere":
        values["destination.prescribed_axis"] = values["destination.axis"]
    values |= normal_law(random, values["source.mass"])
    values |= friction_law(random, FRICTIONS[seed // len(PLACES) % len(FRICTIONS)], values)
    return shape, values, 2.2 * speed / back, int(random.integers(1, 4))


@pytest.mark.parametrize("seed", SCENES)
def test_a_given_motion_has_the_forces_that_the_reference_says(opened, seed):
    shape, values, end, steps = driven_scene(seed)
    expected = TurningRun(values, shape).run(end).figures()
    lines = failures(opened(FMU[shape]), values, end, steps if "elastic" in str(values) else 1, "event_driven", expected)
    assert not lines, f"{lines}\n{values}"
