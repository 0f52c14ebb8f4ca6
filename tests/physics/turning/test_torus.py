"""A sphere and a torus against a signed distance by minimization over the circle, and an own integration."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from contact_fmus.stability.motions import elliptic_stiffness
from support.checks import check_close, check_relative, run, start
from support.reference.pressed import GRAVITY, ended, pressed, unit
from support.scenes.agreement import seeds
from support.scenes.random_scenes import touching_values

METHODS = ("event_driven", "cvode_bdf")


def nearest(place: np.ndarray, frame: np.ndarray, ring: float) -> np.ndarray:
    """The nearest point of a circle in the plane of frame[1] and frame[2]: Newton's method on its angle."""

    def point(angle):
        return ring * (np.cos(angle) * frame[1] + np.sin(angle) * frame[2])

    angles = np.linspace(0.0, 2.0 * np.pi, 33)[:-1]
    angle = min(angles, key=lambda one: np.linalg.norm(point(one) - place))
    for _ in range(40):
        away, along = point(angle) - place, point(angle + 0.5 * np.pi)
        bend = along @ along - away @ point(angle)
        step = np.clip(away @ along / abs(bend), -0.3, 0.3)
        angle -= step
        if abs(step) < 1e-16:
            break
    return point(angle)


@dataclass
class Ring:
    """A scene; places and velocities of the source are from the centre of the torus"""

    frame: np.ndarray  # its rows: the axis of the torus and two directions across it
    side: str
    inside: bool
    ring: float
    tube: float
    ball: float
    mass: tuple[float, float]
    place: np.ndarray
    velocity: np.ndarray
    spins: tuple[np.ndarray, np.ndarray]  # rad/s, of source and torus
    stiffness: float
    damping: float
    friction: float
    turns: tuple[bool, bool]
    both: bool  # whether the torus is free
    slip: float = 1e-2
    end: float = 0.15

    def values(self) -> dict:
        values = touching_values(self) | {"source.radius": self.ball, "destination.axis": 2.0 * self.frame[0]}
        values |= {"destination.radius": self.tube, "destination.ring_radius": self.ring}
        values |= {"destination.side": self.side}
        for i, body in enumerate(("source", "destination")):
            values[f"{body}.mass"] = self.mass[i]
            if self.turns[i]:
                values |= {f"{body}.rotation": "free", f"{body}.initial_angular_velocity": self.spins[i]}
        return values

    def inertia(self) -> tuple[float, float, float]:
        """Of the ball, of the torus about its axis and across it: a solid torus by Pappus"""
        m, r = self.mass[1], self.tube
        axial, transverse = m * (self.ring**2 + 0.75 * r * r), m * (0.5 * self.ring**2 + 0.625 * r * r)
        return 0.4 * self.mass[0] * self.ball**2, axial, transverse

    def forces(self, y) -> tuple:
        """Force on the source, torques on both, gap, and how far the source is beside the race"""
        place, velocity, far, moved, spin, turn = y[:18].reshape(6, 3)
        frame = y[18:].reshape(3, 3)
        out = place - far - nearest(place - far, frame, self.ring)
        distance = np.linalg.norm(out)
        push = (-1.0 if self.inside else 1.0) * out / distance
        depth = distance + self.ball - self.tube if self.inside else self.ball + self.tube - distance
        across = place - far - ((place - far) @ frame[0]) * frame[0]
        beyond = np.linalg.norm(across) - self.ring
        beside = {"whole": -1.0, "inner_race": beyond, "outer_race": -beyond}[self.side]
        none = np.zeros(3)
        if depth <= 0.0 or beside > 0.0:
            return none, none, none, -depth, beside
        point = place - self.ball * push
        slip = velocity + np.cross(spin, point - place) - moved - np.cross(turn, point - far)
        force = pressed(self, depth, velocity - moved - np.cross(turn, place - far), push, slip)
        return force, np.cross(point - place, force), -np.cross(point - far, force), -depth, beside

    def rates(self, _t, y) -> np.ndarray:
        force, torque, other, _, _ = self.forces(y)
        ball, axial, transverse = self.inertia()
        rates = np.zeros(27)
        rates[0:3], rates[3:6] = y[3:6], GRAVITY + force / self.mass[0]
        if self.both:
            rates[6:9], rates[9:12] = y[9:12], GRAVITY - force / self.mass[1]
        if self.turns[0]:
            rates[12:15] = torque / ball
        if self.turns[1]:
            omega, e = y[15:18], y[18:21]
            other = other - np.cross(omega, transverse * omega + (axial - transverse) * (omega @ e) * e)
            rates[15:18] = other / transverse + (1.0 / axial - 1.0 / transverse) * (other @ e) * e
            rates[18:27] = np.cross(omega, y[18:27].reshape(3, 3)).ravel()
        return rates

    def ended(self) -> np.ndarray:
        spins = [spin if turns else np.zeros(3) for spin, turns in zip(self.spins, self.turns, strict=True)]
        y = np.concatenate([self.place, self.velocity, np.zeros(6), *spins, self.frame.ravel()])
        events = [lambda _t, y: self.forces(y)[3], lambda _t, y: self.forces(y)[4]]
        events = events[: 1 if self.side == "whole" else 2]
        options = {"rtol": 1e-11, "atol": 1e-12, "max_step": 5e-4}
        return ended(self, self.rates, y, events, **options)[:21]


@cache
def scene(seed: int) -> Ring:
    rng = np.random.default_rng(seed)
    e = unit(rng.normal(size=3))
    a = unit(np.cross(e, rng.normal(size=3)))
    frame = np.array([e, a, np.cross(e, a)])
    inside, side = bool(rng.random() < 0.4), str(rng.choice(["whole", "whole", "inner_race", "outer_race"]))
    ring = rng.uniform(0.5, 1.5)
    tube = ring * rng.uniform(0.15, 0.45)
    ball = tube * rng.uniform(0.2, 0.9) if inside else rng.uniform(0.05, min(0.4, ring - tube - 0.02))
    round_ring, round_tube = rng.uniform(0.0, 2.0 * np.pi, 2)
    if side != "whole":
        round_tube = (np.pi if side == "inner_race" else 0.0) + rng.uniform(-1.2, 1.2)
    middle = np.cos(round_ring) * frame[1] + np.sin(round_ring) * frame[2]
    out = np.cos(round_tube) * middle + np.sin(round_tube) * e
    gap = rng.uniform(0.001, 0.03)
    distance = max(tube - ball - gap, 0.01) if inside else tube + ball + gap
    speed = (1.0 if inside else -1.0) * rng.uniform(0.2, 1.5)
    return Ring(
        frame, side, inside, ring, tube, ball, (rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)),
        ring * middle + distance * out, speed * out + 0.5 * rng.normal(size=3),
        (5.0 * rng.normal(size=3), 2.0 * rng.normal(size=3)),
        10 ** rng.uniform(4.0, 6.0), rng.choice([0.0, 50.0]), rng.choice([0.0, 0.3]),
        (bool(rng.random() < 0.6), bool(rng.random() < 0.4)), bool(rng.random() < 0.4),
    )  # fmt: skip


@cache
def reference(seed: int) -> np.ndarray:
    return scene(seed).ended()


def state_of(fmu) -> np.ndarray:
    names = [f"{body}.{what}" for body in ("source", "destination") for what in ("position", "velocity")]
    names += ["source.angular_velocity", "destination.angular_velocity", "destination.current_axis"]
    return np.concatenate([fmu[name] for name in names])


@pytest.mark.parametrize("seed", seeds(10))
def test_the_pair_moves_as_the_nearest_point_of_the_circle_says(opened, seed):
    one = scene(seed)
    for method in METHODS:
        fmu = start(opened("SphereTorus"), one.values(), 1e-10, method)
        before = fmu["energy.total"]
        fmu.step(one.end)
        check_close(f"{method}: state", state_of(fmu), reference(seed), 1e-7)
        check_close(f"{method}: energy", fmu["energy.total"], before, 1e-9 * max(1.0, abs(before)))


def check_segments(fmu, one):
    """Against the integration, without the general segment"""
    run(fmu, one.values(), one.end, 1, 1e-10)
    check_close("state", state_of(fmu), one.ended(), 1e-8)
    assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("seed", range(2))
def test_a_bounce_without_friction_takes_segments(opened, seed):
    one = replace(scene(seed), side="whole", friction=0.0, turns=(False, False))
    check_segments(opened("SphereTorus"), one)


@pytest.mark.parametrize("damping", [100.0, 4000.0])  # Ns/m: below and beyond critical
def test_a_ball_that_lies_in_the_tube_takes_segments(opened, damping):
    """It starts at the bottom of an upright ring, and goes round the tube and along it."""
    frame = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    one = replace(scene(0), frame=frame, side="whole", inside=True, friction=0.0, turns=(False, False))
    one = replace(one, ring=1.0, tube=0.4, ball=0.1, both=False, stiffness=1e6, damping=damping, end=0.3)
    place, velocity = np.array([0.0, 0.0, -1.30002]), np.array([0.4, 0.5, 0.0])
    check_segments(opened("SphereTorus"), replace(one, place=place, velocity=velocity))


def test_the_scenes_reach_what_they_are_about():
    scenes = [scene(seed) for seed in range(10)]
    assert {one.side for one in scenes} == {"whole", "inner_race", "outer_race"}
    assert {one.inside for one in scenes} == {one.friction > 0.0 for one in scenes} == {False, True}
    assert {one.both for one in scenes} == {one.turns[1] for one in scenes} == {False, True}


SAMPLES = 200_001


def gaps_of(one: Ring, time: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The gap in flight without gravity, sampled; infinite beside the race"""
    place, e = one.place + np.outer(time, one.velocity), one.frame[0]
    rate = np.linalg.norm(turn)
    if rate > 0.0:  # e turns about `turn`, by Rodrigues' formula
        k, angle = turn / rate, rate * time[:, None]
        e = np.cos(angle) * e + np.sin(angle) * np.cross(k, e) + (1.0 - np.cos(angle)) * (k @ e) * k
    along = np.sum(place * e, axis=1)
    rho = np.linalg.norm(place - along[:, None] * e, axis=1)
    distance = np.hypot(rho - one.ring, along)
    gap = one.tube - one.ball - distance if one.inside else distance - one.tube - one.ball
    beside = {"whole": np.zeros_like(rho, bool), "inner_race": rho > one.ring, "outer_race": rho < one.ring}
    return np.where(beside[one.side], np.inf, gap)


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_no_touch_of_a_long_flight_is_missed(opened, first):
    """One step of 1000 s, through the hole, past the ring, within the tube, while the ring tumbles."""
    touches = 0
    for seed in range(first, first + 20):
        rng = np.random.default_rng(1000 + seed)
        one, turn = scene(seed), 10.0 ** rng.uniform(-3.0, 0.0) * rng.normal(size=3) * (rng.random() < 0.4)
        if one.inside:
            one = replace(one, velocity=10.0 ** rng.uniform(-3.0, -1.0) * one.velocity)
            one.place = one.ring * one.frame[1]
        else:
            one = replace(one, velocity=rng.normal(size=3))
            one.place = 0.8 * one.ring * rng.normal(size=3) - rng.uniform(10.0, 900.0) * one.velocity
        values = one.values() | {"gravity": [0.0, 0.0, 0.0], "destination.motion": "fixed"}
        values |= {"destination.rotation": "prescribed", "destination.prescribed_angular_velocity": turn}
        values |= {"destination.prescribed_axis": one.frame[0], "source.rotation": "none"}
        time = np.linspace(0.0, 1000.0, SAMPLES)
        below = np.flatnonzero(gaps_of(one, time, turn) < 0.0)
        fmu = run(opened("SphereTorus"), values, time[below[0]] if below.size else 1000.0, 1, 1e-8)
        if below.size:
            touches += 1
            assert fmu["contact.onsets"] == 1, seed
            assert time[below[0] - 1] <= fmu["contact.last_onset_time"] <= time[below[0]], seed
    assert touches >= 5


LIES = {"source.radius": 0.25, "source.center": [2.25, 0.0, 0.0], "source.initial_velocity": [0.0, 1.0, 0.0]}
LIES |= {"destination.side": "outer_race", "destination.motion": "free", "destination.mass": 4.0}
ALIKE = {f"{body}.initial_angular_velocity": [-0.8, 0.0, 0.6] for body in ("source", "destination")}
ALIKE |= {"source.rotation": "free", "destination.rotation": "free", "destination.axis": [0.6, 0.0, 0.8]}
ALIKE |= {"source.radius": 0.125, "source.center": [0.0, 2.6875, 0.0], "gravity": [0.0, -9.81, 0.0]}
ALIKE |= {"source.initial_velocity": [0.0, -1.0, 0.0], "contact.rolling_stiffness": 1.0}
ALIKE |= {"contact.rolling": "elastic", "contact.rolling_coefficient": 0.125, "contact.rolling_damping": 0.0}


@pytest.mark.parametrize("values", [LIES, ALIKE], ids=["gap rate", "spin"])
def test_a_touch_with_a_rate_of_rounding_takes_few_steps(opened, values):
    values |= {"destination.ring_radius": 2.0, "contact.law": "hertz", "contact.hertz_stiffness": 1e5}
    values |= {"contact.hunt_crossley_factor": 0.0, "solver.absolute_tolerance": 1e-14}
    for tolerance in (1e-7, 1e-8, 1e-9):
        fmu = run(opened("SphereTorus"), values, 0.0625, 1, tolerance)
        assert fmu["contact.onsets"] == 1 and fmu["solver.steps"] < 10


@pytest.mark.parametrize("side, curvature", [("whole", 0.0), ("inner_race", 1.0), ("outer_race", -1.0)])
def test_the_stiffness_of_a_groove_is_hertzs(opened, side, curvature):
    """Of a deep-groove ball bearing with balls of 12.7 mm, at the bottom of either race."""
    values = {"source.radius": 0.00635, "destination.radius": 0.0066, "destination.ring_radius": 0.0325}
    values |= {"source.center": [0.0325, 0.0, 0.0], "destination.side": side, "contact.location": "inside"}
    values |= {"contact.law": "hertz", "contact.penalty_control": "automatic"}
    fmu = start(opened("SphereTorus"), values)
    modulus = 2.1e11 / 2.0 / (1.0 - 0.09)
    tight = 1.0 / 0.00635 - 1.0 / 0.0066
    # the middle line of the tube is bent round the axis, and the groove with it at its bottom
    loose = 1.0 / 0.00635 + curvature / (0.0325 - curvature * 0.0066)
    expected = float(elliptic_stiffness(modulus, *sorted((0.5 * tight, 0.5 * loose))))
    check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-9)


@pytest.mark.parametrize("wrong, words", [
    ({"destination.radius": 1.0}, "has a hole"),
    ({"source.radius": 0.6}, "all round the hole"),
    ({"destination.axis": [0.0, 0.0, 0.0]}, "has no direction"),
    ({"contact.location": "inside", "source.radius": 0.5}, "smaller than its hollow destination"),
])  # fmt: skip
def test_what_a_torus_cannot_be_is_refused_and_said(opened, wrong, words):
    with pytest.raises(FmuError, match=words):
        start(opened("SphereTorus"), wrong)
