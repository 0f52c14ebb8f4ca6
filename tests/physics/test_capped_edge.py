"""A ball that touches a capped cylinder on the very edge of the cap, against an independent integration"""

import numpy as np
import pytest

from support.checks import check_close, run
from support.reference.capped import CappedPair
from support.reference.capped import run as reference

R_S, R_D, LENGTH = 0.1, 0.5, 1.0


@pytest.mark.parametrize("along", [(0.0, 1.0), (0.5, 0.0), (-0.5, 0.0), (0.01, 0.3)])
@pytest.mark.parametrize("hertz, stiffness, damping", [(True, 1e6, 0), (True, 1e6, 0.1), (False, 1e5, 20)])
@pytest.mark.parametrize("over", [0.0, 1e-12, -1e-12])
def test_it_goes_along_the_edge_or_across_it(opened, over, hertz, stiffness, damping, along):
    position = np.array([R_D * (1 + over), 0.0, 0.5 * LENGTH + R_S])
    velocity = np.array([*along, -1.0])
    values = {
        "source.radius": R_S,
        "source.center": list(position),
        "source.initial_velocity": list(velocity),
        "destination.radius": R_D,
        "destination.axis": [0.0, 0.0, 1.0],
        "destination.finite_length": True,
        "destination.length": LENGTH,
        "destination.ends": "capped",
        "gravity": [0.0, 0.0, 0.0],
        "contact.law": "hertz" if hertz else "linear",
        "contact.hertz_stiffness" if hertz else "contact.penalty_factor": stiffness,
        "contact.hunt_crossley_factor" if hertz else "contact.viscous_penalty_factor": damping,
    }
    masses, gravity = (1.0, np.inf), (0.0, 0.0, 0.0)
    pair = CappedPair(R_S, R_D, LENGTH, (0.0, 0.0, 1.0), masses, gravity, hertz, stiffness, damping)
    right = reference(pair, np.concatenate([position, np.zeros(3), velocity, np.zeros(3)]), 0.02).state
    fmu = run(opened("SphereCylinder"), values, 0.02, 3, 1e-10, "event_driven")
    check_close("position", fmu["source.position"], right[0:3], 1e-10)
    check_close("velocity", fmu["source.velocity"], right[6:9], 1e-10)
    assert fmu["contact.onsets"] == 1
