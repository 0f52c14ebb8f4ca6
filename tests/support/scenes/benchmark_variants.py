"""Ten problems each of the kinds P1, P2, P3 and P3b of benchmarks.py, with other sizes, masses, factors and
directions.

Their ends are in variant_references.json, made by make_references.py.
"""

import numpy as np

from support.scenes.benchmarks import BENCHMARKS
from support.scenes.random_scenes import perpendicular

COUNT = 10
VARIANTS = [(name, number) for name in BENCHMARKS for number in range(COUNT)]
DASHPOTS = ["unclamped", "non_adhesive", "approach_only"]


def variant(name, number):
    """shape, configuration and end"""
    random = np.random.default_rng([number, list(BENCHMARKS).index(name)])
    make = {"P1": head_on, "P2": oblique, "P3": touching, "P3b": bouncing}[name]
    values, end = make(random)
    return BENCHMARKS[name].shape, {**BENCHMARKS[name].configuration, **values}, end


def ball(random):
    return {
        "source.radius": random.uniform(0.02, 0.2),
        "source.mass": 10 ** random.uniform(-1, 1),
        "destination.radius": random.uniform(0.2, 1.0),
        "destination.center": random.normal(size=3).tolist(),
        "contact.penalty_factor": 10 ** random.uniform(5, 8),
    }


def dashpot(random, values, low, high):
    """A share of the critical dashpot, log-uniform"""
    share = 10 ** random.uniform(np.log10(low), np.log10(high))
    return {
        "contact.viscous_penalty_factor": 2
        * share
        * np.sqrt(values["contact.penalty_factor"] * values["source.mass"]),
        "contact.dashpot": DASHPOTS[random.integers(3)],
    }


def above(values, offset, gap):
    """The source's centre over the destination's, `offset` to the side"""
    height = values["source.radius"] + values["destination.radius"] + gap
    return np.add(values["destination.center"], [*offset, height]).tolist()


def head_on(random):
    values = ball(random)
    values["source.center"] = above(values, (0.0, 0.0), random.uniform(0.05, 1.0))
    return values, random.uniform(1, 5)


def oblique(random):
    values = ball(random)
    offset = 0.2 * (values["source.radius"] + values["destination.radius"]) * random.uniform(-1, 1, size=2)
    values["source.center"] = above(values, offset, random.uniform(0.05, 1.0))
    return {**values, **dashpot(random, values, 0.01, 0.3)}, random.uniform(0.8, 2)


def hollow(random, gap):
    """A ball 20 to 80 degrees off the bottom of a level cylinder, moving along it"""
    radius, mass = random.uniform(0.3, 1.0), 10 ** random.uniform(-1, 1)
    small = radius * random.uniform(0.05, 0.3)
    axis = perpendicular(np.array([0.0, 0.0, 1.0]), random)
    side, angle = np.cross(axis, [0.0, 0.0, 1.0]), np.radians(random.uniform(20, 80))
    reach = radius - small - gap * radius
    values = {
        "source.radius": small,
        "source.mass": mass,
        "source.center": (reach * (np.sin(angle) * side - [0.0, 0.0, np.cos(angle)])).tolist(),
        "source.initial_velocity": (random.uniform(-0.5, 0.5) * axis).tolist(),
        "destination.radius": radius,
        "destination.axis": (axis * random.uniform(0.5, 2)).tolist(),
        "contact.penalty_factor": 10 ** random.uniform(5, 7),
    }
    return {**values, **dashpot(random, values, 0.02, 0.3)}


def touching(random):
    values = hollow(random, 0.0)
    depth = 1e-12 * values["destination.radius"]  # rounding decides nothing about the start
    outward = np.array(values["source.center"]) / np.linalg.norm(values["source.center"])
    values["source.initial_displacement"] = (depth * outward).tolist()
    return values, random.uniform(0.5, 1)


def bouncing(random):
    return hollow(random, random.uniform(0.005, 0.05)), random.uniform(0.5, 1)
