"""Families of seeded random scenes, each about one kind of place where an integrator of contacts goes wrong:
two given motions passing by, loads that begin at zero, round numbers, the way through the centre, unequal
masses at a cylinder's end, communication points beside an event, inputs that contradict each other, and
contacts beyond critical damping.

`drawn(family, seed)` makes a scene; `expected(scene)` integrates it with reference/integrator.py.
"""

import itertools
import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from support.reference.integrator import Reference
from support.reference.law import complete
from support.scenes.damped_makers import (
    approach_only,
    contradictory,
    dying_away,
    from_zero,
    set_down,
    swinging_out,
)
from support.scenes.scene_makers import (
    beside_an_event,
    given_motions,
    round_numbers,
    through_the_centre,
    unequal_masses,
)

ZERO = [Fraction(0)] * 3


@dataclass(frozen=True)
class FamilyScene:
    """Names as FMI variables; "<input>.derivatives" as in checks.start. `stops`: the communication points
    after the start, s."""

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


FAMILIES = {
    "given motions": given_motions, "from zero": from_zero, "round numbers": round_numbers,
    "through the centre": through_the_centre, "unequal masses": unequal_masses,
    "beside an event": beside_an_event, "contradictory": contradictory, "approach only": approach_only,
    "dying away": dying_away, "set down": set_down, "swinging out": swinging_out,
}  # fmt: skip


def drawn(family, seed):
    """The scene of a family with this seed. What round numbers make without one right answer is drawn
    again."""
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
    """The part across the axis times its length squared; the row itself without an axis."""
    row = typed(row)
    if axis is None:
        return row
    axis = typed(axis)
    along, square = exact_dot(row, axis), exact_dot(axis, axis)
    return [x * square - along * e for x, e in zip(row, axis, strict=True)]


def moves_straight(scene):
    """Whether place, speeds and accelerations are on one line through the centre, in the numbers as typed."""
    values = complete(scene.values)
    axis = values["destination.axis"] if scene.shape == "cylinder" else None
    apart = [
        b - a for a, b in zip(*(typed(values[f"{n}.center"]) for n in ("source", "destination")), strict=True)
    ]
    line = across_axis([float(x) for x in apart], axis)
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
    """Whether the motion has one right course: it does not start in the centre of a solid body, and a
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
    """The reference at the scene's end, its peaks those of the last communication step."""
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
