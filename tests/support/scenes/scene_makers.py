"""Families of random scenes about given motions, events and coincidences. Each takes a random generator and a
shape and gives fields of FamilyScene: values, communication points, and others where they matter."""

import numpy as np

from support.reference.integrator import Reference
from support.scenes.random_scenes import DASHPOTS, KINDS, perpendicular, random_scene
from support.scenes.scene_parts import NOTHING, chosen, even, factors, moved_by, pair, uneven


def given_motions(random, shape):
    """Both bodies led, one of them perhaps at rest: a chord through the other one, in places a graze."""
    inside = random.random() < 0.25
    values, outward = pair(
        random, shape, inside, 0.0, **{"contact.penalty_factor": 10 ** random.uniform(3, 6)}
    )
    values["contact.viscous_penalty_factor"] = chosen(random, [0.0, 10.0, 100.0, 300.0])
    reach = values["destination.radius"] + values["source.radius"]
    across = perpendicular(outward, random)
    if shape == "cylinder":
        across = np.cross(values["destination.axis"], outward)
        across /= np.linalg.norm(across)
    miss, start = random.uniform(-0.95, 0.95) * reach, random.uniform(1.2, 2.5) * reach
    place = values["destination.center"] + miss * across + start * outward
    values["source.center"] = place.tolist()
    end = 2.0
    speed = random.uniform(1.5, 3.5) * start / end
    velocity = -speed * outward + 0.1 * random.normal(size=3)
    acceleration = 0.2 * random.normal(size=3) if random.integers(2) else np.zeros(3)
    kind = random.integers(3)
    if kind == 0:  # the source alone, its displacement after its velocity, the destination at rest
        values |= {"source.motion": "prescribed", "source.prescribed_velocity": velocity.tolist()}
        jerk = 0.2 * random.normal(size=3) if random.integers(2) else np.zeros(3)
        values["source.prescribed_velocity.derivatives"] = [acceleration.tolist(), jerk.tolist()]
    elif kind == 1:
        values |= moved_by("source", velocity, acceleration)
    else:
        other = random.normal(size=3)
        values |= moved_by("source", velocity + other, acceleration + other)
        values |= moved_by("destination", other, other)
    return {"values": values, "stops": even(end, chosen(random, [1, 1, 7, 100]))}


ROUND_PLACES = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0]
ROUND_SPEEDS = [0.0, 0.0, 0.1, 0.2, 0.5, 1.0, 2.0]
ROUND_AXES = [(0, 0, 1), (1, 0, 0), (1, 1, 1), (1, 0, 1), (1, 2, 2), (1, -1, 0), (3, 0, 4)]


def round_vector(random, items):
    return [float(chosen(random, items) * random.choice([-1, 1])) for _ in range(3)]


def round_numbers(random, shape):
    """Everything as a person would type it, so that many things happen at once or not at all."""
    inside = bool(random.integers(2))
    values = {
        "source.center": round_vector(random, ROUND_PLACES),
        "contact.location": "inside" if inside else "outside",
        "contact.penalty_factor": chosen(random, [1.0, 100.0, 1e3, 1e4, 1e5]),
        "contact.viscous_penalty_factor": chosen(random, [0.0, 0.2, 1.0, 10.0, 100.0]),
        "contact.dashpot": chosen(random, DASHPOTS),
        "gravity": chosen(random, [NOTHING, NOTHING, [0.0, 0.0, -9.81], [0.0, 0.0, -10.0], [0.0, -1.0, 0.0]]),
    }
    if random.random() < 0.2:
        values["contact.penalty_control"] = "viscous_only"
    if shape == "cylinder":
        values["destination.axis"] = list(map(float, chosen(random, ROUND_AXES)))
        if random.random() < 0.2:
            values |= {
                "destination.finite_length": True,
                "destination.length": chosen(random, [0.3, 0.7, 1.5]),
            }
    speed = round_vector(random, ROUND_SPEEDS)
    kind = random.integers(4)
    if kind == 0:
        values |= {"source.motion": "prescribed", "source.prescribed_velocity": speed}
    else:
        values["source.initial_velocity"] = speed
    if kind == 1:
        values |= moved_by("destination", round_vector(random, ROUND_SPEEDS))
    if kind == 2:
        values |= {"destination.motion": "free", "destination.mass": chosen(random, [1.0, 2.0, 1000.0])}
    end = chosen(random, [0.5, 1.0, 1.5, 2.0])
    return {"values": values, "stops": even(end, chosen(random, [1, 1, 2, 10]))}


def through_the_centre(random, shape):
    """A free ball exactly through the axis of a solid cylinder that stands askew, or through a ball."""
    axis = np.array(chosen(random, ROUND_AXES))
    across = np.zeros(3, int)
    while not across.any():
        across = np.cross(axis, random.integers(-1, 2, 3))
    fits = [x for x in (0.125, 0.25, 0.5, 0.75, 1.0) if 0.1 < x * np.linalg.norm(across) < 1.5]
    start = chosen(random, fits) * across
    speed = float(chosen(random, [1.0, 2.0, 0.5]))
    velocity = -speed * across / chosen(random, [1, 2, 4])
    values = {
        "source.center": start.tolist(), "source.initial_velocity": velocity.tolist(),
        "contact.location": "outside", "contact.dashpot": chosen(random, DASHPOTS),
        "contact.viscous_penalty_factor": chosen(random, [0.0, 0.1, 0.2, 0.25, 0.5]),
        "contact.penalty_factor": chosen(random, [0.05, 0.1, 0.5, 1.0, 10.0]), "gravity": NOTHING,
    }  # fmt: skip
    if random.random() < 0.5:
        values["contact.penalty_control"] = "viscous_only"
    if shape == "cylinder":
        values["destination.axis"] = list(map(float, axis))
        along = float(chosen(random, [0.0, 0.1, 0.25, 0.5]))
        values["source.initial_velocity"] = (velocity + along * axis).tolist()
        values["gravity"] = (chosen(random, [0.0, 0.0, -1.0, 2.0]) * axis).tolist()
    if random.random() < 0.3:
        values |= {"destination.motion": "free", "destination.mass": chosen(random, [1.0, 2.0, 1000.0])}
    end = chosen(random, [0.5, 1.0, 1.5, 3.0])
    return {"values": values, "stops": even(end, chosen(random, [1, 1, 3, 10]))}


def unequal_masses(random, shape):
    """Both free, one 1e3 to 1e7 times as heavy; they touch shortly before the end of a finite cylinder."""
    del shape
    inside = random.random() < 0.3
    speed, slow = random.uniform(0.05, 0.5), 10 ** random.uniform(-3, -0.5)
    touches, leaves = random.uniform(0.0, 0.6), random.uniform(1e-3, 0.1)  # s, and how long after it
    values, outward = pair(random, "cylinder", inside, slow * touches)
    axis = np.divide(values["destination.axis"], np.linalg.norm(values["destination.axis"]))
    length = random.uniform(0.7, 1.5)
    side = random.choice([-1.0, 1.0])
    shift = length / 2 - speed * (touches + leaves)
    if random.random() < 0.2:  # in from beyond the end instead
        shift, speed = length / 2 + speed * (touches + leaves), -speed
    place = values["source.center"] + side * shift * axis
    towards = outward if inside else -outward
    ratio = 10 ** random.uniform(3, 7)
    masses = (1.0, ratio) if random.random() < 0.7 else (ratio, 1.0)
    values |= {
        "source.mass": masses[0], "destination.mass": masses[1], "destination.motion": "free",
        "destination.finite_length": True, "destination.length": length, "source.center": place.tolist(),
        "source.initial_velocity": (side * speed * axis + slow * towards).tolist(),
        "gravity": chosen(random, [NOTHING, [0.0, 0.0, -9.81]]),
        **factors(10 ** random.uniform(2, 5), chosen(random, [0.0, 0.0, 0.0, 1e-10, 0.05]), 1.0),
    }  # fmt: skip
    if random.random() < 0.3:
        values["destination.external_force"] = (random.normal(size=3)).tolist()
    return {"values": values, "shape": "cylinder", "stops": uneven(1.0, random)}


def beside_an_event(random, shape):
    """A scene of random_scenes.py with a communication point at an event, or a few roundings beside it."""
    kind = chosen(random, KINDS[shape])
    values, end = random_scene(shape, kind, int(random.integers(1, 2**31)))
    times = [t for t in Reference(values, shape).run(end).event_times if 0 < t < end]
    stops = set()
    for time in random.permutation(times)[: random.integers(1, 4)]:
        for _ in range(random.integers(1, 3)):
            stops.add(float(time + random.integers(-2, 3) * np.spacing(time)))
    # Where the force ends all at once, at a cylinder's end, the last step may still see it or not.
    leaves_open = frozenset({"peak_force", "peak_penetration"} if kind.startswith("finite") else ())
    return {"values": values, "stops": (*sorted(stops), end), "leaves_open": leaves_open}
