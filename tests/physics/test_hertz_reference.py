"""Oblique and lasting contacts by Hertz's law against another integration: Dormand and Prince's method of
order 8 (scipy) with an event at every touch, release and change of the damping.
"""

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.checks import METHODS, check_close, run

STIFFNESS = 1e7
SETTINGS = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-16}
NEVER = 1e-9  # s, in which an event that has just happened is not looked for again


class Reference:
    """Two bodies, with y = (x_s, v_s, x_d, v_d) of the centres."""

    def __init__(self, values):
        self.values = values
        self.inverse_mass = [
            1 / values[f"{body}.mass"] if values[f"{body}.motion"] == "free" else 0.0
            for body in ("source", "destination")
        ]
        self.gravity = np.array(values["gravity"])
        self.axis = None
        if "destination.axis" in values:
            self.axis = np.array(values["destination.axis"]) / np.linalg.norm(values["destination.axis"])
        self.inside = values["contact.location"] == "inside"
        self.chi, self.touches, self.mode = 0.0, False, "full"

    def kinematics(self, y):
        """Gap, its rate, and the direction in which the source is pushed."""
        c, w = y[6:9] - y[0:3], y[9:12] - y[3:6]
        if self.axis is not None:
            c = c - (c @ self.axis) * self.axis
        d = np.linalg.norm(c)
        r_s, r_d = self.values["source.radius"], self.values["destination.radius"]
        if self.inside:
            return r_d - r_s - d, -(c @ w) / d, c / d
        return d - r_s - r_d, (c @ w) / d, -c / d

    def rates(self, t, y):
        push = np.zeros(3)
        if self.touches and self.mode != "none":
            gap, rate, along = self.kinematics(y)
            factor = 1.0 - self.chi * rate if self.mode == "full" else 1.0
            push = STIFFNESS * max(-gap, 0.0) ** 1.5 * factor * along
        out = np.empty(12)
        for k, (inverse, sign) in enumerate(zip(self.inverse_mass, (1, -1), strict=True)):
            out[6 * k : 6 * k + 3] = y[6 * k + 3 : 6 * k + 6]
            out[6 * k + 3 : 6 * k + 6] = sign * inverse * push + (self.gravity if inverse else 0.0)
        return out

    def onset(self, rate):
        """chi by the speed of approach, where it follows from the coefficient of restitution."""
        if self.values["contact.viscous_control"] == "user_defined":
            return self.values["contact.hunt_crossley_factor"]
        e = mpmath.mpf(self.values["contact.restitution"])
        if self.values["contact.dashpot"] == "approach_only":
            wanted = mpmath.findroot(
                lambda y: 2 * (y - mpmath.log(1 + y)) / y**2 - e**2, (1e-3, 2 / e**2), solver="anderson"
            )
        else:
            wanted = mpmath.findroot(
                lambda y: mpmath.log((1 + y) / (1 - e * y)) - y * (1 + e), (1.2 * (1 - e), 1 / e - 1e-9),
                solver="anderson",
            )  # fmt: skip
        return float(wanted) / abs(rate)

    def events(self):
        """(name, function, direction) of what may end the present smooth stretch."""
        gap = ("gap", lambda t, y: self.kinematics(y)[0], 1 if self.touches else -1)
        if not self.touches:
            return [gap]
        dashpot = self.values["contact.dashpot"]
        if dashpot == "approach_only":
            return [gap, ("turn", lambda t, y: self.kinematics(y)[1], 1 if self.mode == "full" else -1)]
        if dashpot == "non_adhesive" and self.chi > 0.0:
            clip = lambda t, y: self.chi * self.kinematics(y)[1] - 1.0  # noqa: E731
            return [gap, ("clip", clip, 1 if self.mode == "full" else -1)]
        return [gap]

    def run(self, end):
        y = np.concatenate([
            self.values[f"{body}.{row}"] if row == "center" or f"{body}.{row}" in self.values else np.zeros(3)
            for body in ("source", "destination")
            for row in ("center", "initial_velocity")
        ])  # fmt: skip
        t = 0.0
        while t < end:
            found = self.events()
            functions = []
            for _, function, direction in found:
                # scipy knows a sign change only: what is zero now counts from NEVER on
                guarded = lambda u, z, f=function, s=direction, now=t: -s if u - now < NEVER else f(u, z)  # noqa: E731
                guarded.terminal, guarded.direction = True, direction
                functions.append(guarded)
            first = min(1e-7, end - t)
            done = solve_ivp(self.rates, (t, end), y, events=functions, first_step=first, **SETTINGS)
            t, y = done.t[-1], done.y[:, -1]
            for (name, _, _), times in zip(found, done.t_events, strict=True):
                if len(times) and times[-1] == t and t < end:
                    self.change(name, y)
        return y

    def change(self, name, y):
        if name == "gap":
            self.touches = not self.touches
            self.mode = "full"
            if self.touches:
                self.chi = self.onset(self.kinematics(y)[1])
        elif self.mode == "full":
            self.mode = "spring" if name == "turn" else "none"
        else:
            self.mode = "full"


BASE = {
    "gravity": [0.0, 0.0, -9.81],
    "source.motion": "free",
    "destination.motion": "fixed",
    "source.radius": 0.1,
    "destination.radius": 0.5,
    "source.mass": 1.0,
    "destination.mass": 3.0,
    "destination.center": [0.0, 0.0, 0.0],
    "contact.law": "hertz",
    "contact.hertz_stiffness": STIFFNESS,
    "contact.method": "penalty_dynamic",
    "contact.viscous_control": "user_defined",
    "contact.hunt_crossley_factor": 0.2,
    "contact.restitution": 0.6,
    "contact.dashpot": "non_adhesive",
    "solver.absolute_tolerance": 1e-15,
}
SCENES = {  # FMU, values, end: a few bounces, or a contact that lasts
    "bounces off a ball": ("SphereSphere", {"source.center": [0.05, 0.02, 0.7]}, 0.6),
    "with restitution": (
        "SphereSphere",
        {"source.center": [0.05, 0.02, 0.7], "contact.viscous_control": "restitution"},
        0.6,
    ),
    "clips": (
        "SphereSphere",
        {"source.center": [0.03, 0.0, 0.7], "contact.hunt_crossley_factor": 5.0},
        0.5,
    ),
    "in a shell, approach only": (
        "SphereSphere",
        {
            "source.center": [0.2, 0.0, 0.1],
            "contact.location": "inside",
            "contact.dashpot": "approach_only",
            "contact.viscous_control": "restitution",
        },
        0.7,
    ),
    "slides in a shell": (
        "SphereSphere",
        {
            "source.center": [0.0, 0.0, -0.399],
            "source.initial_velocity": [0.5, 0.3, 0.0],
            "contact.location": "inside",
            "contact.hunt_crossley_factor": 3.0,
        },
        0.4,
    ),
    "two that fly": (
        "SphereSphere",
        {
            "destination.motion": "free",
            "source.center": [0.1, 0.0, 0.65],
            "source.initial_velocity": [0.0, 0.2, -2.0],
            "contact.dashpot": "unclamped",
        },
        0.2,
    ),
    "in a pipe": (
        "SphereCylinder",
        {
            "destination.axis": [0.3, 1.0, 0.1],
            "source.center": [0.1, 0.2, 0.25],
            "source.initial_velocity": [1.0, 0.5, 0.0],
            "contact.location": "inside",
            "contact.viscous_control": "restitution",
            "contact.restitution": 0.9,
        },
        0.8,
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_motion_is_that_of_another_integrator(opened, name):
    fmu_name, more, end = SCENES[name]
    values = {**BASE, "contact.location": "outside", **more}
    reference = Reference(values).run(end)
    for method in METHODS:
        fmu = run(opened(fmu_name), values, end, 7, 1e-12, method)
        size = 1 + math.sqrt(reference @ reference)
        got = np.concatenate([fmu["source.position"], fmu["source.velocity"]])
        check_close(f"{name}, {method}", got, reference[:6], 1e-9 * size)
        check_close("energy", fmu["energy.total"] - start_energy(values), 0.0, 1e-9)


def start_energy(values):
    total = 0.0
    for body in ("source", "destination"):
        if values[f"{body}.motion"] == "free":
            v = np.array(values.get(f"{body}.initial_velocity", [0.0, 0.0, 0.0]))
            height = np.array(values["gravity"]) @ np.array(values[f"{body}.center"])
            total += values[f"{body}.mass"] * (0.5 * v @ v - height)
    depth = values["source.radius"] - values["destination.radius"] + np.linalg.norm(values["source.center"])
    if values["contact.location"] == "inside" and "destination.axis" not in values and depth > 0:
        total += 0.4 * STIFFNESS * depth**2.5
    return total
