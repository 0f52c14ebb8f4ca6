"""What is wrong with the start of a scene, found before its FMU is built.

Contradictions that fmi2ExitInitializationMode would refuse are errors; a deep overlap is a warning.
"""

import math

from .cell import Cell, shortest
from .conditions import number_of
from .resolve import Resolved
from .scene import Contact, Part

# Overlaps deeper than this part of the smaller radius are warned of: penalty contacts stand for small
# deformations.
DEEP = 0.1


def check_start(resolved: Resolved) -> list[str]:
    """Raises InputError for what no FMU would accept; returns warnings, one line each."""
    start = Start(resolved)
    for choices, unless, text in resolved.refusals():
        if all(cell.value in numbers for cell, numbers in choices) and (unless is None or unless.fails()):
            numbers = tuple(shortest(cell.value) for cell in unless.cells) if unless else ()
            raise resolved.scene.error(text % numbers)
    for body, one in enumerate(resolved.scene.bodies):
        start.check_orientation(body) if one.parts else None
    for contact in resolved.scene.contacts:
        start.check_axes(contact)
    warnings = (start.overlap(index, contact) for index, contact in enumerate(resolved.scene.contacts))
    return [text for text in warnings if text]


def rotated(orientation, vector) -> tuple[float, ...]:
    """A vector turned by a quaternion q = (w, u) of any length: with unit length q a q* is
    2 (u.a) u + (w^2 - u^2) a + 2 w u x a."""
    w, *u = (part / math.hypot(*orientation) for part in orientation)
    along, scale = 2.0 * sum(p * a for p, a in zip(u, vector, strict=True)), w * w - sum(p * p for p in u)
    cross = (
        u[1] * vector[2] - u[2] * vector[1],
        u[2] * vector[0] - u[0] * vector[2],
        u[0] * vector[1] - u[1] * vector[0],
    )
    return tuple(along * p + scale * a + 2.0 * w * c for p, a, c in zip(u, vector, cross, strict=True))


class Start:
    """The values that the FMU has when no one sets any."""

    def __init__(self, resolved: Resolved):
        self.scene = resolved.scene
        self.cells = {(cell.row.key, cell.element): cell for cell in resolved.cells}

    def cell(self, key: str, element: int) -> Cell:
        return self.cells[key, element]

    def value(self, key: str, element: int):
        return self.cell(key, element).value

    def is_item(self, key: str, element: int, item: str) -> bool:
        cell = self.cell(key, element)
        return cell.value == number_of(cell.row, item)

    def check_axes(self, contact: Contact) -> None:
        for body in (contact.source, contact.destination):
            if self.scene.bodies[body].shape not in ("sphere", "compound"):
                self.check_axis(body)

    def check_orientation(self, body: int) -> None:
        cell = self.cell("body.initial_orientation", body)
        if not any(cell.value):
            raise self.scene.error(
                f"'{cell.name}' is {list(cell.value)!r}, which is no rotation "
                "(allowed: at least one component other than zero)"
            )

    def is_torus(self, body: int) -> bool:
        return self.scene.bodies[body].shape == "torus"

    def is_plane(self, body: int) -> bool:
        return self.scene.bodies[body].shape == "plane"

    def check_axis(self, body: int) -> None:
        axis = self.cell("body.axis", body)
        if not any(axis.value):
            raise self.scene.error(
                f"'{axis.name}' is {list(axis.value)!r}, which has no direction "
                "(allowed: at least one component other than zero)"
            )

    def centre(self, body: int, part: Part | None = None) -> list[float]:
        """Of a body, or of a part of a compound"""
        moved = {"free": "body.initial_displacement", "prescribed": "body.prescribed_displacement"}
        place = self.value("body.center", body)
        for item, key in moved.items():
            if self.is_item("body.motion", body, item):
                place = [x + u for x, u in zip(place, self.value(key, body), strict=True)]
        if part:
            turned = rotated(self.value("body.initial_orientation", body), part.center)
            place = [x + o for x, o in zip(place, turned, strict=True)]
        return list(place)

    def has_location(self, contact: Contact) -> bool:
        return not self.is_plane(contact.destination) and not contact.destination_part

    def automatic(self, index: int) -> bool:
        return self.has_location(self.scene.contacts[index]) and self.is_item(
            "contact.location", index, "automatic"
        )

    def inside(self, index: int) -> bool:
        """Whether the source is in a hollow destination, by choice or by where it starts."""
        contact = self.scene.contacts[index]
        if not self.has_location(contact):
            return False
        if not self.automatic(index):
            return self.is_item("contact.location", index, "inside")
        r_s, r_d = self.radius(contact.source, contact.source_part), self.radius(contact.destination)
        distance = self.distance(contact)
        return distance is not None and distance < r_d and r_s < r_d

    def radius(self, body: int, part: Part | None = None) -> float:
        """0 of a plane; of a compound without a part what reaches round it"""
        parts = self.scene.bodies[body].parts
        if part or parts:
            return part.radius if part else max(math.hypot(*one.center) + one.radius for one in parts)
        return 0.0 if self.is_plane(body) else self.value("body.radius", body)

    def overlap(self, index: int, contact: Contact) -> str:
        """'' where the bodies are apart or overlap a little."""
        source, destination = contact.source, contact.destination
        r_s, r_d = (
            self.radius(source, contact.source_part),
            self.radius(destination, contact.destination_part),
        )
        distance = self.distance(contact)
        if distance is None:
            return ""
        depth = r_s + distance - r_d if self.inside(index) else r_s + r_d - distance
        if not depth > DEEP * (min(r_s, r_d) or r_s):  # a plane has no radius
            return ""
        first, second = (self.scene.bodies[body].name for body in (source, destination))
        return (
            f"{first} starts {depth:.3g} m deep in {second}, more than a tenth of the smaller radius: a "
            "penalty contact throws them apart. Set their centers, radii or displacements under [start]"
            + (f", or {contact.name}.location" if self.automatic(index) else "")
        )

    def distance(self, contact: Contact) -> float | None:
        """From the source's centre to the destination's centre, axis or middle circle, None beyond ends of a
        cylinder, beside a race and of skew cylinders; the height above a plane, negative below it."""
        destination = contact.destination
        here = self.centre(contact.source, contact.source_part)
        there = self.centre(destination, contact.destination_part)
        between = [other - one for other, one in zip(there, here, strict=True)]
        if self.scene.bodies[destination].shape in ("sphere", "compound"):
            return math.hypot(*between)
        axis = self.value("body.axis", destination)
        length = math.hypot(*axis)
        unit = [component / length for component in axis]
        along = sum(c * e for c, e in zip(between, unit, strict=True))
        if self.is_plane(destination):
            return -along
        if self.scene.bodies[contact.source].shape == "cylinder":
            other = self.value("body.axis", contact.source)
            if abs(sum(a * e for a, e in zip(other, unit, strict=True))) < (1.0 - 1e-12) * math.hypot(*other):
                return None
        rho = math.hypot(*(c - along * e for c, e in zip(between, unit, strict=True)))
        if self.is_torus(destination):
            beyond = rho - self.value("body.ring_radius", destination)
            races = {"inner_race": beyond > 0.0, "outer_race": beyond < 0.0}
            beside = any(self.is_item("body.side", destination, one) and out for one, out in races.items())
            return None if beside else math.hypot(beyond, along)
        if self.value("body.finite_length", destination) and abs(along) > 0.5 * self.value(
            "body.length", destination
        ):
            return None
        return rho
