"""Free balls through the axis of a tilted solid cylinder, and close by it: scenes of round numbers.

The axis is met where the ball is anywhere along it: what is left of its place across the axis is then
rounding of its place along it, and points anywhere.
"""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from support.checks import check_close, run
from support.reference.axis_line import Line
from support.reference.integrator import Reference

AXES = [[1, 1, 1], [1, 2, 0], [1, 0, 1], [3, 4, 0], [1, 2, 2], [1, 2, 3], [-1, 1, 0.5], [0, 0, 1]]
REACH = 0.6
LAWS = ["viscous only", "spring", "spring and dashpot"]
KINDS = ["source free", "both free", "destination free", "prescribed destination"]
DASHPOTS = ["non_adhesive", "unclamped", "approach_only"]


class Scene:
    """Values of the FMU; and of the motion across the axis in its line `n`, with the rest known along `e`."""

    def __init__(self, kind, law, dashpot, seed, miss=0.0):
        random = np.random.default_rng([seed, KINDS.index(kind), LAWS.index(law), DASHPOTS.index(dashpot)])
        axis = np.array(AXES[random.integers(len(AXES))], float)
        self.e = axis / np.linalg.norm(axis)
        self.speed = 0.0
        while self.speed < 0.2:
            self.velocity = random.integers(-4, 5, 3) / 4
            across = self.velocity - (self.velocity @ self.e) * self.e
            self.speed = np.linalg.norm(across)
        self.n = across / self.speed
        self.before = random.choice([0.5, 0.75, 1.0, 1.25, 2.0])  # how long, without forces, to the axis
        place = random.choice([-0.5, 0.0, 0.25, 0.5, 1.0]) * axis
        self.center = place - self.velocity * self.before + miss * np.cross(self.e, self.n)
        self.mass, self.end = 1.0, random.choice([1.5, 2.0, 2.5, 3.0])
        self.pull = random.choice([0.0, 0.5, -0.1]) if kind == "source free" else 0.0
        # Energy enough for the hill that the spring makes, mostly
        height = random.choice([0.1, 0.25, 0.5, 1.0]) * (self.speed / REACH) ** 2
        self.k = 0.0 if law == "viscous only" else float(f"{height:.1g}")
        self.c = 0.0 if law == "spring" else random.choice([0.05, 0.1, 0.2, 0.5])
        self.dashpot = dashpot
        self.values = {
            "source.motion": "free",
            "destination.motion": "fixed",
            "source.center": self.center.tolist(),
            "source.initial_velocity": self.velocity.tolist(),
            "gravity": (self.pull * self.velocity).tolist(),
            "destination.axis": axis.tolist(),
            "contact.location": "outside",
            "contact.method": "penalty_dynamic" if self.c else "penalty",
            "contact.dashpot": dashpot,
            "contact.viscous_penalty_factor": float(self.c),
        }
        if self.k:
            self.values["contact.penalty_factor"] = self.k
        else:
            self.values["contact.penalty_control"] = "viscous_only"
        self.add_destination(kind, random)

    def add_destination(self, kind, random):
        other = random.choice([0.5, 1.0, 4.0])
        drift = random.integers(-2, 3, 3) / 4
        both = (self.velocity + drift).tolist()
        if kind == "both free":
            self.mass = other / (1.0 + other)
            self.values |= {"destination.motion": "free", "destination.mass": other}
            self.values |= {
                "destination.initial_velocity": drift.tolist(),
                "source.initial_velocity": both,
            }
        elif kind == "destination free":
            self.mass = other
            self.values |= {
                "source.motion": "fixed",
                "destination.motion": "free",
                "destination.mass": other,
            }
            self.values["destination.initial_velocity"] = (-self.velocity).tolist()
            del self.values["source.initial_velocity"]
        elif kind == "prescribed destination":
            self.values |= {
                "destination.motion": "prescribed",
                "destination.prescribed_velocity": drift.tolist(),
            }
            self.values["destination.prescribed_displacement.derivatives"] = [drift.tolist()]
            self.values["source.initial_velocity"] = both

    def straight(self):
        start, pull = -self.speed * self.before, self.pull * self.speed
        line = Line(start, self.speed, self.mass, REACH, self.k, self.c, self.dashpot, pull)
        return line.run(self.end)

    def along(self):
        """Where it is along the axis at the end, and how fast."""
        way, speed = self.center @ self.e, self.velocity @ self.e
        return (way + speed * self.end * (1 + self.pull * self.end / 2)), speed * (1 + self.pull * self.end)


def passed(fmu):
    return (
        np.array(fmu["source.position"]) - np.array(fmu["destination.position"]),
        np.array(fmu["source.velocity"]) - np.array(fmu["destination.velocity"]),
    )


def check_straight(fmu, scene, allowed):
    line, (way, speed) = scene.straight(), scene.along()
    position, velocity = passed(fmu)
    check_close("position", position, line.s * scene.n + way * scene.e, allowed)
    check_close("velocity", velocity, line.rate * scene.n + speed * scene.e, allowed)
    check_close("onsets", fmu["contact.onsets"], line.onsets, 0)
    check_close("last onset", fmu["contact.last_onset_time"], line.last_onset, allowed)
    check_close("last duration", fmu["contact.last_duration"], line.last_duration, allowed)
    assert fmu["solver.events"] <= line.events + 1
    assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("dashpot", DASHPOTS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_ball_goes_straight_through_the_axis(opened, kind, law, dashpot, seed, steps):
    scene = Scene(kind, law, dashpot, seed)
    scene.values["solver.max_internal_steps"] = 2000
    fmu = run(opened("SphereCylinder"), scene.values, scene.end, steps, 1e-10, "event_driven")
    check_straight(fmu, scene, 1e-11)
    assert fmu["solver.steps"] < 200 + 2 * steps


# Each miss with each law and each dashpot, though not with each pair of them
NEAR = [(law, DASHPOTS[(LAWS.index(law) + k) % 3], miss)
        for law in LAWS for k, miss in enumerate([1e-12, 1e-8, 1e-3])]  # fmt: skip


@pytest.mark.parametrize("law, dashpot, miss", NEAR)
def test_a_near_miss_of_a_tilted_axis_ends_where_the_taylor_reference_does(opened, law, dashpot, miss):
    scene = Scene("both free", law, dashpot, 1, miss)
    with localcontext(prec=40):
        reference = Reference(scene.values, "cylinder", number=Decimal, order=30).run(scene.end)
        expected = [float(x) for x in reference.position["source"]]
    fmu = run(opened("SphereCylinder"), scene.values, scene.end, 1, 1e-10, "event_driven")
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
