"""200 random scenes that reach further than random_scenes.py: stiffness from 1e2 to 1e9 N/m, damping from
none to twice the critical one, far from the origin, pushed by growing forces, free destinations under fixed
and moved sources, bounce trains that settle into lasting contact, balls that slide along a stiff wall.

Their ends are in wide_references.json and overdamped_references.json, made by make_references.py.
"""

import numpy as np

from support.scenes.random_scenes import KINDS, random_scene

COUNT = 200
# The references were made of these shapes; further ones would change what a number stands for.
ALL_KINDS = [(shape, kind) for shape in ("sphere", "cylinder") for kind in KINDS[shape]]
FURTHER = [
    "as it is",
    "soft",
    "stiff",
    "overdamped",
    "undamped",
    "far away",
    "pushed",
    "source held",
    "settling",
    "sliding",
]


def particular(number):
    """What is done to scene `number`; each kind of random_scenes.py meets each of them."""
    return FURTHER[(number + number // len(ALL_KINDS)) % len(FURTHER)]


def wide_scene(number):
    """shape, configuration and end of scene `number`"""
    shape, kind = ALL_KINDS[number % len(ALL_KINDS)]
    values, end = random_scene(shape, kind, 1000 + number)
    random = np.random.default_rng([number, 3])
    further = particular(number)
    if further in CHANGES:
        values, end = CHANGES[further](random, dict(values), end)
    return shape, values, end


def critical(values):
    return 2 * np.sqrt(values["contact.penalty_factor"] * values["source.mass"])


def with_stiffness(values, stiffness, share):
    """The penalty factor, and the dashpot as a share of the critical one; where they count"""
    values["contact.penalty_factor"] = stiffness
    values["contact.viscous_penalty_factor"] = share * critical(values)
    if values.get("contact.penalty_control") == "viscous_only":
        values["contact.viscous_penalty_factor"] = share * 50.0
    return values


def soft(random, values, end):
    values = with_stiffness(values, 10 ** random.uniform(2, 3.5), random.uniform(0.02, 0.4))
    return {**values, "contact.penalty_multiplier": 1e-6}, end


def stiff(random, values, end):
    values = with_stiffness(values, 10 ** random.uniform(5, 9), random.uniform(0.005, 0.05))
    return {**values, "contact.penalty_multiplier": 1e-3, "contact.characteristic_time": 1e-6}, 0.7 * end


def overdamped(random, values, end):
    return with_stiffness(values, 10 ** random.uniform(3.5, 5), random.uniform(0.7, 2)), end


def undamped(random, values, end):
    if values.get("contact.penalty_control") == "viscous_only":
        del values["contact.penalty_control"]
    return {**values, "contact.method": "penalty", "contact.penalty_factor": 10 ** random.uniform(3, 7)}, end


def far_away(random, values, end):
    far = 10 ** random.uniform(0, 4) * random.normal(size=3)
    for body in ("source", "destination"):
        values[f"{body}.center"] = (np.array(values[f"{body}.center"]) + far).tolist()
    return values, end


def pushed(random, values, end):
    """Quadratic forces on whatever is free; a destination that is given speeds up."""
    for body in ("source", "destination"):
        if values.get(f"{body}.motion") == "free":
            values[f"{body}.external_force"] = (3 * random.normal(size=3)).tolist()
            values[f"{body}.external_force.derivatives"] = (10 * random.normal(size=(2, 3))).tolist()
    return values, end


def source_held(random, values, end):
    """The destination is the free body: it comes to a source that is fixed or prescribed."""
    if values["destination.motion"] != "fixed":
        return values, end
    speed = np.array(values["source.initial_velocity"])
    values.update(
        {
            "source.motion": ["fixed", "prescribed"][random.integers(2)],
            "destination.motion": "free",
            "destination.mass": values["source.mass"],
            "destination.initial_velocity": (-speed).tolist(),
            "gravity": (-np.array(values["gravity"])).tolist(),
        }
    )
    if values["source.motion"] == "prescribed":
        rate = (0.1 * random.normal(size=3)).tolist()
        values["source.prescribed_velocity"] = rate
        values["source.prescribed_displacement.derivatives"] = [rate]
    return values, end


def settling(random, values, end):
    """Little energy and a good dashpot: a bounce train that ends within the run"""
    values = with_stiffness(values, 10 ** random.uniform(4, 6.5), random.uniform(0.3, 0.8))
    slow = (0.1 * np.array(values["source.initial_velocity"])).tolist()
    return {**values, "source.initial_velocity": slow}, end


def sliding(random, values, end):
    """All but touching, with hardly any speed towards the wall; hollow bodies keep what slides along them"""
    values = with_stiffness(values, 10 ** random.uniform(5, 7.5), random.uniform(0.05, 0.5))
    away = np.subtract(values["source.center"], values["destination.center"])
    axis = np.array(values.get("destination.axis", [0.0, 0.0, 0.0]))
    along = (away @ axis) / max(axis @ axis, 1e-9) * axis
    radii = np.array([values["destination.radius"], values["source.radius"]])
    reach = radii @ [1, -1 if values["contact.location"] == "inside" else 1]
    outward = (away - along) / np.linalg.norm(away - along)
    gap = 1e-4 * reach * (-1 if values["contact.location"] == "inside" else 1)
    speed = np.array(values["source.initial_velocity"])
    values.update(
        {
            "source.center": (values["destination.center"] + along + (reach + gap) * outward).tolist(),
            "source.initial_displacement": [0.0, 0.0, 0.0],
            "source.initial_velocity": (speed - 0.99 * (speed @ outward) * outward).tolist(),
        }
    )
    return values, end


CHANGES = {
    "soft": soft,
    "stiff": stiff,
    "overdamped": overdamped,
    "undamped": undamped,
    "far away": far_away,
    "pushed": pushed,
    "source held": source_held,
    "settling": settling,
    "sliding": sliding,
}


OVERDAMPED = 26


def overdamped_scene(number):
    """shape, configuration and end; damped beyond critical, the ball creeps out of a stiff wall"""
    shape, values, end = wide_scene(number)
    random = np.random.default_rng([number, 4])
    share = [1.5, 10.0, 3.0][number % 3]
    values = with_stiffness(dict(values), 10 ** random.uniform(5.5, 7), share)
    for choice in ("penalty_control", "viscous_control", "method"):
        values.pop(f"contact.{choice}", None)
    return shape, values, 0.7 * end
