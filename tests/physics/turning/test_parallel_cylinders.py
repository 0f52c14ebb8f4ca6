"""Two cylinders with parallel axes: against a sphere in the same place, a plane motion, refusals."""

from functools import cache

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import check_close, run, start
from support.reference.pressed import CylinderPair, pressed, state_of, unit
from support.scenes.agreement import seeds

METHODS = ("event_driven", "cvode_bdf")


class Pair(CylinderPair):
    def forces(self, y) -> tuple:
        """Force on the source, torques about both axes, gap: of two circles in the plane across the axes"""
        e, (r_s, r_d) = self.axes[0], self.radius
        away = y[0:3] - y[6:9]
        along = away @ e
        out = away - along * e
        distance = np.linalg.norm(out)
        out /= distance
        depth = distance + r_s - r_d if self.inside else r_s + r_d - distance
        if depth <= 0.0 or abs(along) > 0.5 * sum(self.length):
            return np.zeros(3), 0.0, 0.0, -depth
        push = -out if self.inside else out
        point = y[0:3] - r_s * push
        slip = y[3:6] - y[9:12] + np.cross(y[12] * e, point - y[0:3]) - np.cross(y[13] * e, point - y[6:9])
        force = pressed(self, depth, y[3:6] - y[9:12], push, slip)
        return force, np.cross(point - y[0:3], force) @ e, -np.cross(point - y[6:9], force) @ e, -depth

    def events(self) -> list:
        def leaves(_t, y):
            apart = abs((y[0:3] - y[6:9]) @ self.axes[0])
            return 0.5 * sum(self.length) - apart if np.isfinite(sum(self.length)) else 1.0

        return [*super().events(), leaves]


@cache
def pair(seed: int) -> Pair:
    rng = np.random.default_rng(seed)
    axis, side = unit(rng.normal(size=3)), rng.normal(size=3)
    out = unit(np.cross(axis, side))
    inside = bool(rng.random() < 0.5)
    r_s = rng.uniform(0.05, 0.2)
    r_d = r_s * rng.uniform(1.2, 3.0) if inside else rng.uniform(0.05, 0.3)
    length = (rng.uniform(0.2, 1.0), rng.uniform(0.2, 1.0)) if rng.random() < 0.5 else (np.inf, np.inf)
    gap = rng.uniform(0.001, 0.02)
    distance = max(r_d - r_s - gap, 0.02) if inside else r_d + r_s + gap
    along = rng.uniform(-0.15, 0.15) * (1.0 if np.isinf(length[0]) else sum(length))
    speed = (1.0 if inside else -1.0) * rng.uniform(0.2, 1.5)
    return Pair(
        (axis, axis), (r_s, r_d), (rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)), length,
        distance * out + along * axis, speed * out + 0.3 * rng.normal(size=3),
        tuple(10.0 * rng.normal(size=2)),
        10 ** rng.uniform(4.0, 6.0), rng.choice([0.0, 50.0]), rng.choice([0.0, 0.3]),
        bool(rng.random() < 0.7), bool(rng.random() < 0.5), inside,
    )  # fmt: skip


@cache
def reference(seed: int) -> np.ndarray:
    return pair(seed).ended()


# In the last two a step of the reference crosses the end of the dashpot's force.
@pytest.mark.parametrize("seed", [*seeds(12), 7105, 7150])
def test_two_cylinders_move_as_two_circles_do(opened, seed):
    """With friction along the axes too, ends that are left, one body free or both."""
    scene = pair(seed)
    for method in METHODS:
        fmu = start(opened("CylinderCylinder"), scene.values(), 1e-10, method)
        before, momentum = fmu["energy.total"], moment(fmu, scene)
        fmu.step(scene.end)
        check_close(f"{method}: state", state_of(fmu, scene.axes), reference(seed), 1e-7)
        check_close(f"{method}: energy", fmu["energy.total"], before, 1e-9 * max(1.0, abs(before)))
        across = np.cross(fmu["source.angular_velocity"], scene.axes[0])
        check_close("turning across the axis", across, np.zeros(3), 1e-12)
        if scene.both and scene.turns:
            check_close(f"{method}: angular momentum", moment(fmu, scene), momentum, 1e-9)


def moment(fmu, scene) -> float:
    """Angular momentum of both bodies about the line through their common centre along the axes"""
    e = scene.axes[0]
    m, places = scene.mass, [fmu[f"{body}.position"] for body in ("source", "destination")]
    speeds = [fmu[f"{body}.velocity"] for body in ("source", "destination")]
    reduced = m[0] * m[1] / sum(m)
    orbit = reduced * np.cross(places[0] - places[1], speeds[0] - speeds[1]) @ e
    spins = [fmu[f"{body}.angular_velocity"] @ e for body in ("source", "destination")]
    return orbit + sum(0.5 * k * r * r * spin for k, r, spin in zip(m, scene.radius, spins, strict=True))


def test_the_scenes_reach_what_they_are_about():
    scenes = [pair(seed) for seed in range(12)]
    for name in ("inside", "both", "turns"):
        assert {getattr(scene, name) for scene in scenes} == {False, True}, name
    assert {scene.friction > 0.0 for scene in scenes} == {np.isfinite(scene.length[0]) for scene in scenes}


def test_without_friction_a_cylinder_hits_as_a_sphere_of_its_radius_does(opened):
    """To the last bit: the distance of the axes is that of the sphere's centre from the axis."""
    values = {"source.center": [0.02, 0.1, 0.62], "source.initial_velocity": [0.1, 0.3, -1.0]}
    values |= {"destination.axis": [0.0, 1.0, 0.0]}
    found = []
    for name, more in (("SphereCylinder", {}), ("CylinderCylinder", {"source.axis": [0.0, -3.0, 0.0]})):
        fmu = run(opened(name), values | more, 0.5, 1, 1e-10)
        found.append([*fmu["source.position"], *fmu["source.velocity"], fmu["contact.peak_force"]])
    assert found[0][-1] > 1e3
    assert found[0] == found[1]


def test_contact_lasts_while_the_cylinders_overlap_in_length(opened):
    """A roller that slides along another leaves it where half of both lengths is between the centres."""
    values = {
        "source.axis": [0.0, 1.0, 0.0], "destination.axis": [0.0, 1.0, 0.0],
        "source.center": [0.0, 0.0, 0.6 - 9.81e-6],  # where it lies at rest
        "source.initial_velocity": [0.0, 1.0, 0.0], "contact.method": "penalty", "source.finite_length": True,
        "source.length": 0.4, "destination.finite_length": True, "destination.length": 1.0,
    }  # fmt: skip
    fmu = run(opened("CylinderCylinder"), values, 0.9, 1, 1e-10)
    check_close("after 0.2 s of fall", fmu["source.position"][2], 0.6 - 9.81e-6 - 0.5 * 9.81 * 0.04, 1e-9)
    check_close("contact ended", fmu["contact.last_duration"], 0.7, 1e-9)


@pytest.mark.parametrize("wrong, words", [
    ({"source.axis": [0.0, 1e-9, 1.0]}, "parallel axes"),
    ({"source.axis": [0.0, 0.0, 0.0]}, "has no direction"),
    ({"source.rotation": "free", "source.initial_angular_velocity": [1.0, 0.0, 3.0]}, "about its own axis"),
    ({"source.rotation": "prescribed", "source.prescribed_angular_velocity": [1.0, 0.0, 3.0]},
        "about its own axis"),
    ({"contact.law": "hertz", "contact.penalty_control": "automatic"}, "parallel cylinders"),
])  # fmt: skip
def test_what_the_pair_cannot_do_is_refused_and_said(opened, wrong, words):
    parallel = {"source.axis": [0.0, 0.0, 1.0], "destination.axis": [0.0, 0.0, 2.0]}
    parallel |= {"source.center": [1.0, 0.0, 0.0]}
    start(opened("CylinderCylinder"), parallel)
    with pytest.raises(FmuError, match=words):
        start(opened("CylinderCylinder"), parallel | wrong)


def test_an_angular_velocity_that_would_tilt_the_axis_is_refused_between_steps(opened):
    values = {"source.rotation": "prescribed", "source.motion": "fixed", "source.center": [0.0, 0.0, 0.7]}
    fmu = start(opened("CylinderCylinder"), values)
    fmu["source.prescribed_angular_velocity"] = [0.0, 5.0, 0.0]
    fmu.step(0.1)
    fmu["source.prescribed_angular_velocity"] = [0.0, 5.0, 1e-3]
    with pytest.raises(FmuError, match="would tilt"):
        fmu.step(0.1)


def test_a_torque_across_the_axis_turns_nothing(opened):
    """Along the axis it turns the roller evenly faster, m r^2/2 for its inertia."""
    values = {"source.rotation": "free", "source.center": [0.0, 0.0, 5.0]}
    values |= {"source.external_torque": [3.0, 0.01, -2.0]}
    for method in METHODS:
        fmu = run(opened("CylinderCylinder"), values, 0.3, 1, 1e-10, method)
        check_close("rate", fmu["source.angular_velocity"], [0.0, 0.3 * 0.01 / (0.5 * 0.1**2), 0.0], 1e-9)
        check_close("work", fmu["energy.rotational"], fmu["energy.external_work"], 1e-9)
