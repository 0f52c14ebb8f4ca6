"""Lasting contact on walls of any stiffness: P3 and its like in hollow cylinders and spheres, on fixed,
moved and free bodies, and on the outside of a sphere."""

from math import sqrt

import numpy as np

from support.reference.stiff_motion import StiffContact
from support.scenes.benchmarks import BENCHMARKS

BALL = {"source.radius": 0.05, "source.mass": 0.1, "destination.radius": 0.5}
HOLLOW = {**BALL, "contact.location": "inside", "contact.dashpot": "unclamped"}
TILTED = np.array([1.0, 2.0, 0.4])
DOWNWARD = np.array([0.48, -0.6, -0.64])  # unit vectors
ALONG = np.array([0.8, 0.0, 0.6])


def tilted_cylinder():
    """Round and along a cylinder that is not level"""
    axis = TILTED / np.linalg.norm(TILTED)
    outward = np.cross(axis, [0.0, 1.0, 0.0])
    outward /= np.linalg.norm(outward)
    outward *= -np.sign(outward[2])
    return {
        **HOLLOW,
        "source.center": (0.45 * outward).tolist(),
        "source.initial_velocity": (1.3 * np.cross(axis, outward) + 0.4 * axis).tolist(),
        "destination.axis": TILTED.tolist(),
    }


def hollow_sphere():
    """Neither in a plane nor on a parallel"""
    values = {**HOLLOW, "source.center": (0.45 * DOWNWARD).tolist()}
    values |= {"source.initial_velocity": (1.7 * ALONG).tolist(), "contact.dashpot": "non_adhesive"}
    return values


def moved_sphere():
    rate, acceleration = [0.3, -0.2, 0.1], [1.0, 2.0, -0.5]
    return {
        **hollow_sphere(),
        "source.initial_velocity": (1.7 * ALONG + rate).tolist(),
        "destination.motion": "prescribed",
        "destination.prescribed_velocity": rate,
        "destination.prescribed_displacement.derivatives": [rate, acceleration],
        "destination.prescribed_velocity.derivatives": [acceleration],
    }


def free_sphere():
    """Held in contact by its own turning, both pushed"""
    drift = [0.1, 0.0, 0.2]
    return {
        **hollow_sphere(),
        "source.initial_velocity": (1.7 * ALONG + drift).tolist(),
        "destination.motion": "free", "destination.mass": 0.3, "destination.initial_velocity": drift,
        "source.external_force": [0.05, 0.1, -0.1], "destination.external_force": [0.2, -0.1, 2.0],
    }  # fmt: skip


def on_top():
    """Sliding off the outside; 0.25 s in it has not left yet"""
    return {
        **BALL,
        "contact.location": "outside",
        "source.center": (0.55 * np.array([0.08, 0.06, sqrt(0.99)])).tolist(),
        "source.initial_velocity": (0.3 * np.array([-0.6, 0.8, 0.0])).tolist(),
    }


# Clamped or not, the ball is never pulled; without damping there is nothing to clamp.
P3 = {name: value for name, value in BENCHMARKS["P3"].configuration.items() if name != "contact.dashpot"}
SCENES = {
    "P3": ("cylinder", P3, 2.0),
    "tilted cylinder": ("cylinder", tilted_cylinder(), 1.5),
    "hollow sphere": ("sphere", hollow_sphere(), 2.0),
    "moved sphere": ("sphere", moved_sphere(), 1.5),
    "free sphere": ("sphere", free_sphere(), 1.0),
    "on top": ("sphere", on_top(), 0.25),
}


def stiff_scene(name, stiffness, share):
    """shape, configuration and end, with the dashpot at `share` of the critical one"""
    shape, values, end = SCENES[name]
    values = {**values, "contact.method": "penalty_dynamic", "contact.penalty_factor": stiffness}
    mass = StiffContact(values, shape).effective
    values["contact.viscous_penalty_factor"] = 2 * share * sqrt(stiffness * mass)
    return shape, values, end


def settled(shape, values):
    """The same, started where nothing oscillates"""
    depth, rate = StiffContact(values, shape).settled()
    speed = np.array(values.get("source.initial_velocity", [0.0] * 3)) + rate
    found = {**values, "source.initial_displacement": depth.tolist()}
    found |= {"source.initial_velocity": speed.tolist()}
    return found
