"""model.png: the icon of an FMU, drawn from the start of its scene, with nothing but the standard library.

Every shape is a signed distance in pixels, negative inside. Its edge is a pixel wide: lines are smooth.
"""

import math
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass

from .start import Start

SIZE = 200  # pixels; FMI 2.0.5, 2.3 asks for more than 100 x 100
MARGIN = 12.0  # pixels around what is drawn
LEAST = 7.0  # radius in pixels of the smallest body, so that it is seen
LINE = 2.2  # half width of outlines in pixels
SOURCE, DESTINATION = ((243, 217, 184), (160, 104, 66)), ((216, 226, 236), (92, 116, 140))  # fill and outline
FORCE = (187, 0, 0)
ARROW, HEAD = 56.0, 18.0  # length of an arrow and of its head, in pixels

Vector = tuple[float, float, float]
Distance = Callable[[float, float], float]


@dataclass(frozen=True)
class Layer:
    """A shape of one colour; the later ones cover the earlier."""

    color: tuple[int, int, int]
    distance: Distance
    box: tuple[float, float, float, float]  # left, top, right, bottom of what it may touch


def draw(start: Start) -> bytes:
    """The PNG"""
    view = View(start)
    pixels = bytearray(4 * SIZE * SIZE)
    for layer in view.layers():
        _paint(pixels, layer)
    return _png(pixels)


def _dot(a: Vector, b: Vector) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _unit(a: Vector) -> Vector:
    length = math.hypot(*a)
    return tuple(x / length for x in a)


class View:
    """Where bodies are on the icon: z upwards, unless one looks along it."""

    def __init__(self, start: Start):
        self.start, self.scene = start, start.scene
        self.scale, self.middle = 1.0, [0.0, 0.0]
        sight = self._sight()
        up = (0.0, 0.0, 1.0) if abs(sight[2]) < 0.9 else (0.0, 1.0, 0.0)
        self.right = _unit(_cross(sight, up))
        self.up = _cross(self.right, sight)
        places = [self._place(body) for body in range(len(self.scene.bodies))]
        self.flat = [(_dot(place, self.right), -_dot(place, self.up)) for place in places]
        self.sizes = [self._size(body) for body in range(len(places))]
        self._fit(())
        for _ in range(3):  # the arrow has its length in pixels, so that the scale moves its tip
            self._fit((self.arrow()[1],))

    def _fit(self, more: tuple[tuple[float, float], ...]) -> None:
        """Scale and places in pixels, with room for `more` points in pixels of the scale before."""
        points = [((x - SIZE / 2) / self.scale + self.middle[0], (y - SIZE / 2) / self.scale + self.middle[1])
                  for x, y in more]  # fmt: skip
        bodies = list(zip(self.flat, self.sizes, strict=True)) + [(point, 0.0) for point in points]
        spans = [(min(p[k] - r for p, r in bodies), max(p[k] + r for p, r in bodies)) for k in (0, 1)]
        self.scale = (SIZE - 2 * MARGIN) / max(high - low for low, high in spans)
        self.middle = [(low + high) / 2 for low, high in spans]
        self.at = [tuple(SIZE / 2 + self.scale * (p[k] - self.middle[k]) for k in (0, 1)) for p in self.flat]
        self.radius = [max(self.scale * r, LEAST) for r in self.sizes]

    def _source_over(self, plane: int) -> int:
        return next(contact.source for contact in self.scene.contacts if contact.destination == plane)

    def _place(self, body: int) -> Vector:
        """Its centre; of a plane the foot of the source that it meets."""
        place = self.start.centre(body)
        if not self.start.is_plane(body):
            return place
        above, normal = self.start.centre(self._source_over(body)), self._normal(body)
        height = _dot(tuple(a - p for a, p in zip(above, place, strict=True)), normal)
        return tuple(a - height * n for a, n in zip(above, normal, strict=True))

    def _size(self, body: int) -> float:
        """Radius, of a torus the outer one; of a plane how deep a strip of it is to be seen."""
        if self.start.is_plane(body):
            return 0.5 * self.start.radius(self._source_over(body))
        ring = self.start.value("body.ring_radius", body) if self.start.is_torus(body) else 0.0
        return self.start.radius(body) + ring

    def _normal(self, plane: int) -> Vector:
        return _unit(self.start.value("body.axis", plane))

    def _axis(self, body: int) -> Vector | None:
        if self.scene.bodies[body].shape not in ("cylinder", "torus"):
            return None
        return _unit(self.start.value("body.axis", body))

    def _sight(self) -> Vector:
        """Into the icon: along the axis of a hollow cylinder, across a solid one's or across the centres."""
        for index, contact in enumerate(self.scene.contacts):
            axis = self._axis(contact.destination)
            if axis and self.start.inside(index) and not self.start.is_torus(contact.destination):
                return axis
            if self.start.is_plane(contact.destination):
                normal = self._normal(contact.destination)
                return _unit(_cross(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 0.0, 1.0)))
            places = (
                self.start.centre(contact.destination, contact.destination_part),
                self.start.centre(contact.source, contact.source_part),
            )
            between = tuple(b - a for a, b in zip(*places, strict=True))
            along = axis or (0.0, 0.0, 1.0)
            across = _cross(along, between)
            if math.hypot(*across) > 1e-9 * math.hypot(
                *between
            ):  # else they lie on one line: any view shows them
                return _unit(across)
            if axis and abs(axis[2]) < 0.9:
                return _unit(_cross(axis, (0.0, 0.0, 1.0)))
        return (0.0, 1.0, 0.0)

    def layers(self):
        """Destinations, the force on the first source, and the sources above all."""
        sources = {contact.source for contact in self.scene.contacts}
        for body in set(range(len(self.at))) - sources:
            yield from self._body(body, *DESTINATION)
        yield from self._force()
        for body in sources:
            yield from self._body(body, *SOURCE)

    def _body(self, body: int, fill: tuple, line: tuple):
        distance, box = self._shape(body)
        if not self.is_hollow(body):
            yield Layer(fill, distance, box)
        width = 2 * LINE if self.is_hollow(body) else LINE
        yield Layer(line, lambda x, y: abs(distance(x, y) + width / 2) - width / 2, box)

    def is_hollow(self, body: int) -> bool:
        return any(
            contact.destination == body and self.start.inside(j)
            for j, contact in enumerate(self.scene.contacts)
        )

    def tube(self, body: int) -> tuple[list[tuple[float, float]], float]:
        """Of a torus, cut along its axis: middles of both sections of its tube, their radius, in pixels."""
        (x, y), axis = self.at[body], self._axis(body)
        e = (_dot(axis, self.right), -_dot(axis, self.up))  # seen from the side
        ring = self.scale * self.start.value("body.ring_radius", body)
        middles = [(x - side * ring * e[1], y + side * ring * e[0]) for side in (-1.0, 1.0)]
        return middles, max(self.scale * self.start.radius(body), LEAST)

    def side_view(self, body: int) -> tuple[tuple[float, float], float] | None:
        """Of a cylinder seen from its side: direction of the axis, half length in pixels. Else a circle."""
        axis = None if self.start.is_torus(body) else self._axis(body)
        if axis is None:
            return None
        e = (_dot(axis, self.right), -_dot(axis, self.up))
        seen = math.hypot(*e)  # 1 from the side, 0 from the end
        if seen <= 0.3:
            return None
        finite = self.start.value("body.finite_length", body)
        half = self.scale * seen * self.start.value("body.length", body) / 2 if finite else 2.0 * SIZE
        return (e[0] / seen, e[1] / seen), half

    def parts(self, body: int) -> list[tuple[tuple[float, float], float]]:
        """Of a compound: centres and radii of its spheres, in pixels"""
        return [(self.end(body, part), self.scale * part.radius) for part in self.scene.bodies[body].parts]

    def end(self, body: int, part) -> tuple[float, float]:
        """The centre of a body, or of a part of it, in pixels"""
        if not part:
            return self.at[body]
        place = self.start.centre(body, part)
        flat = _dot(place, self.right), -_dot(place, self.up)
        return tuple(SIZE / 2 + self.scale * (flat[k] - self.middle[k]) for k in (0, 1))

    def half_space(self, body: int) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Of a plane, always seen from its side: a point of its surface and its normal, in pixels."""
        if not self.start.is_plane(body):
            return None
        normal = self._normal(body)
        return self.at[body], (_dot(normal, self.right), -_dot(normal, self.up))

    def _shape(self, body: int) -> tuple[Distance, tuple]:
        (x0, y0), radius = self.at[body], self.radius[body]
        floor = self.half_space(body)
        if floor:
            _, (nx, ny) = floor
            deep = _rectangle(x0 - SIZE * nx, y0 - SIZE * ny, (ny, -nx), 2.0 * SIZE, SIZE)
            return deep, (0, 0, SIZE, SIZE)
        if self.start.is_torus(body):
            middles, tube = self.tube(body)
            return lambda x, y: min(math.dist((x, y), one) for one in middles) - tube, (0, 0, SIZE, SIZE)
        parts = self.parts(body)
        if parts:
            return lambda x, y: min(math.dist((x, y), at) - r for at, r in parts), (0, 0, SIZE, SIZE)
        side = self.side_view(body)
        if side:
            return _rectangle(x0, y0, side[0], side[1], radius), (0, 0, SIZE, SIZE)
        box = (x0 - radius - 1, y0 - radius - 1, x0 + radius + 1, y0 + radius + 1)
        return lambda x, y: math.hypot(x - x0, y - y0) - radius, box

    def arrow(self) -> tuple:
        """Tail, tip and direction: from the source's centre away from the surface that it touches."""
        contact = self.scene.contacts[0]
        x, y = self.end(contact.source, contact.source_part)
        x0, y0 = self.end(contact.destination, contact.destination_part)
        if self.start.is_torus(contact.destination):
            x0, y0 = min(self.tube(contact.destination)[0], key=lambda one: math.dist(one, (x, y)))
        e = self._away(contact.destination, x - x0, y - y0)
        if self.start.inside(0):
            e = (-e[0], -e[1])
        radius = self.scale * self.start.radius(contact.source, contact.source_part)
        length = max(ARROW, max(radius, LEAST) + HEAD)  # its head is seen beyond the source
        return (x, y), (x + length * e[0], y + length * e[1]), e

    def _force(self):
        tail, tip, e = self.arrow()
        half = (math.dist(tail, tip) - HEAD + 2.0) / 2  # the head goes on from there
        everywhere = (0, 0, SIZE, SIZE)
        shaft = _rectangle(tail[0] + half * e[0], tail[1] + half * e[1], e, half, 2.0)
        yield Layer(FORCE, shaft, everywhere)
        yield Layer(FORCE, _head(tip, e), everywhere)

    def _away(self, body: int, dx: float, dy: float) -> tuple[float, float]:
        floor = self.half_space(body)
        if floor:
            return floor[1]
        axis = self._axis(body)
        if axis and not self.start.is_torus(body):
            e = (_dot(axis, self.right), -_dot(axis, self.up))
            along = dx * e[0] + dy * e[1]
            dx, dy = dx - along * e[0], dy - along * e[1]
        length = math.hypot(dx, dy)
        return (dx / length, dy / length) if length > 1e-9 * SIZE else (0.0, -1.0)


def _rectangle(x0: float, y0: float, e: tuple[float, float], half: float, radius: float) -> Distance:
    """Along e by `half`, across by `radius`, either way."""

    def distance(x: float, y: float) -> float:
        along = abs((x - x0) * e[0] + (y - y0) * e[1]) - half
        across = abs((x - x0) * e[1] - (y - y0) * e[0]) - radius
        return math.hypot(max(along, 0.0), max(across, 0.0)) + min(max(along, across), 0.0)

    return distance


def _head(tip: tuple[float, float], e: tuple[float, float]) -> Distance:
    """The head of an arrow: 14 pixels wide."""

    def distance(x: float, y: float) -> float:
        behind = (tip[0] - x) * e[0] + (tip[1] - y) * e[1]
        aside = abs((x - tip[0]) * e[1] - (y - tip[1]) * e[0])
        return max(behind - HEAD, (aside * HEAD - behind * 7.0) / math.hypot(HEAD, 7.0))

    return distance


def _paint(pixels: bytearray, layer: Layer) -> None:
    left, top, right, bottom = (min(max(int(limit), 0), SIZE) for limit in layer.box)
    for row in range(top, min(bottom + 1, SIZE)):
        for column in range(left, min(right + 1, SIZE)):
            cover = 0.5 - layer.distance(column + 0.5, row + 0.5)
            if cover <= 0.0:
                continue
            cover = min(cover, 1.0)
            at = 4 * (SIZE * row + column)
            below = pixels[at + 3] / 255
            alpha = cover + below * (1 - cover)
            for k in range(3):
                mixed = (layer.color[k] * cover + pixels[at + k] * below * (1 - cover)) / alpha
                pixels[at + k] = round(mixed)
            pixels[at + 3] = round(255 * alpha)


def _png(pixels: bytearray) -> bytes:
    """W3C, Portable Network Graphics: 8 bits of red, green, blue and alpha, no filter"""
    rows = b"".join(b"\0" + pixels[4 * SIZE * row : 4 * SIZE * (row + 1)] for row in range(SIZE))

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 6, 0, 0, 0)
    parts = chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows, 9)), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)
