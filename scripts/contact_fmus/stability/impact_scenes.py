"""Families of the atlas along the parameters of an impact, with Hertz's law and the linear one"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .head_on import LAWS, HeadOn
from .impact import GEOMETRIES, Impact
from .scene import Scene, decades

DAMPED = LAWS[1:4]  # the dashpots


def modulus() -> Iterator[Scene]:
    for value in decades(5, 13):
        for geometry in GEOMETRIES:
            one = Impact(geometry=geometry, modulus=value)
            yield Scene("modulus", value, replace(one, law="undamped"))
            for law in DAMPED:
                yield Scene("modulus", value, replace(one, law=law, restitution=0.7), note="restitution 0.7")
                free = replace(one, law=law, damped=0.3, destination_mass=2.0)
                yield Scene("modulus", value, free, note="Hunt-Crossley, both free")


def restitution() -> Iterator[Scene]:
    for value in (0.0, 1e-6, 1e-3, 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.999, 1.0):
        for geometry in GEOMETRIES:
            for law in DAMPED:
                hertz = Impact(geometry=geometry, law=law, restitution=value)
                yield Scene("restitution", value, hertz, note="hertz")
                linear = HeadOn(geometry=geometry, law=law, restitution=value, gravity=0.0)
                yield Scene("restitution", value, linear, note="linear")


def exponent() -> Iterator[Scene]:
    """1: the linear law, 3/2: Hertz's, from creeping to a bullet's speed; the depth is the same"""
    for geometry in GEOMETRIES:
        for law in LAWS[:4]:
            for speed in decades(-6, 6, 3):
                e = None if law == "undamped" else 0.7
                penalty = (speed / 1e-3) ** 2
                linear = HeadOn(
                    geometry=geometry, law=law, restitution=e, gravity=0.0, speed=speed, penalty=penalty
                )
                yield Scene("exponent", 1.0, linear, note=f"{speed:g} m/s")
                stiffness = 1.25 * speed**2 / 1e-3**2.5
                hertz = Impact(geometry=geometry, law=law, restitution=e, speed=speed, stiffness=stiffness)
                yield Scene("exponent", 1.5, hertz, note=f"{speed:g} m/s")
