"""A ball that leaves a contact over the end of a cylinder, or by opening the gap, against an integrator of
scipy.

The forces jump at the end, where nothing is to be put right afterwards: the energy that is stored then is
lost. Bodies of very different masses fall together, so that the energy of the heavy one has more rounding
than the contact has energy.
"""

import numpy as np
import pytest

from support.checks import check_close, run

REACH, SPEED = 0.6, 0.01
AXES = {"along y": [0.0, 1.0, 0.0], "tilted": [1.0, 2.0, 2.0]}
GRAVITY = np.array([0.0, 0.0, -9.81])


def frame(axis):
    e = np.array(axis) / np.linalg.norm(axis)
    across = np.cross(e, [0.0, 0.0, 1.0])
    return e, across / np.linalg.norm(across)


def scene(axis, ratio, frequency, damping, height=0.4):
    """A ball of 1 kg beside a cylinder of length 1, on its way to its end at 0.5; `frequency` of their
    contact [rad/s], `damping` in parts of the critical one.
    """
    e, across = frame(axis)
    reduced = ratio / (1.0 + ratio)
    return {
        "source.motion": "free",
        "destination.motion": "free",
        "source.mass": 1.0,
        "destination.mass": ratio,
        "source.center": (0.605 * across + height * e).tolist(),
        "source.initial_velocity": (-SPEED * across + 0.199 * e).tolist(),
        "destination.axis": axis,
        "destination.finite_length": True,
        "destination.length": 1.0,
        "gravity": GRAVITY.tolist(),
        "contact.location": "outside",
        "contact.method": "penalty_dynamic",
        "contact.dashpot": "unclamped",
        "contact.penalty_factor": frequency**2 * reduced,
        "contact.viscous_penalty_factor": 2 * damping * frequency * reduced,
    }


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_a_ball_of_1_kg_at_the_end_of_a_cylinder_of_1e6_kg(opened, tolerance):
    values = scene(AXES["along y"], 1e6, 100.0, 0.0)
    values |= {"contact.penalty_factor": 1e4, "source.center": [0.605, 0.4, 0.0]}
    values["source.initial_velocity"] = [-0.01, 0.199, 0.0]
    fmu = run(opened("SphereCylinder"), values, 1.0, 1, tolerance, "event_driven")
    check_close("position", fmu["source.position"][0], 0.595156470363825, 1e-14)
