"""Random configurations of a force element, both bodies moved by the importer"""

import numpy as np

from support.reference.law import Motion, vector
from support.scenes.random_scenes import unit_vector

SHAPES = {"SphereSphere": "sphere", "SphereCylinder": "cylinder", "SpherePlane": "plane"}
SHAPES |= {"ForceElement": "cylinder"}
INPUTS = [f"{b}.prescribed_{row}" for b in ("source", "destination") for row in ("displacement", "velocity")]


def random_separation(random, values, shape, inside):
    """x_dst - x_src with a gap of either sign; beyond a finite cylinder's ends now and then."""
    r_s = values["source.radius"]
    if shape == "plane":  # the centre on either side of the surface
        normal = np.array(values["destination.axis"]) / np.linalg.norm(values["destination.axis"])
        aside = np.cross(normal, r_s * 10 ** random.uniform(-2, 2) * unit_vector(random))
        return aside - r_s * random.choice([1 - 1e-3, 0.5, 1 + 1e-6, -0.3, 2.0]) * normal
    r_d = values["destination.radius"]
    small = min(r_s, r_d)
    gap = random.choice([-1, 1], p=[0.7, 0.3]) * small * 10 ** random.uniform(-6, -0.1)
    distance = max(r_d - r_s - gap, 0.01 * small) if inside else r_d + r_s + gap
    if shape == "sphere":
        return distance * unit_vector(random)
    axis = np.array(values["destination.axis"]) / np.linalg.norm(values["destination.axis"])
    across = np.cross(axis, unit_vector(random))
    along = random.uniform(-0.7, 0.7) * values["destination.length"]
    return distance * across / np.linalg.norm(across) + along * axis


def random_configuration(random, shape, scale=1.0, offset=0.0):
    """Makes every choice at random, with lengths of about `scale` and centres moved by about `offset`."""
    radii = scale * 10 ** random.uniform(-1.5, 0.5, size=2)
    location = str(random.choice(["automatic", "outside", "inside"]))
    inside = location == "inside" or (location == "automatic" and random.random() < 0.5)
    if inside:
        radii = np.sort(radii) * [1.0, 1.1]
    control = str(random.choice(["user_defined", "automatic", "viscous_only"]))
    values = {
        "source.motion": "prescribed", "destination.motion": "prescribed", "source.radius": radii[0],
        "destination.radius": radii[1], "contact.location": location, "contact.penalty_control": control,
        "contact.method": "penalty_dynamic"
        if control == "viscous_only"
        else str(random.choice(["penalty", "penalty_dynamic"])),
        "contact.viscous_control": str(random.choice(["automatic", "user_defined"])),
        "contact.dashpot": str(random.choice(["non_adhesive", "unclamped", "approach_only"])),
        "contact.penalty_multiplier": 10 ** random.uniform(-3, 1),
        "contact.penalty_factor": 10 ** random.uniform(2, 9),
        "contact.characteristic_time": 10 ** random.uniform(-6, -2),
        "contact.viscous_penalty_factor": 10 ** random.uniform(0, 5),
        "contact.reference_modulus": 10 ** random.uniform(5, 10),
    }  # fmt: skip
    if shape == "cylinder":
        values["destination.axis"] = (unit_vector(random) * 10 ** random.uniform(-3, 3)).tolist()
        values["destination.finite_length"] = bool(random.random() < 0.5)
        values["destination.length"] = scale * 10 ** random.uniform(-1, 1)
    if shape == "plane":
        values["destination.axis"] = (unit_vector(random) * 10 ** random.uniform(-3, 3)).tolist()
        for name in ("destination.radius", "contact.location"):
            del values[name]
        inside = False
    common = offset * random.uniform(-1, 1, size=3)
    source = common + scale * random.normal(size=3)
    values["source.center"] = source.tolist()
    values["destination.center"] = source.tolist()
    values.update(random_inputs(random, values, shape, inside, scale))
    # The centres take up what the displacements leave of the separation wanted.
    wanted = random_separation(random, values, shape, inside)
    shift = np.array(values["destination.prescribed_displacement"]) - values["source.prescribed_displacement"]
    values["destination.center"] = (source + (wanted - shift)).tolist()
    return values, inside


def random_inputs(random, values, shape, inside, scale):
    """Returns displacements and velocities that put the bodies to a random separation."""
    wanted = random_separation(random, values, shape, inside)
    apart = np.subtract(values["destination.center"], values["source.center"])
    source = scale * random.normal(size=3)
    return {
        "source.prescribed_displacement": source.tolist(),
        "destination.prescribed_displacement": (wanted - apart + source).tolist(),
        "source.prescribed_velocity": random.normal(size=3).tolist(),
        "destination.prescribed_velocity": (random.normal(size=3) * 10 ** random.uniform(-3, 1)).tolist(),
    }


def motion_of(inputs):
    return Motion(*(vector(inputs[name]) for name in INPUTS))
