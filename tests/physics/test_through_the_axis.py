"""Free balls close by the axis of a tilted solid cylinder: scenes of round numbers. Through it and through a
centre is a family of support/scenes/scene_families.py.

The axis is met where the ball is anywhere along it: what is left of its place across the axis is then
rounding of its place along it, and points anywhere.
"""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from support.checks import check_close, run
from support.reference.integrator import Reference

AXES = [[1, 1, 1], [1, 2, 0], [1, 0, 1], [3, 4, 0], [1, 2, 2], [1, 2, 3], [-1, 1, 0.5], [0, 0, 1]]
REACH = 0.6
LAWS = ["viscous only", "spring", "spring and dashpot"]
DASHPOTS = ["non_adhesive", "unclamped", "approach_only"]


def scene(law, dashpot, miss):
    """Values of two free balls of which one goes by the other's axis, and the end"""
    random = np.random.default_rng([1, 1, LAWS.index(law), DASHPOTS.index(dashpot)])
    axis = np.array(AXES[random.integers(len(AXES))], float)
    e, speed = axis / np.linalg.norm(axis), 0.0
    while speed < 0.2:
        velocity = random.integers(-4, 5, 3) / 4
        across = velocity - (velocity @ e) * e
        speed = np.linalg.norm(across)
    before = random.choice([0.5, 0.75, 1.0, 1.25, 2.0])  # how long, without forces, to the axis
    place = random.choice([-0.5, 0.0, 0.25, 0.5, 1.0]) * axis
    end = random.choice([1.5, 2.0, 2.5, 3.0])
    # Energy enough for the hill that the spring makes, mostly
    height = random.choice([0.1, 0.25, 0.5, 1.0]) * (speed / REACH) ** 2
    damping = 0.0 if law == "spring" else random.choice([0.05, 0.1, 0.2, 0.5])
    drift = random.integers(-2, 3, 3) / 4
    values = {
        "source.motion": "free",
        "destination.motion": "free",
        "source.center": (place - velocity * before + miss * np.cross(e, across / speed)).tolist(),
        "source.initial_velocity": (velocity + drift).tolist(),
        "destination.mass": random.choice([0.5, 1.0, 4.0]),
        "destination.initial_velocity": drift.tolist(),
        "gravity": [0.0, 0.0, 0.0],
        "destination.axis": axis.tolist(),
        "contact.location": "outside",
        "contact.method": "penalty_dynamic" if damping else "penalty",
        "contact.dashpot": dashpot,
        "contact.viscous_penalty_factor": float(damping),
    }
    if law == "viscous only":
        return values | {"contact.penalty_control": "viscous_only"}, end
    return values | {"contact.penalty_factor": float(f"{height:.1g}")}, end


@pytest.mark.parametrize("law, dashpot, miss", zip(LAWS, DASHPOTS, [1e-12, 1e-8, 1e-3], strict=True))
def test_a_near_miss_of_a_tilted_axis_ends_where_the_taylor_reference_does(opened, law, dashpot, miss):
    values, end = scene(law, dashpot, miss)
    with localcontext(prec=40):
        reference = Reference(values, "cylinder", number=Decimal, order=30).run(end)
        expected = [float(x) for x in reference.position["source"]]
    fmu = run(opened("SphereCylinder"), values, end, 1, 1e-10, "event_driven")
    # The place is rounded by 1e-16, which is a part 1e-16 / miss of the little that the miss turns it aside.
    check_close("position", fmu["source.position"], expected, 1e-12)
    check_close("onsets", fmu["contact.onsets"], reference.onsets, 0)


def test_a_ball_through_the_axis_of_a_cylinder_along_the_diagonal(opened):
    values = {
        "source.center": [0.5, -0.5, 0.0],
        "source.initial_velocity": [0.0, 1.0, 0.5],
        "gravity": [0.0, 0.0, 0.0],
        "destination.axis": [1.0, 1.0, 1.0],
        "contact.location": "outside",
        "contact.method": "penalty_dynamic",
        "contact.penalty_control": "viscous_only",
        "contact.viscous_penalty_factor": 0.2,
        "contact.dashpot": "non_adhesive",
    }
    fmu = run(opened("SphereCylinder"), values, 1.5, 1, 1e-10, "event_driven")
    check_close("position", fmu["source.position"], [0.576197276895666, 0.923802723104334, 0.75], 1e-14)
    assert fmu["contact.onsets"] == 1 and fmu["solver.steps"] < 200
