"""Friction: its regimes, what begins and ends them, and that no choice of tolerance loses one."""

import numpy as np
import pytest

from support.checks import METHODS, check_close, run
from support.scenes.agreement import Scene, check_agreement, seeds

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12)

# Ball on a floor, hardly bouncing: the dashpot lets go in overlap and takes hold again.
SOFT_LANDING = {
    "source.center": [0.0, 0.0, 0.15],
    "source.initial_velocity": [5.0, 0.0, 0.0],
    "contact.friction": "regularized",
    "contact.friction_coefficient": 0.5,
    "contact.viscous_control": "restitution",
    "contact.restitution": 0.05,
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_ball_that_lands_softly_is_rubbed_as_long_as_it_is_pressed(opened, method, tolerance):
    # Momentum: what gravity and impacts press in sum is m (g t + v_z), and friction takes mu of it.
    fmu = run(opened("SpherePlane"), SOFT_LANDING, 0.5, 1, tolerance, method)
    check_close("v_x", fmu["source.velocity"][0], 5.0 - 0.5 * 9.81 * 0.5, max(1e-2 * tolerance, 1e-12) * 5.0)


def pair(random):
    """A ball of 0.1 m that moves along and towards a plane or another ball, with or without gravity."""
    fmu = str(random.choice(["SpherePlane", "SphereSphere"]))
    height = float(random.choice([0.0, 0.0, 0.01, 0.05, 0.1]))
    down = float(random.choice([0.0, -0.1, -1.0, -2.0]))
    gravity = -9.81 if down == 0.0 else float(random.choice([0.0, -9.81, -10.0]))
    values = {
        "source.center": [0.0, 0.0, (0.1 if fmu == "SpherePlane" else 0.6) + height],
        "source.initial_velocity": [float(random.choice([0.0, 0.1, 1.0, 5.0])), 0.0, down],
        "gravity": [0.0, 0.0, gravity],
        "source.rotation": str(random.choice(["none", "free"])),
        "contact.friction_coefficient": float(random.choice([0.1, 0.5, 1.0])),
        "contact.penalty_factor": float(random.choice([1e3, 1e4, 1e6])),
        "contact.dashpot": str(random.choice(["non_adhesive", "unclamped", "approach_only"])),
    }
    if values["source.rotation"] == "free":
        values["source.initial_angular_velocity"] = [0.0, float(random.choice([0.0, -10.0, 10.0])), 0.0]
    return fmu, values


def damped(random, values):
    if random.integers(2):
        values["contact.viscous_control"] = "restitution"
        values["contact.restitution"] = float(random.choice([0.05, 0.1, 0.5, 0.9]))
    else:
        ratio = float(random.choice([0.01, 0.1, 0.5, 1.0, 1.5]))
        stiffness = values["contact.penalty_factor"]
        values["contact.viscous_penalty_factor"] = ratio * 2.0 * float(np.sqrt(stiffness))


def soft_landing(random):
    """Any dashpot under regularized friction, so that the force may touch zero while the bodies overlap."""
    fmu, values = pair(random)
    damped(random, values)
    values["contact.friction"] = "regularized"
    return Scene(fmu, values, end=float(random.choice([0.07, 0.23, 0.47])), slack=1e3)


def check_law(fmu, values):
    """F_t is that of the law for the outputs F_n and slip: friction is not lost while bodies press."""
    force, slip = fmu["contact.normal_force"], fmu["contact.slip_velocity"]
    speed = float(np.linalg.norm(slip))
    v_0 = fmu["contact.effective_slip_velocity"]
    limit = values["contact.friction_coefficient"] * max(force, 0.0)
    right = -limit * -np.expm1(-speed / v_0) * slip / speed if speed > 0.0 else np.zeros(3)
    check_close("F_t", fmu["contact.friction_force"], right, 1e-9 * (1.0 + limit))


@pytest.mark.parametrize("seed", seeds(30))
def test_friction_of_a_soft_landing_is_the_same_at_every_tolerance(opened, seed):
    scene = soft_landing(np.random.default_rng(seed))
    check_agreement(opened, scene, seed)
    check_law(opened(scene.fmu), scene.values)
