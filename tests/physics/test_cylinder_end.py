"""A ball that leaves a contact over the end of a cylinder a million times as heavy.

The forces jump at the end, where nothing is to be put right afterwards: the energy that is stored then is
lost. The bodies fall together, so that the energy of the heavy one has more rounding than the contact has
energy. Random scenes of this kind are the family "unequal masses" of support/scenes/scene_families.py.
"""

import pytest

from support.checks import check_close, run


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-12])
def test_a_ball_of_1_kg_at_the_end_of_a_cylinder_of_1e6_kg(opened, tolerance):
    values = {
        "source.motion": "free",
        "destination.motion": "free",
        "source.mass": 1.0,
        "destination.mass": 1e6,
        "source.center": [0.605, 0.4, 0.0],
        "source.initial_velocity": [-0.01, 0.199, 0.0],
        "destination.axis": [0.0, 1.0, 0.0],
        "destination.finite_length": True,
        "destination.length": 1.0,
        "gravity": [0.0, 0.0, -9.81],
        "contact.location": "outside",
        "contact.method": "penalty_dynamic",
        "contact.dashpot": "unclamped",
        "contact.penalty_factor": 1e4,
        "contact.viscous_penalty_factor": 0.0,
    }
    fmu = run(opened("SphereCylinder"), values, 1.0, 1, tolerance, "event_driven")
    check_close("position", fmu["source.position"][0], 0.595156470363825, 1e-14)
