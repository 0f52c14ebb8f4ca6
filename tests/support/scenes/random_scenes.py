"""Seeded random scenes with motion, for all shapes: for comparison with reference/integrator.py."""

import math

import numpy as np

from support.checks import DASHPOTS

KINDS = {
    "sphere": ["outside", "inside", "both free", "moving destination", "driven by a force", "viscous only"],
    "cylinder": ["outside", "inside", "both free", "moving destination", "finite, leaving",
        "finite, entering", "viscous only"],
    "plane": ["outside", "both free", "moving destination", "driven by a force", "viscous only"],
}  # fmt: skip
SEEDS = [0, 1, 2]
# Out of 2000 scenes: the dashpot switches where the gap rate is 0; a rounded sign may take the wrong branch.
DELICATE = [("sphere", "viscous only", seed) for seed in (14, 47, 75, 89, 129, 161)]
DELICATE.append(("cylinder", "inside", 130))
SCENES = [(shape, kind, seed) for shape, kinds in KINDS.items() for kind in kinds for seed in SEEDS]
SCENES += DELICATE


def unit_vector(random):
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction)


def perpendicular(direction, random):
    across = np.cross(direction, unit_vector(random))
    return across / np.linalg.norm(across)


def random_scene(shape, kind, seed):
    """Configuration and end. Names as FMI variables; "<input>.derivatives" as in checks.start."""
    kinds = [name for names in KINDS.values() for name in names]
    random = np.random.default_rng([seed, kinds.index(kind), len(shape)])
    tube = kind == "viscous only" and shape == "cylinder"
    inside = tube or kind in ("inside", "finite, leaving", "finite, entering")
    radius = random.uniform(0.3, 0.6)
    small = radius * random.uniform(0.1, 0.4)
    axis = unit_vector(random) if shape == "cylinder" else None
    outward = perpendicular(axis, random) if shape == "cylinder" else unit_vector(random)
    if shape == "plane":
        axis = outward
    gap = random.uniform(0.02, 0.1) * radius
    distance = radius - small - gap if inside else radius + small + gap
    if shape == "plane":
        distance = small + gap
    stiffness = 10 ** random.uniform(3.5, 5)
    mass = random.uniform(0.2, 2)
    damping = 2 * np.sqrt(stiffness * mass) * random.uniform(0.02, 0.3)
    center = distance * outward
    side = 1.0 if inside else -1.0  # where contact is, seen from the source
    gravity = 9.81 * (side * outward + 0.5 * unit_vector(random))
    values = {
        "source.motion": "free", "destination.motion": "fixed", "source.radius": small,
        "destination.radius": radius, "source.mass": mass,
        "source.initial_displacement": (0.01 * gap * random.normal(size=3)).tolist(),
        "source.initial_velocity": (side * random.uniform(0.5,
            2) * outward + 0.3 * random.normal(size=3)).tolist(),
        "destination.center": random.normal(size=3).tolist(),
        "contact.location": "inside" if inside else "outside", "contact.method": "penalty_dynamic",
        "contact.penalty_factor": stiffness, "contact.viscous_penalty_factor": damping,
        "contact.dashpot": DASHPOTS[random.integers(3)], "gravity": gravity.tolist(),
    }  # fmt: skip
    if axis is not None:
        values["destination.axis"] = (axis * random.uniform(0.5, 2)).tolist()
        if shape == "cylinder":
            center = center + random.uniform(-0.1, 0.1) * axis
    if shape == "plane":  # anywhere over it
        center = center + random.uniform(-5, 5) * perpendicular(axis, random)
        for name in ("destination.radius", "contact.location"):
            del values[name]
    values["source.center"] = (center + values["destination.center"]).tolist()
    values.update(particulars(kind, random, values, outward, side, axis))
    return values, random.uniform(0.8, 1.5)


def particulars(kind, random, values, outward, side, axis):
    """Returns what makes the kind of scene what it is."""
    if kind == "both free":
        return {
            "destination.motion": "free", "destination.mass": random.uniform(0.5, 5),
            "destination.initial_velocity": (-side * outward + 0.2 * random.normal(size=3)).tolist(),
            "source.external_force": (20 * side * outward + random.normal(size=3)).tolist(),
            "destination.external_force": (-20 * side * outward + random.normal(size=3)).tolist(),
            "contact.penalty_control": "automatic", "contact.penalty_multiplier": 1e-5,
            "contact.viscous_control": "automatic",
            "contact.characteristic_time": 10 ** random.uniform(-4, -3),
        }  # fmt: skip
    if kind == "moving destination":
        rate = (-side * 0.5 * outward + 0.3 * random.normal(size=3)).tolist()
        acceleration = (0.5 * random.normal(size=3)).tolist()
        found = {"destination.motion": "prescribed", "destination.prescribed_velocity": rate}
        found |= {"destination.prescribed_displacement.derivatives": [rate, acceleration]}
        found |= {"destination.prescribed_velocity.derivatives": [acceleration]}
        return found
    if kind == "driven by a force":
        return {
            "source.external_force": (5 * side * outward + random.normal(size=3)).tolist(),
            "source.external_force.derivatives": (10 * random.normal(size=(2, 3))).tolist(),
        }
    if kind == "viscous only":
        return {
            "contact.penalty_control": "viscous_only",
            "contact.viscous_penalty_factor": 10 ** random.uniform(1, 2),
        }
    if kind.startswith("finite"):
        leaving = kind == "finite, leaving"
        speed = random.uniform(0.5, 1.5) * axis
        length = random.uniform(0.5, 1.0)
        start = np.array(values["destination.center"]) + outward * np.linalg.norm(side_offset(values, axis))
        shift = (0.2 if leaving else -0.6) * length
        return {
            "destination.finite_length": True,
            "destination.length": length,
            "source.center": (start + shift * axis).tolist(),
            "source.initial_velocity": (speed + 0.3 * side * outward).tolist(),
            "gravity": (np.array(values["gravity"]) * (1.0 if leaving else 0.1)).tolist(),
        }
    return {}


def side_offset(values, axis):
    """Returns the part across the axis of the source's place as seen from the destination."""
    away = np.subtract(values["source.center"], values["destination.center"])
    return away - np.dot(away, axis) * axis


# Families of random scenes are put together from the parts that follow.

NOTHING = [0.0, 0.0, 0.0]


def chosen(random, items):
    return items[random.integers(len(items))]


def even(end, steps):
    return tuple(end * (k + 1) / steps for k in range(steps))


def uneven(end, random):
    """Returns one to four communication points, the last one `end`."""
    inner = random.uniform(0.05, 0.95, random.integers(4)) * end
    return (*sorted(float(t) for t in inner), end)


def pair(random, shape, inside, gap, **more):
    """Round a hollow or a solid body of 0.3 to 0.6 m, the source `gap` off its surface, a metre off the
    origin; and the direction from the destination to the source."""
    radius = random.uniform(0.3, 0.6)
    small = radius * random.uniform(0.1, 0.4)
    axis = unit_vector(random)
    outward = perpendicular(axis, random)
    distance = radius - small - gap if inside else radius + small + gap
    center = random.normal(size=3)
    values = {
        "source.motion": "free", "destination.motion": "fixed", "source.radius": small,
        "destination.radius": radius, "source.mass": random.uniform(0.2, 2),
        "destination.center": center.tolist(),
        "source.center": (center + distance * outward).tolist(),
        "contact.location": "inside" if inside else "outside", "contact.method": "penalty_dynamic",
        "contact.dashpot": chosen(random, DASHPOTS), "gravity": NOTHING,
    }  # fmt: skip
    if shape == "cylinder":
        values["destination.axis"] = (axis * random.uniform(0.5, 2)).tolist()
    return values | more, outward


def factors(stiffness, ratio, mass):
    """Returns p_n, and p_nv at `ratio` of critical damping."""
    return {
        "contact.penalty_factor": stiffness,
        "contact.viscous_penalty_factor": 2 * ratio * math.sqrt(stiffness * mass),
    }


def moved_by(body, velocity, acceleration=NOTHING):
    """Inputs of a prescribed body that agree with each other."""
    velocity, acceleration = list(map(float, velocity)), list(map(float, acceleration))
    values = {f"{body}.motion": "prescribed", f"{body}.prescribed_velocity": velocity}
    values |= {f"{body}.prescribed_velocity.derivatives": [acceleration]}
    values |= {f"{body}.prescribed_displacement.derivatives": [velocity, acceleration]}
    return values


def rates(stiffness, ratio, mass):
    """Of decay: the slower and the faster one, 1/s; below critical damping the same twice."""
    root = math.sqrt(stiffness / mass)
    spread = math.sqrt(max(ratio**2 - 1, 0.0))
    return root / (ratio + spread), root * (ratio + spread)


def touching_values(one):
    """Returns start values of a scene's own description: centre, speed, law and friction of its pair."""
    values = {"source.center": one.place, "source.initial_velocity": one.velocity}
    values |= {"destination.center": NOTHING, "destination.motion": "free" if one.both else "fixed"}
    values |= {"contact.location": "inside" if one.inside else "outside"}
    values |= {"contact.penalty_factor": one.stiffness, "contact.viscous_penalty_factor": one.damping}
    values |= {"contact.friction": "regularized" if one.friction else "none"}
    values |= {"contact.friction_coefficient": one.friction, "contact.slip_velocity_control": "user_defined"}
    values |= {"contact.characteristic_slip_velocity": one.slip}
    return values
