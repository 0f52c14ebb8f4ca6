"""Families of the atlas at the rim of a capped cylinder"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from .edge import TURN, Edge
from .head_on import LAWS
from .scene import Scene, decades

LINEAR_OR_HERTZ = ((False, "linear"), (True, "hertz"))


def over_the_edge() -> Iterator[Scene]:
    """A ball comes down on the cap, or across the side, and its centre passes the edge so far inside or
    outside: it meets the face, or the rim, or passes"""
    for value in [0.0, *decades(-12, 0)]:
        for law in LAWS[:4]:
            for hertz, name in LINEAR_OR_HERTZ:
                one = Edge(law=law, hertz=hertz)
                for angle, face in ((TURN, "cap"), (0.0, "side")):
                    for sign in (1, -1) if value else (1,):
                        moved = replace(one, angle=angle, offset=sign * value * one.destination_radius)
                        yield Scene("over the edge", value, moved, note=f"{name}, {face}, {sign:+d}")


def edge_on() -> Iterator[Scene]:
    """At the rim along the bisector, dead centre and beside it, and parallel to the cap, at all speeds, soft
    and stiff"""
    for value in decades(-6, 6, 2):
        for law in LAWS[:4]:
            for hertz, name in LINEAR_OR_HERTZ:
                for depth in (1e-6, 1e-3, 0.1, 0.5):
                    one = Edge(law=law, hertz=hertz, speed=value, depth=depth)
                    for angle, part in ((math.pi / 4, 0.0), (math.pi / 4, 0.3), (0.0, 0.3), (0.0, 0.6)):
                        if depth + part > 0.75:
                            continue  # it may go on over the cap
                        moved = replace(one, angle=angle, offset=part * one.source_radius)
                        note = f"{name}, {depth:g} deep, {angle:.2g} rad, {part:g} aside"
                        yield Scene("edge-on impact", value, moved, note=note)
