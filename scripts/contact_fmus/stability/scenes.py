"""What the atlas is made of: families of scenes, each along one axis"""

import math
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .motions import (
    GEOMETRIES,
    IMPACT_GEOMETRIES,
    LAWS,
    PLANE,
    TURN,
    Edge,
    Expected,
    HeadOn,
    Impact,
    Motion,
    Rolling,
    Similar,
    Tumbling,
    Units,
    bases,
)

# A scene of the atlas, and a family of them along one axis

STEPS = (1, 7)  # communication steps of a run, where a family does not say


class Jump(NamedTuple):
    """At the begin of communication step `step` the destination is moved to `shift` along z"""

    step: int
    shift: float


@dataclass(frozen=True)
class Scene:
    """One motion; it is run with every method and each number of communication steps"""

    family: str
    value: float  # on the family's axis
    motion: Motion
    steps: Sequence[int] = STEPS
    jumps: Sequence[Jump] = ()
    note: str = ""  # what sets it apart from others at the same value

    def __post_init__(self) -> None:
        if not isinstance(self.motion, Similar):
            object.__setattr__(self, "motion", self.motion.timed())

    def expected(self) -> dict[int, Expected]:
        """The answers by the number of communication steps, which matters where inputs jump at them"""
        if not self.jumps:
            return dict.fromkeys(self.steps, self.motion.expected())
        end = self.motion.end
        return {
            steps: self.motion.expected([(end * (jump.step / steps), jump.shift) for jump in self.jumps])
            for steps in self.steps
        }

    @property
    def name(self) -> str:
        parts = (self.family, f"{self.value:g}", self.motion.geometry, self.motion.law, self.note)
        return ", ".join(part for part in parts if part)


class Family(NamedTuple):
    name: str
    axis: str  # with its unit
    make: Callable[[], Iterator[Scene]]


def decades(first: int, last: int, stride: int = 1) -> list[float]:
    return [float(f"1e{k}") for k in range(first, last + 1, stride)]


# Families of the atlas at the rim of a capped cylinder

LINEAR_OR_HERTZ = ((False, "linear"), (True, "hertz"))


def over_the_edge(values: Sequence[float]) -> Iterator[Scene]:
    """A ball comes down on the cap, or across the side, and its centre passes the edge so far inside or
    outside: it meets the face, or the rim, or passes"""
    for value, law, (hertz, name) in product(values, LAWS[:4], LINEAR_OR_HERTZ):
        one = Edge(law=law, hertz=hertz)
        for (angle, face), sign in product(((TURN, "cap"), (0.0, "side")), (1, -1) if value else (1,)):
            moved = replace(one, angle=angle, offset=sign * value * one.destination_radius)
            yield Scene("over the edge", value, moved, note=f"{name}, {face}, {sign:+d}")


def edge_on(values: Sequence[float]) -> Iterator[Scene]:
    """At the rim along the bisector, dead centre and beside it, and parallel to the cap, at all speeds, soft
    and stiff"""
    for value, law, (hertz, name), depth in product(values, LAWS[:4], LINEAR_OR_HERTZ, (1e-6, 1e-3, 0.1, 0.5)):
        one = Edge(law=law, hertz=hertz, speed=value, depth=depth)
        for angle, part in ((math.pi / 4, 0.0), (math.pi / 4, 0.3), (0.0, 0.3), (0.0, 0.6)):
            if depth + part > 0.75:
                continue  # it may go on over the cap
            moved = replace(one, angle=angle, offset=part * one.source_radius)
            note = f"{name}, {depth:g} deep, {angle:.2g} rad, {part:g} aside"
            yield Scene("edge-on impact", value, moved, note=note)


# Families of the atlas along the parameters of an impact, with Hertz's law and the linear one

DAMPED = LAWS[1:4]  # the dashpots


def modulus(values: Sequence[float]) -> Iterator[Scene]:
    for value, geometry in product(values, IMPACT_GEOMETRIES):
        one = Impact(geometry=geometry, modulus=value)
        yield Scene("modulus", value, replace(one, law="undamped"))
        for law in DAMPED:
            yield Scene("modulus", value, replace(one, law=law, restitution=0.7), note="restitution 0.7")
            free = replace(one, law=law, damped=0.3, destination_mass=2.0)
            yield Scene("modulus", value, free, note="Hunt-Crossley, both free")


def restitution(values: Sequence[float]) -> Iterator[Scene]:
    for value, geometry, law in product(values, IMPACT_GEOMETRIES, DAMPED):
        hertz = Impact(geometry=geometry, law=law, restitution=value)
        yield Scene("restitution", value, hertz, note="hertz")
        linear = HeadOn(geometry=geometry, law=law, restitution=value, gravity=0.0)
        yield Scene("restitution", value, linear, note="linear")


def exponent(values: Sequence[float]) -> Iterator[Scene]:
    """1: the linear law, 3/2: Hertz's, from creeping to a bullet's speed; the depth is the same"""
    linear_law, hertz_law = values
    for geometry, law, speed in product(IMPACT_GEOMETRIES, LAWS[:4], decades(-6, 6, 3)):
        e = None if law == "undamped" else 0.7
        penalty = (speed / 1e-3) ** 2
        linear = HeadOn(geometry=geometry, law=law, restitution=e, gravity=0.0, speed=speed, penalty=penalty)
        yield Scene("exponent", linear_law, linear, note=f"{speed:g} m/s")
        stiffness = 1.25 * speed**2 / 1e-3**2.5
        hertz = Impact(geometry=geometry, law=law, restitution=e, speed=speed, stiffness=stiffness)
        yield Scene("exponent", hertz_law, hertz, note=f"{speed:g} m/s")


# Families of the atlas whose bodies turn: a ball that slides and rolls, a cylinder that tumbles


def spin(values: Sequence[float]) -> Iterator[Scene]:
    for value, speed in product(values, (0.0, 1.0, 100.0)):
        if speed or value:
            one = Rolling(speed=speed, spin=-value, slip_velocity=1e-3)
            yield Scene("spin", value, one, note=f"{speed:g} m/s")


def tumbling_rate(values: Sequence[float]) -> Iterator[Scene]:
    for value in values:
        one = Tumbling(rate=value)
        yield Scene("tumbling rate", value, one)
        yield Scene("tumbling rate", value, replace(one, end=1.01 * one.touch), note="up to the impact")


# Head-on scenes in which everything is extreme at once, drawn at random

SEED = 20
GROUPS, SIZE = 10, 40


def power(random: np.random.Generator, first: float, last: float) -> float:
    return float(10 ** random.uniform(first, last))


def drawn(random: np.random.Generator) -> HeadOn:
    """Within the ranges of the other axes; half of the scenes know no gravity, force or offset"""
    geometry = GEOMETRIES[random.integers(4)]
    large = power(random, -9, 6)
    small = large * power(random, -9, -0.05)
    inside = geometry.endswith("inside")
    radii = (small, large) if inside or random.integers(2) else (large, small)
    reach = large - small if inside else large + small
    mass = power(random, -9, 9)
    return HeadOn(
        geometry=geometry,
        law=LAWS[random.integers(5)],
        dashpot=LAWS[1 + random.integers(3)],
        source_radius=radii[0],
        destination_radius=radii[1],
        gap=reach * power(random, -6, 0),
        speed=power(random, -6, 6),
        source_mass=mass,
        destination_mass=mass * power(random, -12, 12) if random.integers(2) else None,
        penalty=power(random, 0, 15),
        ratio=power(random, -4, 2),
        gravity=9.81 * random.integers(2),
        force=power(random, -3, 12) * (random.random() < 0.3),
        offset=power(random, 0, 9) * (random.random() < 0.3),
    )


def variants(hollow: bool | None = None) -> Iterator[HeadOn]:
    """Every geometry with every law"""
    for geometry, law in product(GEOMETRIES, LAWS):
        if hollow in (None, geometry.endswith("inside")):
            yield HeadOn(geometry=geometry, law=law)


def one_field(row: dict[str, Any], values: Sequence[float]) -> Iterator[Scene]:
    """Scenes that differ in one field of their motion, as a row of families.toml says"""
    motions = [Rolling()] if row.get("rolling") else list(variants())
    for value, one, (note, given) in product(values, motions, row.get("cases", {"": {}}).items()):
        yield Scene(row["name"], value, replace(one, **given, **{row["field"]: value}), note=note)


def size(values: Sequence[float]) -> Iterator[Scene]:
    """Radii, gap and speed grow alike; gravity stays, so that it rules the small ones"""
    for value, one in product(values, variants()):
        scaled = replace(
            one, source_radius=0.25 * value, destination_radius=value, gap=0.25 * value, speed=2.0 * value, penalty=1e6
        )
        yield Scene("size", value, scaled)


def radius_ratio(values: Sequence[float]) -> Iterator[Scene]:
    for value, one in product(values, variants()):
        ratio = 1.25 * value if one.inside else value
        yield Scene("radius ratio", value, replace(one, destination_radius=0.125 * ratio), note="small ball")
        if not one.inside and value > 1:
            large = replace(one, source_radius=0.125 * value, destination_radius=0.125)
            yield Scene("radius ratio", value, large, note="large ball")


def clearance(values: Sequence[float]) -> Iterator[Scene]:
    """A ball that all but fills its shell: some crossings, and lying at rest"""
    for value, one in product(values, variants(hollow=True)):
        free = 0.5 * value
        tight = replace(one, source_radius=0.5 - free, gap=free)
        crossing = replace(tight, speed=1.0, gravity=0.0, end=10 * value + 12 * tight.contact_time())
        yield Scene("clearance", value, crossing, note="crossing")
        yield Scene("clearance", value, replace(tight, speed=0.0, end=0.1), note="settling")


def bullet(values: Sequence[float]) -> Iterator[Scene]:
    """A point-like ball at a millimetre's sphere, in one step that goes far beyond; `value` is the depth the
    impact would need over the way to the middle: from 1 on it passes through"""
    for value, speed, geometry, law in product(
        values, (1e3, 1e4, 1e5, 1e6), ("sphere outside", "cylinder outside"), LAWS[:4]
    ):
        radii = {"source_radius": 2.0**-17, "destination_radius": 2.0**-10}
        small = HeadOn(geometry=geometry, law=law, gap=0.5, speed=speed, gravity=0.0, **radii)
        penalty = (speed / (value * small.reach)) ** 2
        shot = replace(small, penalty=penalty, ratio=0.05, end=1e3 / speed)
        yield Scene("bullet", value, shot, steps=(1,), note=f"{speed:g} m/s")


def damping(values: Sequence[float]) -> Iterator[Scene]:
    for value, geometry, law, penalty in product(values, GEOMETRIES, LAWS[1:4], (1e4, 1e9)):
        one = HeadOn(geometry=geometry, law=law, ratio=value, penalty=penalty)
        longer = replace(one, end=2.5 * one.flight_time() + (1 + value) * one.contact_time())
        yield Scene("damping", value, longer, note=f"{penalty:g} N/m")


def viscous(values: Sequence[float]) -> Iterator[Scene]:
    for value, geometry, dashpot in product(values, GEOMETRIES, LAWS[1:4]):
        one = HeadOn(geometry=geometry, law="viscous_only", damping=value, dashpot=dashpot, end=0.5)
        yield Scene("viscous only", value, one, note=dashpot)


def communication_step(values: Sequence[float]) -> Iterator[Scene]:
    """A flight, the impact and what follows within `count` steps of the size `value`; without gravity, and
    with it falling to rest where the time is long"""
    for value, one, count in product(values, variants(), (1, 20, 100)):
        end = value * count
        thrown = replace(one, gap=0.125 if end > 0.4 else end / 3, gravity=0.0, end=end)
        speed = 0.375 / end if end > 0.4 else 1.0
        steps = (count,)
        yield Scene("communication step", value, replace(thrown, speed=speed), steps=steps, note=f"{count} steps")
        if one.law in ("non_adhesive", "unclamped") and 0.4 < end <= 2e3:
            falling = replace(one, ratio=0.4, end=end)
            yield Scene("communication step", value, falling, steps=steps, note=f"falling, {count} steps")


def start(values: Sequence[float]) -> Iterator[Scene]:
    """`value` is the overlap at the start over the way to the middle: 0 touching, 1 concentric"""
    for value, one, speed in product(values, variants(hollow=False), (1.0, 0.0, -1.0)):
        placed = replace(one, place=one.reach * (1 - value), gap=0.0, speed=speed, end=0.05)
        yield Scene("start", value, placed, note=f"{speed:g} m/s")
    for value, one, speed in product(
        [0.0, 1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3], variants(hollow=True), (1.0, 0.0, -1.0)
    ):
        placed = replace(one, place=-one.reach * (1 + value), gap=0.0, speed=speed, end=0.05)
        yield Scene("start", value, placed, note=f"hollow, {speed:g} m/s")
    for one, speed in product(variants(hollow=True), (1.0, 0.0)):
        centred = replace(one, place=0.0, gap=one.reach, speed=speed, end=2.0)
        yield Scene("start", 1.0, centred, note=f"in the middle of a hollow body, {speed:g} m/s")


def rim(values: Sequence[float]) -> Iterator[Scene]:
    """A finite cylinder's end is passed during a contact, between contacts, or `value` before the touch"""
    for value, geometry, law in product(values, GEOMETRIES[2:], LAWS):
        one = HeadOn(geometry=geometry, law=law, length=1.0, gravity=0.0, gap=0.125, penalty=1e4)
        touch, away = one.flight_time(), 0.5 * one.contact_time()
        for side, along_speed in product((1, -1), (1.0, -1.0)):
            # at the rim `value` after or before the touch, or a half contact later
            for late in (0.0, away):
                along = 0.5 - along_speed * (touch + late + side * value)
                moved = replace(one, along=along, along_speed=along_speed, end=0.5)
                yield Scene("rim", value, moved, note=f"{along_speed:g} m/s, {side:+d}, {late:.2g} s")


def jumps(values: Sequence[float]) -> Iterator[Scene]:
    """A prescribed destination jumps by `value` radii: at rest, into the ball, back, and beyond it"""
    for value, one, sign in product(values, variants(), (1, -1)):
        end = 2.0 if value <= 0.1 else 40 * one.contact_time()
        moved = replace(one, prescribed=True, gravity=0.0, speed=0.6 / end, end=end)
        given = (Jump(2, sign * 0.5 * value), Jump(5, 0.0))
        yield Scene("jump", value, moved, steps=(8,), jumps=given, note=f"{sign:+d}")


def units(row: dict[str, Any], values: Sequence[int]) -> Iterator[Scene]:
    """The oblique scenes in units that are powers of two, as a row of families.toml says"""
    for power in values:
        system = Units(**{unit: int(share * power) for unit, share in row["units"].items()})
        for number, base in enumerate(bases()):
            yield Scene(row["name"], power, Similar(number, system), note=base["name"])


def plane(values: Sequence[float]) -> Iterator[Scene]:
    """A ball on a plane: dropped, thrown, lying on it, and a plane that is free itself"""
    for value, law in product(values, LAWS):
        one = HeadOn(geometry=PLANE, law=law, penalty=value)
        yield Scene("plane", value, one)
        yield Scene("plane", value, replace(one, speed=100.0, gravity=0.0), note="thrown")
        lying = replace(one, place=one.reach, gap=0.0, speed=0.0, end=min(0.1, 30 * one.contact_time()))
        yield Scene("plane", value, lying, note="set down")
        both = replace(one, source_mass=3.0, destination_mass=2.0, offset=1e3)
        yield Scene("plane", value, both, note="free plane")


def at_once(groups: Sequence[int] = range(GROUPS)) -> Iterator[Scene]:
    for group, number in product(groups, range(SIZE)):
        motion = drawn(np.random.default_rng([SEED, group, number]))
        yield Scene("all at once", group, motion, note=f"number {number}")


FUNCTIONS = {
    one.__name__: one
    for one in (
        *(size, radius_ratio, clearance, bullet, damping, viscous, communication_step, start, rim, jumps, plane),
        *(over_the_edge, edge_on, modulus, restitution, exponent, spin, tumbling_rate, at_once),
    )
}


def _family(row: dict[str, Any]) -> Family:
    """A row of families.toml"""
    values = [*row.get("values", ()), *(decades(*row["decades"]) if "decades" in row else ()), *row.get("more", ())]
    make = FUNCTIONS[row["function"]] if "function" in row else partial(units if "units" in row else one_field, row)
    return Family(row["name"], row["axis"], partial(make, values))


ROWS = tomllib.loads(Path(__file__).with_name("families.toml").read_text(encoding="utf-8"))["family"]
FAMILIES = tuple(map(_family, ROWS))


def all_scenes() -> list[Scene]:
    return [scene for family in FAMILIES for scene in family.make()]
