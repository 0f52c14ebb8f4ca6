"""Two cylinders with skew axes against a distance by minimization over both axes, and an own integration."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad_vec, solve_ivp
from scipy.optimize import brentq, lsq_linear

from contact_fmus.fmu.contact_fmu import FmuError
from contact_fmus.stability.motions import elliptic_stiffness
from support.checks import check_close, check_relative, run, start
from support.exchange_runs import simulate
from support.fmi3 import raw
from support.reference.pressed import CylinderPair, first_state, pressed, state_of, unit
from support.scenes.agreement import seeds

METHODS = ("event_driven", "cvode_bdf")
BODIES = ("source", "destination")


def nearest(away: np.ndarray, e: tuple, half: tuple) -> tuple[float, float]:
    """The places a, b on both axes with the least |away + a e_s - b e_d|, `away` leading from the destination
    to the source: the best of the stationary point and of the best points of the range's edges."""
    cosine, p, q = e[0] @ e[1], away @ e[0], away @ e[1]
    square = 1.0 - cosine * cosine
    pairs = [((cosine * q - p) / square, (q - cosine * p) / square)]
    pairs = [(a, b) for a, b in pairs if abs(a) <= half[0] and abs(b) <= half[1]]
    for end in (-1.0, 1.0):
        if np.isfinite(half[0]):
            a = end * half[0]
            pairs.append((a, np.clip(q + a * cosine, -half[1], half[1])))
        if np.isfinite(half[1]):
            b = end * half[1]
            pairs.append((np.clip(b * cosine - p, -half[0], half[0]), b))
    return min(pairs, key=lambda one: np.linalg.norm(away + one[0] * e[0] - one[1] * e[1]))


class Pair(CylinderPair):
    def values(self) -> dict:
        return super().values() | {"contact.axes": "skew"}

    def feet(self, away: np.ndarray) -> tuple[float, float]:
        return nearest(away, self.axes, (0.5 * self.length[0], 0.5 * self.length[1]))

    def forces(self, y) -> tuple:
        """Force on the source, torques about both axes, gap, the arms of both about their centres"""
        (e_s, e_d), (r_s, r_d) = self.axes, self.radius
        a, b = self.feet(y[0:3] - y[6:9])
        apart = y[6:9] + b * e_d - y[0:3] - a * e_s
        distance = np.linalg.norm(apart)
        n, depth = apart / distance, r_s + r_d - distance
        arm = a * e_s + r_s * n
        other = y[0:3] + arm - y[6:9]
        if depth <= 0.0:
            return np.zeros(3), 0.0, 0.0, -depth, (arm, other)
        velocity = y[3:6] - y[9:12]
        slip = velocity + np.cross(y[12] * e_s, arm) - np.cross(y[13] * e_d, other)
        force = pressed(self, depth, velocity, -n, slip)
        return force, np.cross(arm, force) @ e_s, -np.cross(other, force) @ e_d, -depth, (arm, other)


def falling(seed: int) -> Pair:
    """One that hits another: of three scenes one is infinite and one finite, and half meet near an end."""
    rng = np.random.default_rng(seed)
    axes = unit(rng.normal(size=3)), unit(rng.normal(size=3))
    while np.linalg.norm(np.cross(*axes)) < 0.2:
        axes = axes[0], unit(rng.normal(size=3))
    radius = rng.uniform(0.05, 0.2), rng.uniform(0.05, 0.3)
    finite = rng.uniform(0.2, 1.0, 2)
    length = [(np.inf, np.inf), tuple(finite), (finite[0], np.inf)][seed % 3]
    length = length[::-1] if seed % 2 else length
    near = [rng.choice([rng.uniform(-0.5, 0.5), rng.uniform(0.9, 1.1)]) for _ in length]
    b, a = (0.5 * min(one, 0.6) * part for one, part in zip(length[::-1], near, strict=True))
    out = unit(np.cross(*axes)) * rng.choice([-1.0, 1.0])
    return Pair(
        axes, radius, (rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)), length,
        b * axes[1] - a * axes[0] - (sum(radius) + rng.uniform(0.001, 0.02)) * out,
        rng.uniform(0.2, 1.5) * out + 0.6 * rng.normal(size=3), tuple(10.0 * rng.normal(size=2)),
        10 ** rng.uniform(3.5, 5.5), rng.choice([0.0, 50.0]), rng.choice([0.0, 0.3]),
        bool(rng.random() < 0.7), bool(rng.random() < 0.5),
    )  # fmt: skip


def lying(seed: int) -> Pair:
    """One that lies across another and slides past its end, or over it on its own end."""
    rng = np.random.default_rng(seed)
    axes = unit([1.0, 0.0, 0.0] + 0.6 * rng.normal(size=3)), unit([0.0, 1.0, 0.0] + 0.2 * rng.normal(size=3))
    length, radius = tuple(rng.uniform(0.2, 0.6, 2)), tuple(rng.uniform(0.05, 0.2, 2))
    a, b = rng.uniform(-0.6, 0.6, 2) * length
    up = unit(np.cross(*axes))
    up *= np.sign(up[2])
    speed = 0.5 * rng.normal(size=3)
    return Pair(
        axes, radius, (1.0, 2.0), length, b * axes[1] - a * axes[0] + (sum(radius) - 1e-3) * up,
        speed - (speed @ up) * up, tuple(5.0 * rng.normal(size=2)), 10 ** rng.uniform(3.0, 5.0),
        rng.choice([0.0, 30.0]), rng.choice([0.0, 0.2]), True, bool(rng.random() < 0.3), end=0.4,
    )  # fmt: skip


KINDS = {"falling": falling, "lying": lying}
SCENES = [(kind, seed) for kind in KINDS for seed in seeds(12 if kind == "falling" else 6)]


@cache
def reference(kind: str, seed: int) -> np.ndarray:
    return KINDS[kind](seed).ended()


@pytest.mark.parametrize("kind, seed", SCENES)
def test_skew_cylinders_move_as_by_the_distance_of_their_axes(opened, kind, seed):
    """With ends that are passed in contact, friction along the axes, one body free or both."""
    scene = KINDS[kind](seed)
    for method in METHODS:
        fmu = start(opened("CylinderCylinder"), scene.values(), 1e-10, method)
        before = fmu["energy.total"]
        fmu.step(scene.end)
        check_close(f"{method}: state", state_of(fmu, scene.axes), reference(kind, seed), 1e-7)
        terms = max(1.0, abs(before), fmu["energy.kinetic"])
        check_close(f"{method}: energy", fmu["energy.total"], before, 1e-9 * terms)


@pytest.mark.parametrize("seed", [0, 2, 4, 5])
def test_a_bounce_between_the_ends_takes_segments(opened, seed):
    """Against the integration, and the torques of the point of contact against CVODE"""
    scene = replace(falling(seed), friction=0.0, turns=False, length=(40.0, 40.0))
    names = ("contact.mean_source_torque", "contact.mean_destination_torque")
    torques = []
    for method, tolerance in (("event_driven", 1e-10), ("cvode_bdf", 1e-12)):
        fmu = run(opened("CylinderCylinder"), scene.values(), scene.end, 1, tolerance, method)
        torques.append(np.concatenate([fmu[name] for name in names]))
        if method == "event_driven":
            assert fmu["solver.fallbacks"] == 0 < fmu["contact.onsets"]
            check_close("state", state_of(fmu, scene.axes), scene.ended(), 1e-7)
    check_close("torques", torques[0], torques[1], 1e-8 * (1.0 + np.abs(torques[1]).max()))


@pytest.mark.parametrize("seed", [0, 9])
def test_an_integrator_outside_passes_the_ends_too(fmu_path, seed):
    """Model Exchange of FMI 2.0 and of FMI 3.0, by fmpy's CVODE."""
    scene = lying(seed)
    values = {name: np.array(one).tolist() for name, one in scene.values().items()}
    vectors = ("source.position", "source.velocity")
    names = [f"{name}[{k}]" for name in vectors for k in (1, 2, 3)]
    second = simulate(fmu_path("CylinderCylinder"), values, scene.end, names)
    third = simulate(raw.FMUS / "CylinderCylinder.fmu", values, scene.end, list(vectors))
    found = [second[name][-1] for name in names]
    check_close("FMI 2.0", found, reference("lying", seed)[:6], 1e-7)
    check_close("FMI 3.0", np.concatenate([third[name][-1] for name in vectors]), found, 1e-12)


def zones_met(scene: Pair) -> list[tuple[bool, bool]]:
    """Whether contact is at an end of the source and of the destination, in the order of the motion"""
    options = {"rtol": 1e-6, "atol": 1e-8, "max_step": 2e-3}
    found = solve_ivp(scene.rates_of, (0.0, scene.end), first_state(scene), **options)
    zones = []
    for y in found.y.T:
        at = tuple(
            abs(foot) > 0.5 * length - 1e-12
            for foot, length in zip(scene.feet(y[0:3] - y[6:9]), scene.length, strict=True)
        )
        if scene.forces(y)[3] < 0.0 and (not zones or zones[-1] != at):
            zones.append(at)
    return zones


def test_the_scenes_reach_what_they_are_about():
    scenes = [KINDS[kind](seed) for kind in KINDS for seed in range(12)]
    met = [zones_met(scene) for scene in scenes]
    assert {zone for zones in met for zone in zones} == {(i, j) for i in (False, True) for j in (False, True)}
    assert sum(len(zones) > 1 for zones in met) >= 4
    for what in ("both", "turns"):
        assert {getattr(scene, what) for scene in scenes} == {False, True}, what
    for what in ("friction", "damping"):
        assert {getattr(scene, what) > 0.0 for scene in scenes} == {False, True}, what


@pytest.mark.parametrize("seed", range(20))
def test_gap_point_and_torques_are_those_of_the_nearest_points(opened, seed):
    """Nearest points by a bounded least-squares search over both axes; the bodies overlap at the start."""
    scene = replace(falling(seed), friction=0.3, turns=True)
    scene = replace(scene, place=scene.place * (1.0 - 0.03 / np.linalg.norm(scene.place)))
    half = 0.5 * np.array(scene.length)
    e = np.column_stack([scene.axes[0], -scene.axes[1]])
    a, b = lsq_linear(e, -scene.place, (-half, half), method="bvls", tol=1e-15).x
    fmu = start(opened("CylinderCylinder"), scene.values())
    apart = b * scene.axes[1] - a * scene.axes[0] - scene.place
    n = unit(apart)
    check_close("gap", fmu["contact.gap"], np.linalg.norm(apart) - sum(scene.radius), 1e-12)
    check_close("direction", fmu["contact.direction"], n, 1e-11)
    check_close("point", fmu["contact.point"], b * scene.axes[1] - scene.radius[1] * n, 1e-11)
    at = scene.place + a * scene.axes[0] + scene.radius[0] * n
    check_close("source point", fmu["contact.source_point"], at, 1e-11)
    force, size = fmu["contact.source_force"], np.linalg.norm(fmu["contact.source_force"])
    check_close("force", force, scene.forces(first_state(scene))[0], 1e-9 * (1.0 + size))
    torque = np.cross(at - scene.place, force)
    check_close("torque", fmu["contact.source_torque"], torque, 1e-10 * (1.0 + size))
    check_close("other torque", fmu["contact.destination_torque"], -np.cross(at, force), 1e-10 * (1.0 + size))


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_no_touch_of_a_long_flight_is_missed(opened, first):
    """One step of up to 1000 s. The gap is a convex function of time, whose minimum is found by thirds."""
    touches = 0
    for seed in range(first, first + 20):
        rng, scene = np.random.default_rng(1000 + seed), falling(seed)
        velocity = 10 ** rng.uniform(-1.0, 1.5) * rng.normal(size=3)
        aim = (
            rng.uniform(-0.6, 0.6) * min(scene.length[1], 5.0) * scene.axes[1]
            - rng.uniform(-0.6, 0.6) * min(scene.length[0], 5.0) * scene.axes[0]
            + 1.5 * sum(scene.radius) * rng.uniform(-1.0, 1.0) * unit(np.cross(*scene.axes))
        )
        scene = replace(scene, both=False, velocity=velocity, place=aim - rng.uniform(10.0, 900.0) * velocity)

        def gap(time, scene=scene):
            return scene.forces(np.concatenate([scene.place + time * scene.velocity, np.zeros(11)]))[3]

        low, high = 0.0, 1000.0
        for _ in range(200):
            third = (high - low) / 3.0
            low, high = (low, high - third) if gap(low + third) < gap(high - third) else (low + third, high)
        if abs(gap(low)) < 1e-8:
            continue  # a graze, which rounding decides
        fmu = run(opened("CylinderCylinder"), scene.values() | {"gravity": [0.0, 0.0, 0.0]}, low, 1, 1e-8)
        assert fmu["contact.onsets"] == (gap(low) < 0.0), seed
        if gap(low) < 0.0:
            touches += 1
            onset = fmu["contact.last_onset_time"]
            check_close(f"{seed}: onset", onset, brentq(gap, 0.0, low, xtol=1e-13), 1e-9)
    assert touches >= 10


def test_a_bar_slides_along_another_that_it_just_touches(opened):
    values = {"contact.axes": "skew", "source.axis": [1.0, 0.0, 0.0], "source.finite_length": True}
    values |= {"source.center": [0.0, 0.0, 0.6], "gravity": [0.0, 1.0, 0.0]}
    assert run(opened("CylinderCylinder"), values, 1.0, 1)["contact.onsets"] == 0


@pytest.mark.parametrize("seed", range(6))
def test_a_roller_that_is_fast_enough_passes_through_the_axis_of_another(opened, seed):
    """The normal reverses there; energy is kept."""
    scene = falling(3 * seed)
    speed, m = 1.5 * sum(scene.radius) * np.sqrt(500.0 / scene.mass[0]), unit(np.cross(*scene.axes))
    scene = replace(scene, velocity=-speed * np.sign(scene.place @ m) * m + 0.1 * scene.velocity, end=0.25)
    scene = replace(scene, stiffness=500.0, damping=0.0, both=False)
    for method in METHODS:
        fmu = start(opened("CylinderCylinder"), scene.values(), 1e-10, method)
        before = fmu["energy.total"]
        fmu.step(scene.end)
        assert (fmu["source.position"] @ m) * (scene.place @ m) < 0.0
        check_close(f"{method}: energy", fmu["energy.total"], before, 1e-9 * max(1.0, fmu["energy.kinetic"]))
        check_close(f"{method}: deepest", fmu["contact.peak_penetration"], sum(scene.radius), 1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_the_impulse_of_prescribed_cylinders_is_the_integral_of_the_force(opened, seed):
    """Over one step in which the source passes ends, or the destination's axis."""
    rng, scene = np.random.default_rng(seed), falling(seed)
    length, span = rng.uniform(0.2, 1.0), [min(one, 1.0) for one in scene.length]
    depth = rng.uniform(0.1, 1.2) * rng.choice([-1.0, 1.0]) * (seed % 4 > 0)
    aim = (
        rng.uniform(-0.7, 0.7) * span[1] * scene.axes[1]
        - rng.uniform(-0.7, 0.7) * span[0] * scene.axes[0]
        + depth * sum(scene.radius) * unit(np.cross(*scene.axes))
    )
    scene = replace(scene, both=True, turns=True, place=aim - 0.487 * length * scene.velocity)
    values = {name: value for name, value in scene.values().items() if "initial" not in name}
    for body, rate, e in zip(BODIES, scene.rates, scene.axes, strict=True):
        values |= {f"{body}.motion": "prescribed", f"{body}.rotation": "prescribed"}
        values[f"{body}.prescribed_angular_velocity"] = rate * e
    values["source.prescribed_velocity"] = scene.velocity
    values["source.prescribed_displacement.derivatives"] = [scene.velocity]

    def force(time):
        y = np.concatenate([scene.place + time * scene.velocity, scene.velocity, np.zeros(6), scene.rates])
        force, _, _, _, (arm, other) = scene.forces(y)
        return np.concatenate([force, np.cross(arm, force), -np.cross(other, force)])

    fmu = run(opened("CylinderCylinder"), values, length, 1, 1e-10)
    places = np.linspace(0.0, length, 202)[1:-1]
    expected, _ = quad_vec(force, 0.0, length, epsabs=1e-9, epsrel=1e-11, points=places, limit=20_000)
    names = ("mean_force", "mean_source_torque", "mean_destination_torque")
    found = length * np.concatenate([fmu[f"contact.{name}"] for name in names])
    check_close("impulses", found, expected, 1e-7 * max(1.0, np.max(np.abs(expected))))


def crossed_stiffness(modulus: float, r_s: float, r_d: float, angle: float) -> float:
    """k_h by the curvatures along the axes of the contact ellipse"""
    total = 0.5 * (1.0 / r_s + 1.0 / r_d)
    apart = 0.5 * np.sqrt(r_s**-2 + r_d**-2 + 2.0 * np.cos(2.0 * angle) / (r_s * r_d))
    return float(elliptic_stiffness(modulus, 0.5 * (total - apart), 0.5 * (total + apart)))


def hertz_of(opened, angle: float, r_s: float, r_d: float) -> float:
    values = {"source.radius": r_s, "destination.radius": r_d, "source.center": [0.0, 0.0, 9.0]}
    values |= {"source.axis": [1.0, 0.0, 0.0], "destination.axis": [np.cos(angle), np.sin(angle), 0.0]}
    values |= {"contact.axes": "skew", "contact.law": "hertz", "contact.penalty_control": "automatic"}
    return start(opened("CylinderCylinder"), values)["contact.effective_hertz_stiffness"]


MODULUS = 2.1e11 / 2.0 / (1.0 - 0.09)


@pytest.mark.parametrize("angle", [0.02, 0.3, 0.5 * np.pi - 0.01, 1.2, 3.0])
def test_the_stiffness_of_crossed_cylinders_is_hertzs(opened, angle):
    expected = crossed_stiffness(MODULUS, 0.02, 0.05, angle)
    check_relative("k_h", hertz_of(opened, angle, 0.02, 0.05), expected, 1e-9)


def test_equal_cylinders_at_right_angles_are_as_stiff_as_a_sphere_on_a_plane(opened):
    expected = 4.0 / 3.0 * MODULUS * np.sqrt(0.03)
    check_relative("k_h", hertz_of(opened, 0.5 * np.pi, 0.03, 0.03), expected, 1e-12)


# cos(theta) and lambda of Roark's Formulas for Stress and Strain (Young and Budynas), table 14.1, case 4
TABULATED = [(0.0, 0.750), (0.2, 0.743), (0.4, 0.721), (0.6, 0.678), (0.8, 0.594), (0.9, 0.510)]
TABULATED += [(0.98, 0.345)]


@pytest.mark.parametrize("cosine, approach", TABULATED)
def test_the_approach_of_crossed_cylinders_is_that_of_the_table(opened, cosine, approach):
    """The approach is lambda (P^2/(E*^2 K_D))^(1/3), with K_D = 1.5 over the sum of all curvatures. Equal
    cylinders are at the table's angle theta."""
    stiffness = hertz_of(opened, np.arccos(cosine), 0.04, 0.04)
    load, sum_of_curvatures = 1e4, 2.0 / 0.04
    expected = approach * np.cbrt(load**2 / (MODULUS**2 * 1.5 / sum_of_curvatures))
    check_relative("approach", (load / stiffness) ** (2.0 / 3.0), expected, 2e-3)


@pytest.mark.parametrize("angle", [2e-6, 1e-4, 1e-2])
def test_axes_that_are_nearly_parallel_bounce_back(opened, angle):
    """A roller falls flat on another; one point in the overlap takes the impact, m v'' = -k x."""
    values = {**{f"{body}.finite_length": True for body in BODIES}}
    values |= {**{"contact.axes": "skew", "source.axis": [np.cos(angle), np.sin(angle), 0.0]}}
    values |= {**{"destination.axis": [-1.0, 0.0, 0.0], "source.length": 0.4, "destination.length": 0.6}}
    values |= {**{"source.center": [0.1, 0.0, 0.61], "source.initial_velocity": [0.0, 0.0, -1.0]}}
    values |= {**{"gravity": [0.0, 0.0, 0.0], "contact.method": "penalty", "contact.penalty_factor": 1e5}}
    for method in METHODS:
        fmu = run(opened("CylinderCylinder"), values, 0.05, 1, 1e-10, method)
        assert fmu["contact.onsets"] == 1
        check_close(f"{method}: velocity", fmu["source.velocity"], [0.0, 0.0, 1.0], 1e-7)
        check_relative(f"{method}: lasted", fmu["contact.last_duration"], np.pi * np.sqrt(1.0 / 1e5), 1e-7)
        check_relative(f"{method}: peak", fmu["contact.peak_force"], np.sqrt(1e5), 1e-7)


def test_a_driven_roller_drives_another_across_it(opened):
    """The impulse J of friction ends the slip, whatever way it took, by a linear equation. The upper roller
    moves by J/m and turns by J across its axis, with m r^2/2; the lower one turns more slowly, by J too."""
    fmu = start(opened("CrossedRollers"), {}, 1e-10)
    m, inertia, rate = (
        fmu["source.mass"], fmu["destination.axial_inertia"], fmu["destination.angular_velocity"],
    )  # fmt: skip
    e, up = unit(rate), np.array([0.0, 0.0, 1.0])
    fmu.step(0.3)
    lever = fmu["source.position"][2] - fmu["source.radius"]  # the force acts at the surface of the source
    lower, across = np.cross(e, lever * up)[:2], np.array([0.0, 1.0])
    slows = np.eye(2) / m + 2.0 * np.outer(across, across) / m + np.outer(lower, lower) / inertia
    impulse = np.linalg.solve(slows, lower * np.linalg.norm(rate))
    check_close("velocity", fmu["source.velocity"], [*impulse / m, 0.0], 1e-9)
    turned = [2.0 * impulse[1] / (m * fmu["source.radius"]), 0.0, 0.0]
    check_close("rate", fmu["source.angular_velocity"], turned, 1e-7)
    check_close("lower rate", fmu["destination.angular_velocity"], rate - lower @ impulse / inertia * e, 1e-9)
    check_close("slip", fmu["contact.slip_velocity"], np.zeros(3), 1e-9)
    assert fmu["contact.active"]
    fmu.step(0.4)
    assert not fmu["contact.active"], "its end has passed"
    assert fmu["source.position"][2] < 0.0


@pytest.mark.parametrize("wrong, words", [
    ({"destination.axis": [0.0, -2.0, 0.0]}, "allowed: 1e-6 rad at least"),
    ({"destination.axis": [1e-8, 1.0, 0.0]}, "to an angle of 1e-08 rad"),
    ({"destination.axis": [0.0, 0.0, 0.0]}, "has no direction"),
    ({"contact.location": "inside", "source.radius": 0.1}, "touch from outside"),
    ({"contact.axes": "parallel"}, "or axes = skew"),
    ({"source.rotation": "free", "source.initial_angular_velocity": [1.0, 0.0, 0.0]}, "its own axis"),
])  # fmt: skip
def test_what_skew_cylinders_cannot_be_is_refused_and_said(opened, wrong, words):
    values = {"contact.axes": "skew", "destination.axis": [1.0, 0.0, 0.0]}
    with pytest.raises(FmuError, match=words):
        start(opened("CylinderCylinder"), values | wrong)
