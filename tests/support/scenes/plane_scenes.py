"""Seeded random scenes of a ball that slides, rolls, spins and bounces on a plane with no load along it."""

import math

import numpy as np

from support.checks import DASHPOTS
from support.scenes.random_scenes import chosen, moved_by, unit_vector
from support.scenes.turning_scenes import TurningScene


def random_plane_scene(seed):
    """A ball a little above a slanted plane on its way down, or in an overlap; at times without friction."""
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
