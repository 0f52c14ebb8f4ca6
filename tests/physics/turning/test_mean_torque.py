"""The mean torque on a destination where nothing turns or rubs: the moment of the normal force about its
centre.
"""

import math

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.checks import METHODS, check_close, start
from support.scenes.scene_parts import moved_by
from support.scenes.turning_cases import G

ALLOWED = {"event_driven": 1e-11, "cvode_bdf": 1e-6, "cvode_adams": 1e-6}
BALL = {"source.radius": 0.1, "contact.penalty_factor": 1e5, "contact.method": "penalty"}
LAWS = {
    "linear": {},
    "damped": {"contact.method": "penalty_dynamic", "contact.viscous_penalty_factor": 50.0},
    "hertz": {"contact.law": "hertz", "contact.hertz_stiffness": 1e6},
    "damped hertz": {
        "contact.law": "hertz",
        "contact.hertz_stiffness": 1e6,
        "contact.method": "penalty_dynamic",
        "contact.viscous_control": "user_defined",
        "contact.hunt_crossley_factor": 0.3,
    },
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_a_ball_that_slides_down_an_incline_tilts_it(opened, method, speed):
    """Set down in balance: F = m g cos on a way v t + g sin t^2/2."""
    slope, end = 0.3, 0.7
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    normal = np.array([math.sin(slope), 0.0, math.cos(slope)])
    force = G * math.cos(slope)
    values = BALL | {
        "source.center": ((0.1 - force / 1e5) * normal).tolist(),
        "source.initial_velocity": (speed * down).tolist(),
        "destination.axis": normal.tolist(),
        "contact.friction": "none",
        "gravity": [0.0, 0.0, -G],
    }
    fmu = start(opened("SpherePlane"), values, 1e-10, method)
    fmu.step(end)
    way = speed * end / 2 + G * math.sin(slope) * end**2 / 6  # its mean
    check_close("torque", fmu["contact.mean_destination_torque"], np.cross(way * down, -force * normal), 1e-7)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    "zone, place",
    [("side", [0.65, 0.1, 0.2]), ("cap", [0.2, -0.1, 0.6]), ("rim", [0.55, 0.1, 0.5])],
)
def test_what_a_ball_loses_of_its_angular_momentum_a_cylinder_gets(opened, method, law, zone, place):
    """A fixed one with caps, hit askew without gravity."""
    values = BALL | LAWS[law]
    values |= {
        "source.center": place,
        "source.mass": 1.3,
        "source.initial_velocity": (-3.0 * np.array(place) + [0.3, 0.5, 0.2]).tolist(),
        "destination.finite_length": True,
        "destination.ends": "capped",
        "destination.length": 0.8,
        "contact.location": "outside",
        "contact.friction": "none",
        "gravity": [0.0, 0.0, 0.0],
    }
    fmu = start(opened("SphereCylinder"), values, 1e-10, method)

    def momentum():
        return 1.3 * np.cross(fmu["source.position"], fmu["source.velocity"])

    before, got, met = momentum(), np.zeros(3), set()
    for _ in range(30):
        fmu.step(0.01)
        got += 0.01 * fmu["contact.mean_destination_torque"]
        met |= {zone} if fmu["contact.onsets"] else set()
    assert met and np.linalg.norm(got) > 0.01
    check_close("torque", got, before - momentum(), 10 * ALLOWED[method])
    check_close("of the source", fmu["contact.mean_source_torque"], np.zeros(3), 0.0)


@pytest.mark.parametrize("name", ["SphereCylinder", "TurningForceElement"])
def test_where_all_motion_is_given(opened, name):
    """A ball drawn along a tube it presses on: F = k delta, at s = v t."""
    values = BALL | {
        "destination.radius": 0.5,
        "destination.axis": [0.0, 0.0, 1.0],
        "source.center": [0.41, 0.0, 0.0],
        **moved_by("source", [0.0, 0.0, 2.0]),
        "destination.motion": "fixed",
        "contact.location": "inside",
        "contact.friction": "none",
    }
    with ContactFmu(fmu_file(name)) as fmu:
        known = {key: value for key, value in values.items() if key.removesuffix(".derivatives") in fmu}
        start(fmu, known, 1e-10)
        fmu.step(0.1)
        force = 0.01 * 1e5
        check_close("torque", fmu["contact.mean_destination_torque"], [0.0, 0.1 * force, 0.0], 1e-9 * force)
