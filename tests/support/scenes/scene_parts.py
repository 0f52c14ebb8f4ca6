"""What the families of random scenes are put together from."""

import math

from support.scenes.random_scenes import DASHPOTS, perpendicular, unit_vector

NOTHING = [0.0, 0.0, 0.0]


def chosen(random, items):
    return items[random.integers(len(items))]


def even(end, steps):
    return tuple(end * (k + 1) / steps for k in range(steps))


def uneven(end, random):
    """One to four communication points, the last one `end`."""
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
    """p_n, and p_nv at `ratio` of critical damping."""
    return {
        "contact.penalty_factor": stiffness,
        "contact.viscous_penalty_factor": 2 * ratio * math.sqrt(stiffness * mass),
    }


def moved_by(body, velocity, acceleration=NOTHING):
    """Inputs of a prescribed body that agree with each other."""
    velocity, acceleration = list(map(float, velocity)), list(map(float, acceleration))
    return {
        f"{body}.motion": "prescribed",
        f"{body}.prescribed_velocity": velocity,
        f"{body}.prescribed_velocity.derivatives": [acceleration],
        f"{body}.prescribed_displacement.derivatives": [velocity, acceleration],
    }


def rates(stiffness, ratio, mass):
    """Of decay: the slower and the faster one, 1/s; below critical damping the same twice."""
    root = math.sqrt(stiffness / mass)
    spread = math.sqrt(max(ratio**2 - 1, 0.0))
    return root / (ratio + spread), root * (ratio + spread)


def touching_values(one):
    """Start values of a scene's own description: centre, speed, law and friction of its pair."""
    return {
        "source.center": one.place, "source.initial_velocity": one.velocity, "destination.center": NOTHING,
        "destination.motion": "free" if one.both else "fixed",
        "contact.location": "inside" if one.inside else "outside", "contact.penalty_factor": one.stiffness,
        "contact.viscous_penalty_factor": one.damping,
        "contact.friction": "regularized" if one.friction else "none",
        "contact.friction_coefficient": one.friction, "contact.slip_velocity_control": "user_defined",
        "contact.characteristic_slip_velocity": one.slip,
    }  # fmt: skip
