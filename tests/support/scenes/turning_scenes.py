"""Seeded random scenes of bodies that turn and rub: shapes, laws, friction, rotation, and all motions."""

import math
from typing import NamedTuple

import numpy as np

from support.checks import DASHPOTS
from support.scenes.random_scenes import chosen, moved_by, perpendicular, unit_vector

PLACES = (("sphere", False), ("cylinder", False), ("plane", False), ("sphere", True), ("cylinder", True))
FRICTIONS = ("regularized", "elastic", "regularized", "elastic with dashpot", "elastic, static", "none")


class TurningScene(NamedTuple):
    shape: str
    values: dict
    end: float
    steps: int  # of communication


def random_turning_scene(seed):
    """A ball is a little off the surface, on its way to it, askew and spinning."""
    random = np.random.default_rng([15, seed])
    shape, inside = PLACES[seed % len(PLACES)]
    friction = FRICTIONS[seed // len(PLACES) % len(FRICTIONS)]
    outward, values = place(random, shape, inside)
    side = 1.0 if inside else -1.0
    values |= motions(random, shape, side * outward, random.uniform(0.5, 2.0))
    values |= rotations(random, shape, values)
    values |= normal_law(random, values["source.mass"])
    values |= friction_law(random, friction, values)
    prescribed = any(
        values.get(f"{body}.{what}") == "prescribed"
        for body in ("source", "destination")
        for what in ("motion", "rotation")
    )
    steps = 1 if prescribed else int(random.integers(1, 4))
    end = float(random.uniform(0.1, 0.3))
    return TurningScene(shape, values | following(random, seed, values), end, steps)


def driven_scene(seed):
    """The source flies a parabola that dips some millimetres into the destination; both turn steadily."""
    random = np.random.default_rng([16, seed])
    shape, inside = PLACES[seed % len(PLACES)]
    outward, values = place(random, shape, inside)
    towards = (1.0 if inside else -1.0) * outward
    across = np.cross(towards, random.normal(size=3))
    speed, depth = random.uniform(0.5, 2.0), random.uniform(1e-3, 4e-3)
    gap = 0.05  # at most (turning_scenes.place): it dips in by `depth` more than that leaves
    back = speed**2 / (2.0 * (gap + depth))
    values |= moved_by("source", speed * towards + 0.1 * across, -back * towards)
    values |= {"source.rotation": "prescribed", "destination.rotation": "prescribed"}
    values["source.prescribed_angular_velocity"] = (10.0 * random.normal(size=3)).tolist()
    values["destination.prescribed_angular_velocity"] = (0.5 * random.normal(size=3)).tolist()
    if shape != "sphere":
        values["destination.prescribed_axis"] = values["destination.axis"]
    values |= normal_law(random, values["source.mass"])
    values |= friction_law(random, FRICTIONS[seed // len(PLACES) % len(FRICTIONS)], values)
    steps = int(random.integers(1, 4))
    return shape, values | following(random, seed, values), 2.2 * speed / back, steps


def place(random, shape, inside):
    radius = random.uniform(0.3, 0.6)
    small = radius * random.uniform(0.2, 0.5)
    axis = unit_vector(random)
    outward = axis if shape == "plane" else unit_vector(random)
    if shape == "cylinder":
        outward = perpendicular(axis, random)
    gap = random.uniform(0.005, 0.05)
    distance = small + gap if shape == "plane" else radius - small - gap if inside else radius + small + gap
    middle = random.normal(size=3)
    values = {
        "source.radius": small,
        "source.mass": random.uniform(0.5, 2.0),
        "source.center": (middle + distance * outward).tolist(),
        "destination.center": middle.tolist(),
        "gravity": (9.81 * unit_vector(random)).tolist(),
    }
    if shape != "plane":
        values |= {"destination.radius": radius, "contact.location": "inside" if inside else "outside"}
    if shape != "sphere":
        values["destination.axis"] = (axis * random.uniform(0.5, 2)).tolist()
    return outward, values


def motions(random, shape, towards, speed):
    """Both bodies' motions; the speed is that of approach."""
    velocity = speed * towards + 0.5 * random.normal(size=3)
    found = {"source.motion": "free", "source.initial_velocity": velocity.tolist()}
    kind = chosen(random, ["fixed", "fixed", "prescribed", "free"])
    if kind == "prescribed":
        return found | moved_by("destination", 0.3 * random.normal(size=3), 0.5 * random.normal(size=3))
    if kind == "free":
        found |= {
            "destination.mass": random.uniform(1.0, 5.0),
            "destination.initial_velocity": (0.2 * random.normal(size=3)).tolist(),
            "destination.external_force": random.normal(size=3).tolist(),
        }
    return found | {"destination.motion": kind}


def rotations(random, shape, values):
    found = {}
    for body in ("source", "destination"):
        kinds = ["free", "free", "prescribed", "none"] if body == "source" else ["none", "prescribed", "free"]
        if shape == "plane" and body == "destination":
            kinds.remove("free")
        kind = chosen(random, kinds)
        spin = (10.0 if body == "source" else 2.0) * random.normal(size=3)
        found[f"{body}.rotation"] = kind
        if kind == "prescribed":
            found[f"{body}.prescribed_angular_velocity"] = spin.tolist()
            if body == "destination" and shape != "sphere":
                found["destination.prescribed_axis"] = values["destination.axis"]
        if kind == "free":
            found[f"{body}.initial_angular_velocity"] = spin.tolist()
            found[f"{body}.external_torque"] = (0.01 * random.normal(size=3)).tolist()
            found |= inertia(random, body, shape, values)
    return found


def inertia(random, body, shape, values):
    """Automatic for spheres, mostly; an infinite cylinder has none of its own."""
    cylinder = body == "destination" and shape == "cylinder"
    if not cylinder and random.random() < 0.7:
        return {}
    reach = values["destination.radius" if body == "destination" else "source.radius"]
    along = random.uniform(0.2, 0.6) * values.get(f"{body}.mass", 1.0) * reach**2
    found = {f"{body}.inertia_control": "user_defined", f"{body}.axial_inertia": along}
    if cylinder:  # 2 I_1 >= I_3
        found["destination.transverse_inertia"] = random.uniform(0.6, 4.0) * along
    return found


def normal_law(random, mass):
    if random.random() < 0.35:
        values = {"contact.law": "hertz", "contact.hertz_stiffness": 10 ** random.uniform(5, 7)}
        values |= {"contact.method": "penalty_dynamic", "contact.viscous_control": "user_defined"}
        values |= {"contact.hunt_crossley_factor": float(chosen(random, [0.0, 0.2, 0.8]))}
        values |= {"contact.dashpot": chosen(random, DASHPOTS)}
        return values
    stiffness = 10 ** random.uniform(3.5, 5.5)
    found = {"contact.law": "linear"}
    found |= {"contact.method": chosen(random, ["penalty", "penalty_dynamic", "penalty_dynamic"])}
    found |= {"contact.penalty_factor": stiffness}
    found |= {"contact.viscous_penalty_factor": 2 * math.sqrt(stiffness * mass) * random.uniform(0.02, 0.4)}
    found |= {"contact.dashpot": chosen(random, DASHPOTS)}
    return found


def friction_law(random, friction, values):
    found = {"contact.friction": friction.split(",")[0].split(" ")[0]}
    if friction == "none":
        return found
    mu = random.uniform(0.05, 0.8)
    more = 1.5 if "static" in friction else 1.0
    found |= {"contact.friction_coefficient": mu, "contact.static_friction_coefficient": more * mu}
    stiffness = values.get("contact.penalty_factor", 1e5)
    if random.random() < 0.2:  # of about the largest normal force
        found["contact.maximum_friction_force"] = 0.3 * mu * math.sqrt(stiffness * values["source.mass"])
    if friction == "regularized":
        return found | {
            "contact.slip_velocity_control": "user_defined",
            "contact.characteristic_slip_velocity": 10 ** random.uniform(-2.5, -1),
        }
    k_t = stiffness * random.uniform(0.2, 0.9)
    damping = 2 * math.sqrt(k_t * values["source.mass"]) * random.uniform(0.02, 0.3)
    return found | {
        "contact.tangential_stiffness": k_t,
        "contact.tangential_damping": damping if "dashpot" in friction else 0.0,
    }


def following(random, seed, values):
    """A tangential stiffness follows Hertz's, in every other scene that may have it."""
    elastic = values["contact.friction"] == "elastic" and values["contact.law"] == "hertz"
    ratio = random.uniform(0.2, 1.2)
    if not elastic or seed % 2:
        return {}
    return {"contact.tangential_law": "mindlin", "contact.tangential_ratio": ratio}


def any_resistance(random, contact, torque):
    """Either law or none against each motion of a contact whose torques are of this size [N m]."""
    found = {}
    for kind in ("rolling", "spinning"):
        found |= {f"{contact}.{kind}": chosen(random, ["none", "regularized", "elastic", "elastic"])}
        found |= {f"{contact}.{kind}_coefficient": chosen(random, [0.0, 0.05, 0.5])}
        found |= {f"{contact}.characteristic_{kind}_rate": 0.1}
        found |= {f"{contact}.{kind}_stiffness": torque * chosen(random, [1.0, 10.0])}
        found |= {f"{contact}.{kind}_damping": torque * chosen(random, [0.0, 0.01])}
    return found


def resistance(random, law="regularized"):
    """Against rolling, against spinning, or both; elastic with a dashpot or without"""
    kinds = chosen(random, [("rolling",), ("spinning",), ("rolling", "spinning")])
    found = {}
    for kind in kinds:
        found |= {f"contact.{kind}": law, f"contact.{kind}_coefficient": 10 ** random.uniform(-2, 0)}
        if law == "regularized":
            found[f"contact.characteristic_{kind}_rate"] = 10 ** random.uniform(-1, 0.5)
        else:  # periods and angles of about those of an impact
            found[f"contact.{kind}_stiffness"] = 10 ** random.uniform(1, 3)
            found[f"contact.{kind}_damping"] = chosen(random, [0.0, 10 ** random.uniform(-2, 0)])
    return found


# Seeded random scenes of a ball that slides, rolls, spins and bounces on a plane with no load along it.


def random_plane_scene(seed):
    """A ball is a little above a slanted plane on its way down, or overlaps it, at times without friction."""
    random = np.random.default_rng([25, seed])
    axis, mass = unit_vector(random), random.uniform(0.5, 2.0)
    values = ball(random, axis, mass) | plane(random, axis)
    values |= law(random, 1.0 / (1.0 / mass + 1.0 / values.get("destination.mass", math.inf)))
    if values["destination.motion"] == "fixed" and random.random() < 0.3:
        values["source.external_force"] = (random.uniform(-0.9, 2.0) * 9.81 * mass * axis).tolist()
    values["contact.friction"] = chosen(random, ["regularized"] * 6 + ["none"])
    if values["contact.friction"] == "regularized":
        mu = random.uniform(0.05, 0.8)
        values |= {"contact.friction_coefficient": mu, "contact.static_friction_coefficient": mu}
        values |= {"contact.slip_velocity_control": "user_defined"}
        values |= {"contact.characteristic_slip_velocity": 10 ** random.uniform(-4, 0)}
    steps = int(chosen(random, [1, 1, 2, 3, 7, 31]))
    return TurningScene("plane", values, float(random.uniform(0.05, 0.3)), steps)


def ball(random, axis, mass):
    """Its spin is in the plane of its motion or in any direction."""
    along = np.cross(axis, unit_vector(random))
    along /= np.linalg.norm(along)
    radius, fast = random.uniform(0.05, 0.3), 10 ** random.uniform(-1, 1)
    gap = float(chosen(random, [-1e-3, random.uniform(1e-3, 2e-2)]))
    found = {
        "source.radius": radius, "source.mass": mass, "source.motion": "free",
        "source.center": ((radius + gap) * axis + random.normal() * along).tolist(),
        "source.initial_velocity": (-random.uniform(0.2, 2.0) * axis + fast * along).tolist(),
        "source.rotation": chosen(random, ["free", "free", "free", "none"]),
    }  # fmt: skip
    if found["source.rotation"] == "none":
        return found
    spin = np.cross(axis, along) if random.integers(3) == 0 else random.normal(size=3)
    found["source.initial_angular_velocity"] = (fast / radius * random.uniform(-2, 2) * spin).tolist()
    if random.random() < 0.3:
        inertia = random.uniform(0.2, 0.6) * mass * radius**2
        found |= {"source.inertia_control": "user_defined", "source.axial_inertia": inertia}
    return found


def plane(random, axis):
    """Fixed, prescribed with an acceleration along its normal alone, or free to move."""
    gravity = float(chosen(random, [0.0, 9.81, 9.81]))
    found = {"destination.axis": axis.tolist(), "gravity": (-gravity * axis).tolist()}
    found |= {"destination.rotation": "none"}
    kind = chosen(random, ["fixed", "fixed", "prescribed", "free"])
    if kind == "prescribed":
        return found | moved_by("destination", 0.1 * random.normal(size=3), 0.3 * random.normal() * axis)
    if kind == "free":
        found |= {
            "destination.mass": random.uniform(1.0, 5.0),
            "destination.initial_velocity": (0.1 * random.normal(size=3)).tolist(),
        }
    return found | {"destination.motion": kind}


def law(random, mass):
    """Linear and below critical damping, or Hertz's with damping of Hunt and Crossley."""
    found = {"contact.dashpot": chosen(random, DASHPOTS), "contact.method": "penalty_dynamic"}
    if random.random() < 0.4:
        values = found | {"contact.law": "hertz", "contact.hertz_stiffness": 10 ** random.uniform(5, 7)}
        values |= {"contact.viscous_control": "user_defined"}
        values |= {"contact.hunt_crossley_factor": float(chosen(random, [0.0, 0.2, 0.8]))}
        return values
    stiffness = 10 ** random.uniform(3.5, 6.0)
    told = found | {"contact.method": chosen(random, ["penalty", "penalty_dynamic", "penalty_dynamic"])}
    told |= {"contact.penalty_factor": stiffness}
    told |= {"contact.viscous_penalty_factor": 2 * math.sqrt(stiffness * mass) * random.uniform(0.02, 0.9)}
    return told
