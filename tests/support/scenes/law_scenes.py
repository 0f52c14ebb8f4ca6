"""Random scenes of planes, of Hertz's law and of restitution: both laws, all dashpots, spheres and cylinders
from outside and inside, one body fixed, free or prescribed."""

import mpmath
import numpy as np

from support.checks import DASHPOTS
from support.reference.law import ReferenceContact, rising_root
from support.scenes.random_scenes import perpendicular, unit_vector

GEOMETRIES = ("plane", "sphere outside", "sphere inside", "cylinder outside", "cylinder inside")
MOTIONS = (("free", "fixed"), ("free", "free"), ("free", "prescribed"), ("prescribed", "free"))
FMU = {"plane": "SpherePlane", "sphere": "SphereSphere", "cylinder": "SphereCylinder"}
LEAST = {"linear": 1e-6, "hertz": 1e-3}  # smaller coefficients of restitution count as this
TURNS = (15.0, 60.0, 200.0)  # radians of the contact's oscillation in a scene, about


def by_hertz(stiffness, chi):
    """Returns the factors of a scene with Hertz's law."""
    values = {"contact.law": "hertz", "contact.method": "penalty_dynamic"}
    values |= {"contact.hertz_stiffness": stiffness, "contact.viscous_control": "user_defined"}
    values |= {"contact.hunt_crossley_factor": chi}
    return values


def law(draw, seed, mass, speed):
    """Returns the law's choices, with factors that make an impact a micrometre to some millimetres deep."""
    deepest = 10.0 ** draw.uniform(-5.5, -2.5)
    which = "linear" if seed % 4 == 0 else "hertz"  # the linear law has families of its own
    power = 2.0 if which == "linear" else 2.5
    stiffness = 0.5 * power * mass * speed**2 / deepest**power
    dashpot = DASHPOTS[seed % 3]
    least = 0.3 if dashpot == "approach_only" else 0.05  # with less the reference's steps are too short
    by_restitution = which == "linear" or draw.random() < 0.6
    values = {
        "contact.law": which,
        "contact.method": "penalty" if seed % 11 == 10 else "penalty_dynamic",
        "contact.dashpot": dashpot,
        "contact.viscous_control": "restitution" if by_restitution else "user_defined",
        "contact.restitution": draw.choice([draw.uniform(least, 1.0), draw.uniform(0.3, 0.95), 1.0, least]),
        "contact.penalty_factor" if which == "linear" else "contact.hertz_stiffness": stiffness,
    }  # fmt: skip
    if which == "hertz":
        values["contact.hunt_crossley_factor"] = draw.choice([0.05, 0.3, 1.0, 4.0]) / speed
    return values, deepest


def place(draw, geometry):
    """Returns radii, the destination's outward normal, its axis, and the centres' distance at the touch."""
    radius, other = draw.uniform(0.05, 0.2), draw.uniform(0.4, 0.8)
    shape, _, side = geometry.partition(" ")
    axis = unit_vector(draw) if shape == "cylinder" else None
    outward = perpendicular(axis, draw) if shape == "cylinder" else unit_vector(draw)
    reach = radius if shape == "plane" else other - radius if side == "inside" else other + radius
    return shape, side == "inside", radius, other, axis, outward, reach


def law_scene(seed):
    """FMU, values and end. "<input>.derivatives" as in checks.start."""
    draw = np.random.default_rng([seed, 14])
    shape, inside, radius, other, axis, outward, reach = place(draw, GEOMETRIES[seed % 5])
    motions = MOTIONS[seed // 5 % 4]
    masses = [draw.uniform(0.3, 3.0), draw.uniform(0.3, 3.0)]
    reduced = 1 / sum(1 / m for m, kind in zip(masses, motions, strict=True) if kind == "free")
    speed = 10.0 ** draw.uniform(-0.5, 0.7)
    contact, deepest = law(draw, seed, reduced, speed)
    away = -1.0 if inside else 1.0  # along `outward`, in which the gap opens
    gap = draw.choice([1.0, 0.0]) * 0.03 * speed
    gap = gap or -draw.uniform(0.0, 0.5) * deepest
    values = {
        "source.radius": radius, "source.mass": masses[0], "source.motion": motions[0],
        "destination.motion": motions[1], "destination.center": draw.normal(size=3).tolist(),
        "gravity": (9.81 * (-away * outward + draw.choice([0.0, 0.5, 2.0]) * unit_vector(draw))).tolist(),
        **contact,
    }  # fmt: skip
    grazes = seed % 7 == 6 and shape != "plane" and not inside
    if shape != "plane":
        values |= {"destination.radius": other, "contact.location": "inside" if inside else "outside"}
    if shape != "sphere":
        values["destination.axis"] = (outward if axis is None else axis).tolist()
    if shape != "plane" or motions[1] == "free":
        values["destination.mass"] = masses[1]
    start = (reach + away * gap) * outward + (0.0 if axis is None else draw.uniform(-0.2, 0.2)) * (
        0.0 if axis is None else axis
    )
    values["source.center"] = (start + values["destination.center"]).tolist()
    push = -away * speed * outward + 0.4 * speed * draw.normal(size=3)
    if grazes:  # past the side, by some of the depth that it would have head-on
        push = speed * perpendicular(outward if axis is None else axis, draw)
        across = np.cross(push, outward if axis is None else axis)
        start = (reach - 0.1 * deepest) * across / np.linalg.norm(across) - 0.03 * push
        values |= {"source.center": (start + values["destination.center"]).tolist(), "gravity": [0.0] * 3}
    share = draw.uniform(0.0, 1.0) if motions[1] == "free" else 1.0 if motions[0] == "free" else 0.0
    for body, part in (("source", share), ("destination", share - 1.0)):
        kind = values[f"{body}.motion"]
        if kind == "free":
            values[f"{body}.initial_velocity"] = (part * push).tolist()
        elif kind == "prescribed":
            rate, bend = 0.2 * draw.normal(size=3), 0.5 * draw.normal(size=3)
            values[f"{body}.prescribed_velocity"] = rate.tolist()
            values[f"{body}.prescribed_displacement.derivatives"] = [rate.tolist(), bend.tolist()]
            values[f"{body}.prescribed_velocity.derivatives"] = [bend.tolist()]
    turns = speed / deepest  # rad/s of an impact, about
    flight, stays = max(gap, 0.0) / speed, 100.0 / turns  # the reference follows a contact turn by turn
    end = min(0.3, draw.choice(TURNS) / turns + 1.2 * flight + min(0.8 * flight, stays))
    past = 0.03 + min(0.03, stays)
    return FMU[shape], values, past if grazes else end


def hunt_crossley(values):
    """chi v by the closed forms of VALIDATION, in 30 digits"""
    e = mpmath.mpf(max(values["contact.restitution"], LEAST["hertz"]))
    if e == 1:
        return 0.0
    if values["contact.dashpot"] == "approach_only":
        return float(rising_root(lambda y: e**2 - 2 * (y - mpmath.log(1 + y)) / y**2, 1e-9, 2 / e**2))
    return float(rising_root(lambda y: mpmath.log((1 + y) / (1 - e * y)) / y - 1 - e, 1e-9, (1 - 1e-12) / e))


def factors(fmu, values):
    """Returns stiffness, damping factor, and chi v where that follows from the restitution."""
    shape = next(name for name, known in FMU.items() if known == fmu)
    elastic = values["contact.method"] == "penalty"
    restitution = values["contact.viscous_control"] == "restitution"
    if values["contact.law"] == "linear":
        least = max(values["contact.restitution"], LEAST["linear"])
        if values["contact.dashpot"] == "unclamped" and values["contact.restitution"] == 0.0:
            masses = [
                values[f"{b}.mass"] for b in ("source", "destination") if values[f"{b}.motion"] == "free"
            ]
            return values["contact.penalty_factor"], 2 * np.sqrt(
                values["contact.penalty_factor"] / sum(1 / m for m in masses)
            ), None  # fmt: skip
        plain = {k: v for k, v in values.items() if not k.endswith(".derivatives")}
        known = ReferenceContact(plain | {"contact.restitution": least}, shape)
        return known.penalty, known.viscous, None
    chi = 0.0 if elastic or restitution else values["contact.hunt_crossley_factor"]
    return (
        values["contact.hertz_stiffness"],
        chi,
        hunt_crossley(values) if restitution and not elastic else None,
    )
