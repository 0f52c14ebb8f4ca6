"""Scenes of contacts by Hertz's law: the benchmarks with it in place of the penalty, and random ones."""

import numpy as np

from support.reference import hertz
from support.scenes.benchmarks import BENCHMARKS

FMU = {"sphere": "SphereSphere", "cylinder": "SphereCylinder"}
# k_h [N/m^1.5] and chi [s/m]
FACTORS = {"P1": (1e8, 0.0), "P2": (1e8, 0.1), "P3": (1e7, 5.0), "P3b": (1e7, 0.5)}
DASHPOTS = ("non_adhesive", "unclamped", "approach_only")
SEEDS = range(18)


def law(stiffness, chi):
    return {
        "contact.law": "hertz",
        "contact.method": "penalty_dynamic",
        "contact.hertz_stiffness": stiffness,
        "contact.viscous_control": "user_defined",
        "contact.hunt_crossley_factor": chi,
    }


def benchmark(name):
    """FMU, values and end of a benchmark with Hertz's law."""
    problem = BENCHMARKS[name]
    return problem.fmu, {**problem.configuration, **law(*FACTORS[name])}, problem.end


def random_hertz_scene(seed):
    """Two bodies that meet obliquely: outside and inside of spheres and cylinders, one or both free, all
    dashpots, with gravity."""
    draw = np.random.default_rng(seed)
    shape = ("sphere", "cylinder")[seed % 2]
    inside = seed % 6 in (2, 3)
    radius, other = draw.uniform(0.05, 0.2), draw.uniform(0.4, 0.8)
    direction = draw.normal(size=3)
    axis = np.array([0.6, 0.0, 0.8]) if shape == "cylinder" else None
    if axis is not None:
        direction -= (direction @ axis) * axis
    direction /= np.linalg.norm(direction)
    reach = other - radius if inside else other + radius
    side = -1 if inside else 1
    speed = 10.0 ** draw.uniform(-1.0, 1.0)
    start = direction * (reach + side * 0.02 * speed)
    sideways = draw.normal(size=3) * 0.5 * speed
    stiffness = 10.0 ** draw.uniform(5.0, 9.0)
    both = seed % 3 == 0
    values = {
        "source.radius": radius,
        "destination.radius": other,
        "source.mass": draw.uniform(0.3, 3.0),
        "destination.mass": draw.uniform(0.3, 3.0),
        "source.motion": "free",
        "destination.motion": "free" if both else "fixed",
        "source.center": start.tolist(),
        "source.initial_velocity": (-side * speed * direction + sideways).tolist(),
        "contact.location": "inside" if inside else "outside",
        "contact.dashpot": DASHPOTS[seed // 2 % 3],
        **law(stiffness, draw.choice([0.0, 0.3, 1.0]) / speed),
    }
    if axis is not None:
        values["destination.axis"] = axis.tolist()
    return FMU[shape], values, 0.06


def pair_of(values):
    """The same for the reference: the pair and its state at the start."""
    inside = values.get("contact.location") == "inside"
    ball, other = (np.longdouble(values[f"{body}.radius"]) for body in ("source", "destination"))
    axis = values.get("destination.axis")
    if axis is not None:
        axis = np.array(axis, np.longdouble)
        axis = axis / np.sqrt(axis @ axis)
    free = values["destination.motion"] == "free"
    pair = hertz.HertzPair(
        values["contact.hertz_stiffness"],
        values["contact.hunt_crossley_factor"],
        values.get("contact.dashpot", "non_adhesive"),
        other - ball if inside else other + ball,
        -1 if inside else 1,
        (values["source.mass"], values["destination.mass"] if free else np.inf),
        (0.0, 0.0, -9.81),
        axis,
    )
    still = [0.0, 0.0, 0.0]
    return pair, [*values["source.center"], *still, *values.get("source.initial_velocity", still), *still]
