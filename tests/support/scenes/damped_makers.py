"""Families of random scenes about loads from zero, inputs that contradict each other and contacts beyond
critical damping; as scene_makers.py."""

import math

import numpy as np

from support.scenes.random_scenes import unit_vector
from support.scenes.scene_parts import NOTHING, chosen, factors, pair, rates, uneven


def from_zero(random, shape):
    """A load or a given motion that begins at exactly zero, as a ramp or a parabola, on a contact at or
    beyond critical damping."""
    inside = bool(random.integers(2))
    gap = float(chosen(random, [0.0, -0.004, -0.01]) if random.random() < 0.7 else 1e-3)
    values, outward = pair(random, shape, inside, gap)
    stiffness = 10 ** random.uniform(2, 5)
    ratio = 10 ** random.uniform(-0.2, 1.2)
    values |= factors(stiffness, ratio, values["source.mass"])
    slow, fast = rates(stiffness, ratio, values["source.mass"])
    end = min(random.uniform(0.5, 20) / slow, 400 / fast, 1.0)
    towards = outward if inside else -outward
    push = towards + random.normal(size=3)
    size = values["source.mass"] * 0.02 / end**2  # so that it goes some centimetres
    if random.random() < 0.7:
        ramp, parabola = size / end * push, size / end**2 * random.normal(size=3)
        rows = [[ramp, NOTHING], [NOTHING, parabola], [ramp, parabola]][random.integers(3)]
        values["source.external_force.derivatives"] = [list(map(float, row)) for row in rows]
    else:
        led = -push * 0.02 / end**3
        rows = [[led * end, np.zeros(3)], [np.zeros(3), led]][random.integers(2)]
        values["destination.motion"] = "prescribed"
        values["destination.prescribed_velocity.derivatives"] = [row.tolist() for row in rows]
    return {"values": values, "stops": uneven(end, random)}


def contradictory(random, shape):
    """A prescribed displacement whose derivatives are not the prescribed velocity."""
    inside = bool(random.integers(2))
    values, outward = pair(random, shape, inside, random.uniform(-0.01, 0.05))
    towards = outward if inside else -outward
    stiffness = 10 ** random.uniform(3, 6)
    values |= factors(stiffness, chosen(random, [0.0, 0.1, 0.5, 1.5, 5.0]), values["source.mass"])
    end = 0.3
    velocity = 0.3 * towards + 0.2 * random.normal(size=3)
    rate = [NOTHING, velocity.tolist(), (-velocity).tolist()][random.integers(3)]
    bent = (random.normal(size=3)).tolist() if random.integers(2) else NOTHING
    if random.random() < 0.5:
        body, other = "source", 1.0
    else:
        body, other = "destination", -1.0
        values["source.initial_velocity"] = (0.3 * towards + 0.1 * random.normal(size=3)).tolist()
    values |= {
        f"{body}.motion": "prescribed",
        f"{body}.prescribed_velocity": (other * 0.3 * towards * random.integers(0, 2)).tolist(),
        f"{body}.prescribed_displacement.derivatives": [(other * np.array(rate)).tolist(), bent],
    }
    if shape == "cylinder" and random.integers(2):
        away = np.abs(
            np.dot(np.divide(values["destination.axis"], np.linalg.norm(values["destination.axis"])), rate)
        )
        values |= {"destination.finite_length": True, "destination.length": float(max(0.01, end * away))}
    # Energy is not kept where a body moves otherwise than at its velocity.
    return {"values": values, "stops": uneven(end, random), "leaves_open": frozenset({"total"})}


def approach_only(random, shape):
    """A lasting contact whose dashpot acts on approach only, at and beyond critical damping."""
    inside = random.random() < 0.7
    values, outward = pair(random, shape, inside, -1e-6 if inside else 0.0)
    towards = outward if inside else -outward
    stiffness, ratio = 10 ** random.uniform(3, 9.5), 10 ** random.uniform(0, 1)
    values |= factors(stiffness, ratio, values["source.mass"])
    fast = rates(stiffness, ratio, values["source.mass"])[1]
    end = float(min(1.0, 10 ** random.uniform(1.5, 3.3) / fast))
    values |= {
        "contact.dashpot": "approach_only",
        "gravity": (9.81 * (towards + chosen(random, [0.0, 0.3, 1.0]) * unit_vector(random))).tolist(),
        "source.initial_velocity": (0.2 * random.normal(size=3)).tolist(),
    }
    return {"values": values, "stops": uneven(end, random)}


def dying_away(random, shape):
    """An unloaded contact beyond critical damping with an unclamped dashpot: it never parts."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(4, 7), 1 + 10 ** random.uniform(-2, 0.7)
    values, _ = pair(random, shape, inside, 0.0)
    mass = values["source.mass"]
    slow = rates(stiffness, ratio, mass)[0]
    depth = 10 ** random.uniform(-8, -2)
    away = np.subtract(values["source.center"], values["destination.center"])
    away *= 1 + (depth if inside else -depth) / np.linalg.norm(away)
    center = np.add(values["destination.center"], away)
    end = float(10 ** random.uniform(0, 3)) / slow
    values |= factors(stiffness, ratio, mass)
    values |= {"contact.dashpot": "unclamped", "source.center": center.tolist()}
    # What is left is below the rounding of the gap: whether the bodies still touch then is open.
    settled = (math.log(depth) + 36) / slow
    leaves_open = frozenset({"duration", "events"}) if end > 0.7 * settled else frozenset()
    stops = tuple(end * x for x in chosen(random, [(1.0,), (0.05, 1.0), (0.01, 0.02, 1.0), (0.3, 0.6, 1.0)]))
    return {
        "values": values, "stops": stops, "straight": True, "settled": settled, "leaves_open": leaves_open,
    }  # fmt: skip


def set_down(random, shape):
    """Set down touching, or a little above, beyond critical damping under a load across the contact: the
    largest force stands early in one long step."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(6, 9), random.uniform(1.05, 2.5)
    values, outward = pair(random, shape, inside, float(chosen(random, [0.0, 0.0, 1e-5])))
    mass = values["source.mass"]
    towards = outward if inside else -outward
    values |= factors(stiffness, ratio, mass)
    values["source.external_force"] = (10.0 * towards).tolist()
    fall = math.sqrt(2 * 1e-5 * mass / 10.0)
    slow = rates(stiffness, ratio, mass)[0]
    settled = fall + math.log(10.0 / stiffness / 2e-15) / slow  # within what rounding leaves of the gap
    end = float(settled * 10 ** random.uniform(-1.5, 1))
    return {"values": values, "stops": (end,), "straight": True, "settled": settled}


def swinging_out(random, shape):
    """Set down on the way to where spring and load balance, below critical damping, with a dashpot that acts
    on approach only: every other half swing keeps its energy."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(4, 7.5), 10 ** random.uniform(-2, -0.05)
    depth = 10.0 / stiffness * float(chosen(random, [0.0, 0.0, 0.5, 0.99]))
    values, outward = pair(random, shape, inside, -depth)
    omega = math.sqrt(stiffness / values["source.mass"])
    values |= factors(stiffness, ratio, values["source.mass"])
    values |= {
        "contact.dashpot": "approach_only",
        "source.external_force": (10.0 * (outward if inside else -outward)).tolist(),
    }
    # No more than 250 swings, and none below 1e-4 of the first: much smaller ones need no dashpot any more.
    end = min(250.0, 9.0 / (0.5 * ratio)) * random.uniform(0.05, 1.0) / omega
    return {"values": values, "stops": uneven(end, random), "straight": True}
