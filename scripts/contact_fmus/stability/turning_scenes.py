"""Families of the atlas whose bodies turn: a ball that slides and rolls, a cylinder that tumbles"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .rolling import Rolling, Tumbling
from .scene import Scene, decades


def slip_velocity() -> Iterator[Scene]:
    """From Coulomb's friction to one that creeps"""
    for value in decades(-12, 1):
        for speed, spin in ((2.0, 0.0), (0.5, -40.0)):
            one = Rolling(speed=speed, spin=spin, slip_velocity=value)
            yield Scene("slip velocity", value, one, note=f"spin {spin:g} rad/s")


def friction() -> Iterator[Scene]:
    for value in decades(-9, 6):
        yield Scene("friction", value, Rolling(friction=value))
        yield Scene("friction", value, Rolling(friction=value, spin=-40.0), note="back-spin")


def spin() -> Iterator[Scene]:
    for value in [0.0, *decades(-6, 6)]:
        for speed in (0.0, 1.0, 100.0):
            if speed or value:
                one = Rolling(speed=speed, spin=-value, slip_velocity=1e-3)
                yield Scene("spin", value, one, note=f"{speed:g} m/s")


def inertia_ratio() -> Iterator[Scene]:
    """A solid ball has 2/5, a hollow one 2/3"""
    for value in [*decades(-9, 9), 0.4, 2.0 / 3.0]:
        yield Scene("inertia ratio", value, Rolling(inertia=value))


def tumbling_rate() -> Iterator[Scene]:
    for value in decades(-6, 6):
        one = Tumbling(rate=value)
        yield Scene("tumbling rate", value, one)
        yield Scene("tumbling rate", value, replace(one, end=1.01 * one.touch), note="up to the impact")
