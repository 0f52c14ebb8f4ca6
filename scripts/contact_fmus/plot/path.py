"""The path of a run's bodies, to scale: those that stand still, ways, and where bodies are at times"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Annulus, Circle, Patch, Polygon

from contact_fmus.scenarios.experiment import Motion

# One for each run, or for each body and contact of a single run
COLORS = ("#1f6fb4", "#d95f02", "#2b9348", "#8e44ad", "#b58900", "#b4235a", "#0097a7", "#7b4f2e", "#7f7f7f")
COLORS += ("#e0559a",)
BODY, EDGE = "#e3e7ee", "#4a5568"
THINNEST = 200.0  # a path with sides of such a ratio would be a line to scale
LEVEL = 1e-3  # motion whose rise is less than this part of its extent both ways is seen from above
LOWEST = 14.0  # the ratio of sides of a path's panel, at most
WIDE = 4.0  # a path with sides of such a ratio lies above other panels, not beside them


def is_wide(motions: list[Motion]) -> bool:
    plane, movers = _drawn_plane(motions[0]), _movers(motions[0])
    reach = max(motions[0].radius(body) or 0.0 for body in movers)
    tracks = [motion.position(body) @ plane.T for motion in motions for body in movers]
    wide, high = np.ptp(np.concatenate(tracks), axis=0) + 2.0 * reach
    return bool(wide >= WIDE * high)


def draw_path(axes: Axes, motions: list[Motion]) -> None:
    """Several runs are drawn over each other, one colour each."""
    above, plane = _seen_from_above(motions[0]), _drawn_plane(motions[0])
    horizontal = plane[0]
    along = [name for name, component in zip("xyz", horizontal, strict=True) if abs(component) > 1.0 - 1e-9]
    axes.set_title("path, from above" if above else "path")
    axes.set_xlabel(f"{along[0]} [m]" if along else f"along ({horizontal[0]:.2g}, {horizontal[1]:.2g}, 0) [m]")
    axes.set_ylabel("y [m]" if above else "z [m]")
    axes.set_aspect("equal", adjustable="box")
    axes.set_axisbelow(True)
    movers = _movers(motions[0])
    for body in (one.name for one in motions[-1].scene.bodies if one.name not in movers):
        if not (above and motions[0].is_plane(body)):
            fill = "none" if motions[-1].is_hollow(body) else BODY
            look = {"facecolor": fill, "edgecolor": EDGE, "linewidth": 1.2, "zorder": 0.8}
            axes.add_patch(outline(motions[-1], body, -1, plane, look))
    for number, motion in enumerate(motions):
        for index, body in enumerate(movers):
            color = COLORS[(number if len(motions) > 1 else index) % len(COLORS)]
            _draw_moving(axes, motion, body, plane, color, ghosts=len(motions) == 1)
    axes.autoscale_view()
    wide, high = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    if max(wide, high) > THINNEST * min(wide, high):
        axes.set_title("path, not to scale")
        axes.set_aspect("auto")
    elif wide > LOWEST * high:  # room for the labels of a low strip
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - 0.5 * wide / LOWEST, middle + 0.5 * wide / LOWEST)


def _movers(motion: Motion) -> list[str]:
    """Bodies that move, or the source of the first contact where none does"""
    moving = [body.name for body in motion.scene.bodies if motion.moves(body.name)]
    return moving or [motion.scene.contacts[0].source]


def _horizontal(motion: Motion) -> np.ndarray:
    """The drawn plane's horizontal unit vector: where the bodies go, or along x or y next to a cylinder. They are seen
    against one that stands still and is hit, where there is one."""
    hit = [contact.destination for contact in motion.scene.contacts]
    reference = next((body for body in hit if not motion.moves(body)), hit[0])
    others = [body.name for body in motion.scene.bodies if body.name != reference]
    apart = np.concatenate([motion.position(name) - motion.position(reference) for name in others])
    apart[:, 2] = 0.0
    if motion.is_plane(reference):  # so that it is seen from its side
        normal = np.array([*motion.axis(reference)[:2], 0.0])
        if np.linalg.norm(normal) > 1e-9:
            return _forward(normal / np.linalg.norm(normal))
    elif any(motion.axis(body.name) is not None for body in motion.scene.bodies):
        return np.eye(3)[int(np.argmax(np.max(np.abs(apart), axis=0)))]
    farthest = apart[int(np.argmax(np.linalg.norm(apart, axis=1)))]
    length = np.linalg.norm(farthest)
    return _forward(farthest / length) if length > 0.0 else np.eye(3)[0]


def _forward(direction: np.ndarray) -> np.ndarray:
    """Along an axis of the world frame its positive end is on the right, as the numbers beside it say"""
    component = int(np.argmax(np.abs(direction)))
    return np.eye(3)[component] if abs(direction[component]) > 1.0 - 1e-9 else direction


def _seen_from_above(motion: Motion) -> bool:
    """Where all motion is level and goes both ways"""
    x, y, z = np.max([np.ptp(motion.position(body), axis=0) for body in _movers(motion)], axis=0)
    return bool(z < LEVEL * min(x, y))


def _drawn_plane(motion: Motion) -> np.ndarray:
    """Two unit vectors as rows: to the right and up in the picture"""
    above = _seen_from_above(motion)
    return np.array([np.eye(3)[0] if above else _horizontal(motion), np.eye(3)[1 if above else 2]])


def _draw_moving(axes: Axes, motion: Motion, body: str, plane: np.ndarray, color: str, ghosts: bool) -> None:
    axes.plot(*(motion.position(body) @ plane.T).T, color=color, linewidth=1.0)
    if ghosts and not motion.is_hollow(body):
        for index in np.searchsorted(motion.time, np.linspace(motion.time[0], motion.time[-1], 7)):
            look = {"facecolor": color, "alpha": 0.15}
            axes.add_patch(outline(motion, body, int(index), plane, look))
    look = {"facecolor": "none", "edgecolor": color, "linewidth": 1.2}
    axes.add_patch(outline(motion, body, -1, plane, look))


def outline(motion: Motion, body: str, index: int, plane: np.ndarray, look: dict) -> Patch:
    """At one time: a circle, or two of a torus; a rectangle for what has an axis and is not seen along it"""
    center, turned = plane @ motion.position(body)[index], motion.series(f"{body}.current_axis")
    axis = motion.axis(body) if turned is None else turned[index]
    if axis is not None and motion.is_plane(body):
        return _strip(motion, body, center, plane @ axis, plane, look)
    radius, ring = motion.radius(body) or 0.0, motion.ring(body)
    along = np.zeros(2) if axis is None else plane @ axis
    if np.linalg.norm(along) < 0.5:
        return Annulus(center, ring + radius, 2.0 * radius, **look) if ring else Circle(center, radius, **look)
    length = 2.0 * radius if ring else motion.length(body)
    ends, side = along * (2.0 * radius if length is None else 0.5 * length), np.array([-along[1], along[0]])
    side = side / np.linalg.norm(side) * (radius + ring)
    corners = [center + a * ends + b * side for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return Polygon(corners, **look)


def _strip(motion: Motion, body: str, center: np.ndarray, normal: np.ndarray, plane: np.ndarray, look: dict) -> Patch:
    """A plane is drawn below all places of its sources, as deep as a ball."""
    normal = normal / np.linalg.norm(normal)
    level = np.array([-normal[1], normal[0]])
    sources = [one.source for one in motion.contacts_of(body)]
    along = np.concatenate([(motion.position(one) @ plane.T - center) @ level for one in sources])
    deep = max(motion.radius(one) for one in sources)
    low, high = np.min(along) - 2.0 * deep, np.max(along) + 2.0 * deep
    corners = [center + a * level - b * normal for a, b in ((low, 0), (high, 0), (high, deep), (low, deep))]
    return Polygon(corners, **look)
