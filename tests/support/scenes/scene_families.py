"""Families of random scenes about given motions, events and coincidences. Each takes a random generator and a
shape and gives fields of FamilyScene: values, communication points, and others where they matter."""

import itertools
import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from support.reference.integrator import Reference
from support.reference.law import complete
from support.scenes import random_scenes as parts


def given_motions(random, shape):
    """Both bodies led, one of them perhaps at rest: a chord through the other one, in places a graze."""
    inside = random.random() < 0.25
    stiffness = 10 ** random.uniform(3, 6)
    values, outward = parts.pair(random, shape, inside, 0.0, **{"contact.penalty_factor": stiffness})
    values["contact.viscous_penalty_factor"] = parts.chosen(random, [0.0, 10.0, 100.0, 300.0])
    reach = values["destination.radius"] + values["source.radius"]
    across = parts.perpendicular(outward, random)
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
        values |= parts.moved_by("source", velocity, acceleration)
    else:
        other = random.normal(size=3)
        values |= parts.moved_by("source", velocity + other, acceleration + other)
        values |= parts.moved_by("destination", other, other)
    return {"values": values, "stops": parts.even(end, parts.chosen(random, [1, 1, 7, 100]))}


ROUND_PLACES = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0]
ROUND_SPEEDS = [0.0, 0.0, 0.1, 0.2, 0.5, 1.0, 2.0]
ROUND_AXES = [(0, 0, 1), (1, 0, 0), (1, 1, 1), (1, 0, 1), (1, 2, 2), (1, -1, 0), (3, 0, 4)]


def round_vector(random, items):
    return [float(parts.chosen(random, items) * random.choice([-1, 1])) for _ in range(3)]


def round_numbers(random, shape):
    """Everything is as a person would type it, so that many things happen at once or not at all."""
    inside = bool(random.integers(2))
    values = {
        "source.center": round_vector(random, ROUND_PLACES),
        "contact.location": "inside" if inside else "outside",
        "contact.penalty_factor": parts.chosen(random, [1.0, 100.0, 1e3, 1e4, 1e5]),
        "contact.viscous_penalty_factor": parts.chosen(random, [0.0, 0.2, 1.0, 10.0, 100.0]),
        "contact.dashpot": parts.chosen(random, parts.DASHPOTS),
        "gravity": parts.chosen(
            random, [parts.NOTHING, parts.NOTHING, [0.0, 0.0, -9.81], [0.0, 0.0, -10.0], [0.0, -1.0, 0.0]]
        ),
    }
    if random.random() < 0.2:
        values["contact.penalty_control"] = "viscous_only"
    if shape == "cylinder":
        values["destination.axis"] = list(map(float, parts.chosen(random, ROUND_AXES)))
        if random.random() < 0.2:
            values |= {
                "destination.finite_length": True,
                "destination.length": parts.chosen(random, [0.3, 0.7, 1.5]),
            }
    speed = round_vector(random, ROUND_SPEEDS)
    kind = random.integers(4)
    if kind == 0:
        values |= {"source.motion": "prescribed", "source.prescribed_velocity": speed}
    else:
        values["source.initial_velocity"] = speed
    if kind == 1:
        values |= parts.moved_by("destination", round_vector(random, ROUND_SPEEDS))
    if kind == 2:
        values |= {"destination.motion": "free", "destination.mass": parts.chosen(random, [1.0, 2.0, 1000.0])}
    end = parts.chosen(random, [0.5, 1.0, 1.5, 2.0])
    return {"values": values, "stops": parts.even(end, parts.chosen(random, [1, 1, 2, 10]))}


def through_the_centre(random, shape):
    """A free ball goes exactly through the axis of a solid cylinder that stands askew, or through a ball."""
    axis = np.array(parts.chosen(random, ROUND_AXES))
    across = np.zeros(3, int)
    while not across.any():
        across = np.cross(axis, random.integers(-1, 2, 3))
    fits = [x for x in (0.125, 0.25, 0.5, 0.75, 1.0) if 0.1 < x * np.linalg.norm(across) < 1.5]
    start = parts.chosen(random, fits) * across
    speed = float(parts.chosen(random, [1.0, 2.0, 0.5]))
    velocity = -speed * across / parts.chosen(random, [1, 2, 4])
    values = {"source.center": start.tolist(), "source.initial_velocity": velocity.tolist()}
    values |= {"contact.location": "outside", "contact.dashpot": parts.chosen(random, parts.DASHPOTS)}
    values |= {"contact.viscous_penalty_factor": parts.chosen(random, [0.0, 0.1, 0.2, 0.25, 0.5])}
    values |= {
        "contact.penalty_factor": parts.chosen(random, [0.05, 0.1, 0.5, 1.0, 10.0]),
        "gravity": parts.NOTHING,
    }
    if random.random() < 0.5:
        values["contact.penalty_control"] = "viscous_only"
    if shape == "cylinder":
        values["destination.axis"] = list(map(float, axis))
        along = float(parts.chosen(random, [0.0, 0.1, 0.25, 0.5]))
        values["source.initial_velocity"] = (velocity + along * axis).tolist()
        values["gravity"] = (parts.chosen(random, [0.0, 0.0, -1.0, 2.0]) * axis).tolist()
    if random.random() < 0.3:
        values |= {"destination.motion": "free", "destination.mass": parts.chosen(random, [1.0, 2.0, 1000.0])}
    end = parts.chosen(random, [0.5, 1.0, 1.5, 3.0])
    return {"values": values, "stops": parts.even(end, parts.chosen(random, [1, 1, 3, 10]))}


def unequal_masses(random, shape):
    """Both free, one 1e3 to 1e7 times as heavy; they touch shortly before the end of a finite cylinder."""
    del shape
    inside = random.random() < 0.3
    speed, slow = random.uniform(0.05, 0.5), 10 ** random.uniform(-3, -0.5)
    touches, leaves = random.uniform(0.0, 0.6), random.uniform(1e-3, 0.1)  # s, and how long after it
    values, outward = parts.pair(random, "cylinder", inside, slow * touches)
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
        "gravity": parts.chosen(random, [parts.NOTHING, [0.0, 0.0, -9.81]]),
        **parts.factors(10 ** random.uniform(2, 5), parts.chosen(random, [0.0, 0.0, 0.0, 1e-10, 0.05]), 1.0),
    }  # fmt: skip
    if random.random() < 0.3:
        values["destination.external_force"] = (random.normal(size=3)).tolist()
    return {"values": values, "shape": "cylinder", "stops": parts.uneven(1.0, random)}


def beside_an_event(random, shape):
    """A scene of random_scenes.py has a communication point at an event, or a few roundings beside it."""
    kind = parts.chosen(random, parts.KINDS[shape])
    values, end = parts.random_scene(shape, kind, int(random.integers(1, 2**31)))
    times = [t for t in Reference(values, shape).run(end).event_times if 0 < t < end]
    stops = set()
    for time in random.permutation(times)[: random.integers(1, 4)]:
        for _ in range(random.integers(1, 3)):
            stops.add(float(time + random.integers(-2, 3) * np.spacing(time)))
    # A step that is too short to change the time is refused.
    stops = [
        time for time in stops if not any(0.0 < time - other <= np.finfo(float).eps * time for other in stops)
    ]
    # Where the force ends all at once, at a cylinder's end, the last step may still see it or not.
    leaves_open = frozenset({"peak_force", "peak_penetration"} if kind.startswith("finite") else ())
    return {"values": values, "stops": (*sorted(stops), end), "leaves_open": leaves_open}


# The next functions draw scenes whose loads begin at zero, whose inputs contradict each other, or whose
# contacts are damped beyond the critical.


def from_zero(random, shape):
    """A load or a given motion begins at zero, as a ramp or a parabola. Damping is critical or more."""
    inside = bool(random.integers(2))
    gap = float(parts.chosen(random, [0.0, -0.004, -0.01]) if random.random() < 0.7 else 1e-3)
    values, outward = parts.pair(random, shape, inside, gap)
    stiffness = 10 ** random.uniform(2, 5)
    ratio = 10 ** random.uniform(-0.2, 1.2)
    values |= parts.factors(stiffness, ratio, values["source.mass"])
    slow, fast = parts.rates(stiffness, ratio, values["source.mass"])
    end = min(random.uniform(0.5, 20) / slow, 400 / fast, 1.0)
    towards = outward if inside else -outward
    push = towards + random.normal(size=3)
    size = values["source.mass"] * 0.02 / end**2  # so that it goes some centimetres
    if random.random() < 0.7:
        ramp, parabola = size / end * push, size / end**2 * random.normal(size=3)
        rows = [[ramp, parts.NOTHING], [parts.NOTHING, parabola], [ramp, parabola]][random.integers(3)]
        values["source.external_force.derivatives"] = [list(map(float, row)) for row in rows]
    else:
        led = -push * 0.02 / end**3
        rows = [[led * end, np.zeros(3)], [np.zeros(3), led]][random.integers(2)]
        values["destination.motion"] = "prescribed"
        values["destination.prescribed_velocity.derivatives"] = [row.tolist() for row in rows]
    return {"values": values, "stops": parts.uneven(end, random)}


def contradictory(random, shape):
    """The derivatives of a prescribed displacement are not the prescribed velocity."""
    inside = bool(random.integers(2))
    values, outward = parts.pair(random, shape, inside, random.uniform(-0.01, 0.05))
    towards = outward if inside else -outward
    stiffness = 10 ** random.uniform(3, 6)
    values |= parts.factors(stiffness, parts.chosen(random, [0.0, 0.1, 0.5, 1.5, 5.0]), values["source.mass"])
    end, velocity = 0.3, 0.3 * towards + 0.2 * random.normal(size=3)
    rate = [parts.NOTHING, velocity.tolist(), (-velocity).tolist()][random.integers(3)]
    bent = (random.normal(size=3)).tolist() if random.integers(2) else parts.NOTHING
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
        axis = values["destination.axis"]
        away = np.abs(np.dot(np.divide(axis, np.linalg.norm(axis)), rate))
        values |= {"destination.finite_length": True, "destination.length": float(max(0.01, end * away))}
    found = {"values": values, "stops": parts.uneven(end, random)}
    # Energy is not kept where a body moves otherwise than at its velocity, nor clear what a spring loses.
    return found | {"leaves_open": frozenset({"total", "energy.dissipated"})}


def approach_only(random, shape):
    """A contact lasts whose dashpot acts on approach only, at and beyond critical damping."""
    inside = random.random() < 0.7
    values, outward = parts.pair(random, shape, inside, -1e-6 if inside else 0.0)
    towards = outward if inside else -outward
    stiffness, ratio = 10 ** random.uniform(3, 9.5), 10 ** random.uniform(0, 1)
    values |= parts.factors(stiffness, ratio, values["source.mass"])
    fast = parts.rates(stiffness, ratio, values["source.mass"])[1]
    end = float(min(1.0, 10 ** random.uniform(1.5, 3.3) / fast))
    values |= {
        "contact.dashpot": "approach_only",
        "gravity": (
            9.81 * (towards + parts.chosen(random, [0.0, 0.3, 1.0]) * parts.unit_vector(random))
        ).tolist(),
        "source.initial_velocity": (0.2 * random.normal(size=3)).tolist(),
    }
    return {"values": values, "stops": parts.uneven(end, random)}


def dying_away(random, shape):
    """An unloaded contact beyond critical damping with an unclamped dashpot never parts."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(4, 7), 1 + 10 ** random.uniform(-2, 0.7)
    values, _ = parts.pair(random, shape, inside, 0.0)
    mass = values["source.mass"]
    slow = parts.rates(stiffness, ratio, mass)[0]
    depth = 10 ** random.uniform(-8, -2)
    away = np.subtract(values["source.center"], values["destination.center"])
    away *= 1 + (depth if inside else -depth) / np.linalg.norm(away)
    center = np.add(values["destination.center"], away)
    end = float(10 ** random.uniform(0, 3)) / slow
    values |= parts.factors(stiffness, ratio, mass)
    values |= {"contact.dashpot": "unclamped", "source.center": center.tolist()}
    # What is left is below the rounding of the gap: whether the bodies still touch then is open.
    settled = (math.log(depth) + 36) / slow
    leaves_open = frozenset({"duration", "events"}) if end > 0.7 * settled else frozenset()
    shares = parts.chosen(random, [(1.0,), (0.05, 1.0), (0.01, 0.02, 1.0), (0.3, 0.6, 1.0)])
    stops = tuple(end * x for x in shares)
    found = {"values": values, "stops": stops, "straight": True, "settled": settled}
    found |= {"leaves_open": leaves_open}
    return found


def set_down(random, shape):
    """Set down touching, or a little above, beyond critical damping under a load across the contact: the
    largest force stands early in one long step."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(6, 9), random.uniform(1.05, 2.5)
    values, outward = parts.pair(random, shape, inside, float(parts.chosen(random, [0.0, 0.0, 1e-5])))
    mass = values["source.mass"]
    towards = outward if inside else -outward
    values |= parts.factors(stiffness, ratio, mass)
    values["source.external_force"] = (10.0 * towards).tolist()
    fall = math.sqrt(2 * 1e-5 * mass / 10.0)
    slow = parts.rates(stiffness, ratio, mass)[0]
    settled = fall + math.log(10.0 / stiffness / 2e-15) / slow  # within what rounding leaves of the gap
    end = float(settled * 10 ** random.uniform(-1.5, 1))
    return {"values": values, "stops": (end,), "straight": True, "settled": settled}


def swinging_out(random, shape):
    """Set down on the way to where spring and load balance, below critical damping, with a dashpot that acts
    on approach only: every other half swing keeps its energy."""
    inside = bool(random.integers(2))
    stiffness, ratio = 10 ** random.uniform(4, 7.5), 10 ** random.uniform(-2, -0.05)
    depth = 10.0 / stiffness * float(parts.chosen(random, [0.0, 0.0, 0.5, 0.99]))
    values, outward = parts.pair(random, shape, inside, -depth)
    omega = math.sqrt(stiffness / values["source.mass"])
    values |= parts.factors(stiffness, ratio, values["source.mass"])
    values |= {
        "contact.dashpot": "approach_only",
        "source.external_force": (10.0 * (outward if inside else -outward)).tolist(),
    }
    # No more than 250 swings, and none below 1e-4 of the first: much smaller ones need no dashpot any more.
    end = min(250.0, 9.0 / (0.5 * ratio)) * random.uniform(0.05, 1.0) / omega
    return {"values": values, "stops": parts.uneven(end, random), "straight": True}


# The functions from here on are families of seeded random scenes. Each family is about one kind of place
# where an integrator of contacts goes wrong: two prescribed bodies that pass each other, loads that begin at
# zero, round numbers, the way through the centre, unequal masses at a cylinder's end, communication points
# beside an event, inputs that contradict each other, and contacts beyond critical damping.
#
# `drawn(family, seed)` makes a scene; `expected(scene)` integrates it with reference/integrator.py.

ZERO = [Fraction(0)] * 3


@dataclass(frozen=True)
class FamilyScene:
    """Names as FMI variables; "<input>.derivatives" as in checks.start. `stops`: communication points, s."""

    family: str
    seed: int
    shape: str
    values: dict
    stops: tuple
    straight: bool = False  # on a line through the centre: Reference's `straight`
    settled: float = math.inf  # s; nothing moves any more from here on
    leaves_open: frozenset = frozenset()  # figures that have no one right value here

    @property
    def end(self):
        return self.stops[-1]


FAMILIES = {"given motions": given_motions, "from zero": from_zero, "round numbers": round_numbers}
FAMILIES |= {"through the centre": through_the_centre, "unequal masses": unequal_masses}
FAMILIES |= {"beside an event": beside_an_event, "contradictory": contradictory}
FAMILIES |= {"approach only": approach_only, "dying away": dying_away, "set down": set_down}
FAMILIES |= {"swinging out": swinging_out}


def drawn(family, seed):
    """Returns the scene of a family with this seed, drawn again where round numbers leave no right answer."""
    for attempt in itertools.count():
        random = np.random.default_rng([seed, list(FAMILIES).index(family), attempt])
        shape = ("sphere", "cylinder")[random.integers(2)]
        fields = {"family": family, "seed": seed, "shape": shape} | FAMILIES[family](random, shape)
        scene = FamilyScene(**fields)
        if family in ("round numbers", "through the centre"):
            scene = replace(scene, straight=moves_straight(scene))
            if not well_posed(scene):
                continue
        return scene


# Exact arithmetic with numbers as they are typed.


def typed(row):
    return [Fraction(repr(float(x))) for x in row]


def exact_dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def exact_cross(a, b):
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def across_axis(row, axis):
    """Returns the part across the axis times its length squared, or the row itself without an axis."""
    row = typed(row)
    if axis is None:
        return row
    axis = typed(axis)
    along, square = exact_dot(row, axis), exact_dot(axis, axis)
    return [x * square - along * e for x, e in zip(row, axis, strict=True)]


def moves_straight(scene):
    """Returns whether place, speeds and accelerations are, as typed, on one line through the centre."""
    values = complete(scene.values)
    axis = values["destination.axis"] if scene.shape == "cylinder" else None
    centers = (typed(values[f"{body}.center"]) for body in ("source", "destination"))
    line = across_axis([float(b - a) for a, b in zip(*centers, strict=True)], axis)
    if line == ZERO:
        return False
    rows = [
        values[f"{body}.{row}"]
        for body in ("source", "destination")
        for row in ("initial_velocity", "prescribed_velocity")
    ]
    rows += [values["gravity"]] if "free" in (values["source.motion"], values["destination.motion"]) else []
    return all(exact_cross(line, across_axis(row, axis)) == ZERO for row in rows)


def well_posed(scene):
    """Returns whether the motion has one right course: it does not start in the centre of a solid body, and a
    surface moved by 1e-9 m moves the end by no more than 1e-6."""
    ends = []
    try:
        for shift in (0.0, 1e-9, -1e-9):
            moved = dict(scene.values)
            moved["destination.radius"] = complete(scene.values)["destination.radius"] + shift
            found = expected(replace(scene, values=moved))
            rows = [*found.position.values(), *found.velocity.values()]
            ends.append(np.array([*np.ravel(rows), found.dissipated, found.onsets, len(found.event_times)]))
    except (ZeroDivisionError, TooLong):
        return False
    return all(np.max(np.abs(row - ends[0])) < 1e-6 for row in ends)


AT_REST = 1e-9  # m/s


class TooLong(Exception):
    """The reference takes more steps than are worth waiting for."""


class Bounded(Reference):
    """Gives up where it would take minutes."""

    def span(self, regime):
        if self.steps > 5000:
            raise TooLong
        return super().span(regime)


def expected(scene, number=float, order=24):
    """Returns the reference at the scene's end, with the peaks of the last communication step."""
    reference = Bounded(scene.values, scene.shape, number, order, straight=scene.straight)
    reference.window = number([0.0, *scene.stops][-2])
    reference.run(min(scene.end, scene.settled))
    resting = number(scene.end) - reference.time
    if resting > 0:  # the contact bears the load alone, and nothing moves
        fastest = max(abs(x) for row in reference.velocity.values() for x in row)
        if fastest > AT_REST:
            raise ValueError(f"the reference still moves at {float(fastest)} m/s when settled")
        load = reference.vector("source.external_force")
        reference.impulse = [j - f * resting for j, f in zip(reference.impulse, load, strict=True)]
        reference.time = number(scene.end)
    return reference
