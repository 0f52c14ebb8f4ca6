"""Scenes as people type them: round numbers, so that events fall together or on communication points."""

import numpy as np
import pytest

from support.scenes.agreement import Scene, check_agreement, seeds


def dropped_ball(random):
    """A ball let fall on a plane; it often touches on a communication point, never at the end of the run."""
    values = {
        "source.center": [0.0, 0.0, 0.1 + 0.5 * float(random.choice([0.01, 0.25, 1.0])) * 10.0],
        "gravity": [0.0, 0.0, -10.0],
        "contact.viscous_penalty_factor": float(random.choice([0.0, 10.0, 100.0])),
        "contact.dashpot": str(random.choice(["non_adhesive", "unclamped", "approach_only"])),
        "contact.penalty_factor": float(random.choice([1e3, 1e4, 1e6])),
    }
    return Scene("SpherePlane", values, end=float(random.choice([0.7, 1.1, 1.7])))


@pytest.mark.parametrize("seed", seeds())
def test_a_dropped_ball_ends_the_same_however_it_is_stepped(opened, seed):
    check_agreement(opened, dropped_ball(np.random.default_rng(seed)), seed)
