"""What the atlas is made of: families of scenes, each along one axis"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from . import together
from .edge_scenes import edge_on, over_the_edge
from .head_on import GEOMETRIES, LAWS, PLANE, HeadOn
from .impact_scenes import exponent, modulus, restitution
from .scene import Family, Jump, Scene, decades
from .similar import Similar, bases, unit_systems
from .turning_scenes import friction, inertia_ratio, slip_velocity, spin, tumbling_rate


def variants(hollow: bool | None = None) -> Iterator[HeadOn]:
    """Every geometry with every law"""
    for geometry in GEOMETRIES:
        if hollow is None or geometry.endswith("inside") == hollow:
            for law in LAWS:
                yield HeadOn(geometry=geometry, law=law)


def stiffness() -> Iterator[Scene]:
    for value in decades(0, 15):
        for one in variants():
            yield Scene("stiffness", value, replace(one, penalty=value))


def mass() -> Iterator[Scene]:
    for value in decades(-9, 9):
        for one in variants():
            yield Scene("mass", value, replace(one, source_mass=value))


def mass_ratio() -> Iterator[Scene]:
    for value in decades(-12, 12):
        for one in variants():
            yield Scene("mass ratio", value, replace(one, source_mass=value, destination_mass=1.0))


def size() -> Iterator[Scene]:
    """Radii, gap and speed grow alike; gravity stays, so that it rules the small ones"""
    for value in decades(-9, 6):
        for one in variants():
            scaled = replace(
                one,
                source_radius=0.25 * value,
                destination_radius=value,
                gap=0.25 * value,
                speed=2.0 * value,
                penalty=1e6,
            )
            yield Scene("size", value, scaled)


def radius_ratio() -> Iterator[Scene]:
    for value in decades(0, 9):
        for one in variants():
            ratio = 1.25 * value if one.inside else value
            yield Scene(
                "radius ratio", value, replace(one, destination_radius=0.125 * ratio), note="small ball"
            )
            if not one.inside and value > 1:
                large = replace(one, source_radius=0.125 * value, destination_radius=0.125)
                yield Scene("radius ratio", value, large, note="large ball")


def clearance() -> Iterator[Scene]:
    """A ball that all but fills its shell: some crossings, and lying at rest"""
    for value in decades(-12, -1):
        for one in variants(hollow=True):
            free = 0.5 * value
            tight = replace(one, source_radius=0.5 - free, gap=free)
            crossing = replace(tight, speed=1.0, gravity=0.0, end=10 * value + 12 * tight.contact_time())
            yield Scene("clearance", value, crossing, note="crossing")
            yield Scene("clearance", value, replace(tight, speed=0.0, end=0.1), note="settling")


def speed() -> Iterator[Scene]:
    for value in [0.0, *decades(-6, 6)]:
        for one in variants():
            yield Scene("speed", value, replace(one, speed=value))


def bullet() -> Iterator[Scene]:
    """A point-like ball at a millimetre's sphere, in one step that goes far beyond; `value` is the depth the
    impact would need over the way to the middle: from 1 on it passes through"""
    for value in [1e-6, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3, 1e6]:
        for speed in (1e3, 1e4, 1e5, 1e6):
            for geometry in ("sphere outside", "cylinder outside"):
                for law in LAWS[:4]:
                    small = HeadOn(
                        geometry=geometry,
                        law=law,
                        source_radius=2.0**-17,
                        destination_radius=2.0**-10,
                        gap=0.5,
                        speed=speed,
                        gravity=0.0,
                    )
                    penalty = (speed / (value * small.reach)) ** 2
                    shot = replace(small, penalty=penalty, ratio=0.05, end=1e3 / speed)
                    yield Scene("bullet", value, shot, steps=(1,), note=f"{speed:g} m/s")


def damping() -> Iterator[Scene]:
    for value in [0.0, *decades(-4, 4)]:
        for geometry in GEOMETRIES:
            for law in LAWS[1:4]:
                for penalty in (1e4, 1e9):
                    one = HeadOn(geometry=geometry, law=law, ratio=value, penalty=penalty)
                    longer = replace(one, end=2.5 * one.flight_time() + (1 + value) * one.contact_time())
                    yield Scene("damping", value, longer, note=f"{penalty:g} N/m")


def viscous() -> Iterator[Scene]:
    for value in decades(-6, 12):
        for geometry in GEOMETRIES:
            for dashpot in LAWS[1:4]:
                one = HeadOn(geometry=geometry, law="viscous_only", damping=value, dashpot=dashpot, end=0.5)
                yield Scene("viscous only", value, one, note=dashpot)


def communication_step() -> Iterator[Scene]:
    """A flight, the impact and what follows within `count` steps of the size `value`; without gravity, and
    with it falling to rest where the time is long"""
    for value in decades(-9, 3):
        for one in variants():
            for count in (1, 20, 100):
                end = value * count
                thrown = replace(one, gap=0.125 if end > 0.4 else end / 3, gravity=0.0, end=end)
                speed = 0.375 / end if end > 0.4 else 1.0
                steps = (count,)
                yield Scene(
                    "communication step",
                    value,
                    replace(thrown, speed=speed),
                    steps=steps,
                    note=f"{count} steps",
                )
                if one.law in ("non_adhesive", "unclamped") and 0.4 < end <= 2e3:
                    falling = replace(one, ratio=0.4, end=end)
                    yield Scene(
                        "communication step", value, falling, steps=steps, note=f"falling, {count} steps"
                    )


def offset() -> Iterator[Scene]:
    for value in [0.0, *decades(0, 9)]:
        for one in variants():
            yield Scene("offset", value, replace(one, offset=value, penalty=1e8))


def start() -> Iterator[Scene]:
    """`value` is the overlap at the start over the way to the middle: 0 touching, 1 concentric"""
    for value in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999999, 1.0]:
        for one in variants(hollow=False):
            for speed in (1.0, 0.0, -1.0):
                placed = replace(one, place=one.reach * (1 - value), gap=0.0, speed=speed, end=0.05)
                yield Scene("start", value, placed, note=f"{speed:g} m/s")
    for value in [0.0, 1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3]:
        for one in variants(hollow=True):
            for speed in (1.0, 0.0, -1.0):
                placed = replace(one, place=-one.reach * (1 + value), gap=0.0, speed=speed, end=0.05)
                yield Scene("start", value, placed, note=f"hollow, {speed:g} m/s")
    for one in variants(hollow=True):
        for speed in (1.0, 0.0):
            centred = replace(one, place=0.0, gap=one.reach, speed=speed, end=2.0)
            yield Scene("start", 1.0, centred, note=f"in the middle of a hollow body, {speed:g} m/s")


def rim() -> Iterator[Scene]:
    """A finite cylinder's end is passed during a contact, between contacts, or `value` before the touch"""
    for value in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1]:
        for geometry in GEOMETRIES[2:]:
            for law in LAWS:
                one = HeadOn(geometry=geometry, law=law, length=1.0, gravity=0.0, gap=0.125, penalty=1e4)
                touch, away = one.flight_time(), 0.5 * one.contact_time()
                for side in (1, -1):
                    for along_speed in (1.0, -1.0):
                        # at the rim `value` after or before the touch, or a half contact later
                        for late in (0.0, away):
                            along = 0.5 - along_speed * (touch + late + side * value)
                            moved = replace(one, along=along, along_speed=along_speed, end=0.5)
                            yield Scene(
                                "rim", value, moved, note=f"{along_speed:g} m/s, {side:+d}, {late:.2g} s"
                            )


def force() -> Iterator[Scene]:
    for value in decades(-3, 12):
        for one in variants():
            for penalty in (1e6, 1e13):
                pressed = replace(one, force=value, penalty=penalty, gravity=0.0)
                yield Scene("force", value, pressed, note=f"{penalty:g} N/m")


def jumps() -> Iterator[Scene]:
    """A prescribed destination jumps by `value` radii: at rest, into the ball, back, and beyond it"""
    for value in decades(-12, 6):
        for one in variants():
            for sign in (1, -1):
                end = 2.0 if value <= 0.1 else 40 * one.contact_time()
                moved = replace(one, prescribed=True, gravity=0.0, speed=0.6 / end, end=end)
                given = (Jump(2, sign * 0.5 * value), Jump(5, 0.0))
                yield Scene("jump", value, moved, steps=(8,), jumps=given, note=f"{sign:+d}")


def units(which: str) -> Iterator[Scene]:
    for kind, power, system in unit_systems():
        if kind == which:
            for number, base in enumerate(bases()):
                yield Scene(f"unit of {which}", power, Similar(number, system), note=base["name"])


def plane() -> Iterator[Scene]:
    """A ball on a plane: dropped, thrown, lying on it, and a plane that is free itself"""
    for value in decades(0, 15):
        for law in LAWS:
            one = HeadOn(geometry=PLANE, law=law, penalty=value)
            yield Scene("plane", value, one)
            yield Scene("plane", value, replace(one, speed=100.0, gravity=0.0), note="thrown")
            lying = replace(one, place=one.reach, gap=0.0, speed=0.0, end=min(0.1, 30 * one.contact_time()))
            yield Scene("plane", value, lying, note="set down")
            both = replace(one, source_mass=3.0, destination_mass=2.0, offset=1e3)
            yield Scene("plane", value, both, note="free plane")


def at_once() -> Iterator[Scene]:
    for group, number, motion in together.scenes():
        yield Scene("all at once", group, motion, note=f"number {number}")


FAMILIES = (
    Family("stiffness", "penalty factor, N/m", stiffness),
    Family("mass", "mass, kg", mass),
    Family("mass ratio", "mass of the source over that of the destination", mass_ratio),
    Family("size", "radius of the destination, m", size),
    Family("radius ratio", "large radius over small radius", radius_ratio),
    Family("clearance", "(r_d - r_s) / r_d", clearance),
    Family("speed", "speed at the start, m/s", speed),
    Family("bullet", "depth of the impact over the way to the middle", bullet),
    Family("damping", "damping over critical damping", damping),
    Family("viscous only", "viscous penalty factor, N s/m", viscous),
    Family("communication step", "communication step, s", communication_step),
    Family("offset", "place of both bodies, m", offset),
    Family("start", "overlap at the start over the way to the middle", start),
    Family("rim", "time between touch and end, s", rim),
    Family("force", "external force, N", force),
    Family("jump", "jump over the radius", jumps),
    Family("plane", "penalty factor, N/m", plane),
    Family("over the edge", "over the edge of a cap or side, over the radius", over_the_edge),
    Family("edge-on impact", "speed at the rim, m/s", edge_on),
    Family("modulus", "Young's modulus of both bodies, Pa", modulus),
    Family("restitution", "coefficient of restitution", restitution),
    Family("exponent", "exponent of the force law", exponent),
    Family("slip velocity", "characteristic slip velocity, m/s", slip_velocity),
    Family("friction", "coefficient of friction", friction),
    Family("spin", "back-spin at the start, rad/s", spin),
    Family("inertia ratio", "moment of inertia over m a^2", inertia_ratio),
    Family("tumbling rate", "angular velocity across the axis, rad/s", tumbling_rate),
    Family("all at once", "group of random scenes", at_once),
    Family("unit of length", "length unit, power of two", partial(units, "length")),
    Family("unit of mass", "mass unit, power of two", partial(units, "mass")),
    Family("unit of time", "time unit, power of two", partial(units, "time")),
    Family("unit of all", "length and half of time's power, less mass's", partial(units, "all")),
)


def all_scenes() -> list[Scene]:
    return [scene for family in FAMILIES for scene in family.make()]
