"""Two cylinders with skew axes against a distance by minimization over both axes, and an own integration."""

import os
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import check_close, check_relative, start
from support.scenes.scene_parts import touching_values

COUNT = int(os.environ.get("CONTACT_SCENES", "12"))
METHODS = ("event_driven", "cvode_bdf")
G = np.array([0.0, 0.0, -9.81])
SMALL = 1e-12  # s, past an event, so that the next integration starts beyond it


def unit(a) -> np.ndarray:
    return np.asarray(a, float) / np.linalg.norm(a)


def nearest(away: np.ndarray, e: tuple, half: tuple) -> tuple[float, float]:
    """The places a, b on both axes with the least |away + a e_s - b e_d|, away from the destination's centre to
    the source's: the best of the stationary point and of the best points of all four edges of the range."""
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


@dataclass
class Pair:
    """A scene: the destination's centre starts at the origin"""

    axes: tuple[np.ndarray, np.ndarray]  # unit vectors of source and destination
    radius: tuple[float, float]
    mass: tuple[float, float]
    length: tuple[float, float]  # infinite where they have no ends
    place: np.ndarray  # of the source
    velocity: np.ndarray
    rates: tuple[float, float]  # about their axes, rad/s
    stiffness: float
    damping: float
    friction: float  # coefficient; 0: none
    turns: bool
    both: bool  # whether the destination is free too
    inside: bool = False
    slip: float = 1e-2
    end: float = 0.12

    def values(self) -> dict:
        values = touching_values(self) | {"contact.axes": "skew"}
        for i, body in enumerate(("source", "destination")):
            values |= {
                f"{body}.radius": self.radius[i],
                f"{body}.mass": self.mass[i],
                f"{body}.axis": (2.0 - 3.0 * i) * self.axes[i],
            }
            if np.isfinite(self.length[i]):
                values |= {f"{body}.finite_length": True, f"{body}.length": self.length[i]}
            if self.turns:
                values |= {
                    f"{body}.rotation": "free",
                    f"{body}.initial_angular_velocity": self.rates[i] * self.axes[i],
                }
        return values

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
        speed = y[3:6] - y[9:12]
        slip = speed + np.cross(y[12] * e_s, arm) - np.cross(y[13] * e_d, other)
        normal = max(self.stiffness * depth + self.damping * speed @ n, 0.0)
        slip -= (slip @ n) * n
        size = np.linalg.norm(slip)
        force = -normal * n
        if self.friction and size > 0.0:
            force = force + self.friction * normal * np.expm1(-size / self.slip) * slip / size
        return force, np.cross(arm, force) @ e_s, -np.cross(other, force) @ e_d, -depth, (arm, other)

    def rates_of(self, _t, y) -> np.ndarray:
        force, torque, other, _, _ = self.forces(y)
        rates = np.zeros(14)
        rates[0:3], rates[3:6] = y[3:6], G + force / self.mass[0]
        if self.both:
            rates[6:9], rates[9:12] = y[9:12], G - force / self.mass[1]
        if self.turns:
            rates[12:14] = [
                2.0 * t / (m * r * r) for t, m, r in zip((torque, other), self.mass, self.radius, strict=True)
            ]
        return rates

    def start(self) -> np.ndarray:
        rates = self.rates if self.turns else (0.0, 0.0)
        return np.concatenate([self.place, self.velocity, np.zeros(6), rates])

    def ended(self) -> np.ndarray:
        """Places and velocities of both, and their rates about their axes"""
        y, time = self.start(), 0.0

        def touches(_t, y):
            return self.forces(y)[3]

        touches.terminal = True
        while time < self.end - 1e-15:
            found = solve_ivp(self.rates_of, (time, self.end), y, "DOP853", events=[touches],
                              rtol=1e-12, atol=1e-13, max_step=5e-4)  # fmt: skip
            time, y = found.t[-1], found.y[:, -1]
            if found.status == 1:
                y, time = y + SMALL * self.rates_of(time, y), time + SMALL
        return y


@cache
def pair(seed: int) -> Pair:
    """One in three infinite, one in three finite, the others half of each; half of the touches near an end."""
    rng = np.random.default_rng(seed)
    axes = unit(rng.normal(size=3)), unit(rng.normal(size=3))
    while not 0.2 < np.linalg.norm(np.cross(*axes)):
        axes = axes[0], unit(rng.normal(size=3))
    radius = rng.uniform(0.05, 0.2), rng.uniform(0.05, 0.3)
    length = tuple(rng.uniform(0.2, 1.0, 2))
    kind = seed % 3
    length = (np.inf, np.inf) if kind == 0 else length if kind == 1 else (length[0], np.inf)
    length = length[::-1] if seed % 2 else length
    reach = [0.5 * (min(one, 0.6)) * rng.choice([rng.uniform(-0.5, 0.5), rng.uniform(0.9, 1.1)]) for one in length]
    out = unit(np.cross(*axes)) * rng.choice([-1.0, 1.0])
    place = reach[1] * axes[1] - reach[0] * axes[0] - (sum(radius) + rng.uniform(0.001, 0.02)) * out
    return Pair(
        axes, radius, (rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)), length, place,
        rng.uniform(0.2, 1.5) * out + 0.6 * rng.normal(size=3), tuple(10.0 * rng.normal(size=2)),
        10 ** rng.uniform(3.5, 5.5), rng.choice([0.0, 50.0]), rng.choice([0.0, 0.3]),
        bool(rng.random() < 0.7), bool(rng.random() < 0.5),
    )  # fmt: skip


@cache
def reference(seed: int) -> np.ndarray:
    return pair(seed).ended()


def state_of(fmu, axes) -> np.ndarray:
    parts = [fmu[f"{body}.{what}"] for body in ("source", "destination") for what in ("position", "velocity")]
    spins = [
        fmu[f"{body}.angular_velocity"] @ e for body, e in zip(("source", "destination"), axes, strict=True)
    ]
    return np.concatenate([*parts, spins])


@pytest.mark.parametrize("seed", range(COUNT))
def test_skew_cylinders_move_as_by_the_distance_of_their_axes(opened, seed):
    """With ends that are passed in contact, friction along the axes, one body free or both."""
    scene = pair(seed)
    for method in METHODS:
        fmu = start(opened("CylinderCylinder"), scene.values(), 1e-10, method)
        before = fmu["energy.total"]
        fmu.step(scene.end)
        check_close(f"{method}: state", state_of(fmu, scene.axes), reference(seed), 1e-7)
        check_close(f"{method}: energy", fmu["energy.total"], before, 1e-9 * max(1.0, abs(before)))
