"""The command animate: the page of one animation"""

from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.errors import UserError, similar
from contact_fmus.options import parse
from contact_fmus.pages import environment
from contact_fmus.plot import page
from contact_fmus.plot.page import numbers
from contact_fmus.plot.panels import touches, usual
from contact_fmus.plot.source import Run, motion_of, open_runs
from contact_fmus.results import Result, output_file
from contact_fmus.scenarios.closed_forms import cylinder_extent
from contact_fmus.scenarios.experiment import Motion
from contact_fmus.scenarios.scenario import ANY, find

# three.js, in one file that scripts/build_backend.py makes of its npm package when the project is set up or
# the wheel is built; it is no part of the repository.
FILE = Path(__file__).parent / "three.bundle.js"


def read_three() -> str:
    """The script that defines THREE, with its licence in a comment"""
    try:
        # The words that would end the page's script element
        return FILE.read_text(encoding="utf-8").replace("</script", "<\\/script")
    except FileNotFoundError:
        text = f"animations need three.js: {FILE} is missing; run scripts/build_backend.py in the clone"
        raise UserError(text) from None


# What an animation shows: bodies and contacts of one run as numbers for the page's script

ROWS = 20_000  # of a page, at most: 20 MB of positions and forces; a longer result is thinned
NEAR = 8.0  # a body that stands still is looked at as a whole while it is no larger than this times the rest
LEAST = 1e-300  # m; a scene smaller than a double can square is drawn as if it were this large


def thinned(result: Result) -> Result:
    """Every n-th row, the last one too"""
    stride = -(-len(result.time) // ROWS)
    if stride == 1:
        return result
    rows = np.unique(np.append(np.arange(0, len(result.time), stride), len(result.time) - 1))
    columns = {name: found[rows] for name, found in result.columns.items()}
    return Result(result.time[rows], columns, result.units, result.fmu, result.parameters)


def stage_content(result: Result, motion: Motion) -> dict[str, Any]:
    """What viewer/*.js read; lengths in m, times in s, arrays as base64 of doubles, vectors row by row"""
    center, radius = view(motion)
    return {
        "time": numbers(result.time),
        "bodies": [_body(motion, body.name, body.shape) for body in motion.scene.bodies],
        "contacts": [
            {
                "name": one.name,
                "source": one.source,
                "destination": one.destination,
                "point": _optional(motion.series(f"{one.name}.point")),
                "sourceForce": _optional(motion.series(f"{one.name}.source_force")),
                "destinationForce": _optional(motion.series(f"{one.name}.destination_force")),
            }
            for one in motion.scene.contacts
        ],
        "touches": [[one.begin, one.end, one.contact] for one in touches(result)],
        "view": {"center": center.tolist(), "radius": radius, "horizontal": _looked_along(motion)},
    }


def _optional(array: np.ndarray | None) -> str | None:
    return None if array is None else numbers(array)


def _body(motion: Motion, name: str, shape: str) -> dict[str, Any]:
    moves = motion.moves(name)
    position = _plane_place(motion, name) if motion.is_plane(name) else motion.position(name)
    axis, velocity = motion.axis(name), motion.series(f"{name}.velocity")
    return {
        "name": name,
        "shape": shape,
        "radius": motion.radius(name),
        "ring": motion.ring(name),
        "parts": motion.parts(name),
        "axis": None if axis is None else axis.tolist(),
        "length": motion.length(name),
        "reach": _gone_along(motion, name),
        "hollow": motion.is_hollow(name),
        "moves": moves,
        # What stands still for good is grey; what could move has a colour of its own.
        "colored": moves or motion.value(f"{name}.motion") in ("free", "prescribed"),
        "position": numbers(position if moves else position[:1]),
        # The page draws parabolas between the rows with it, and not straight lines.
        "velocity": _optional(velocity if moves else None),
        "orientation": _optional(motion.orientation(name)),
    }


def _gone_along(motion: Motion, body: str) -> float | None:
    """How far from its centre along an infinite cylinder the bodies that meet it go; None of other bodies"""
    axis = motion.axis(body)
    if axis is None or motion.shape(body) != "cylinder" or motion.length(body) is not None:
        return None
    pairs = [{one.source, one.destination} - {body} for one in motion.contacts_of(body)]
    away = [motion.position(other) - motion.position(body) for pair in pairs for other in pair]
    return max((float(np.max(np.abs(one @ axis))) for one in away), default=0.0)


def view(motion: Motion) -> tuple[np.ndarray, float]:
    """Centre and radius of what is looked at first: the bodies that move on all their way, and of the others
    those that would not make the moving ones too small to see"""
    boxes = {body.name: _box(motion, body.name) for body in motion.scene.bodies}
    moving = [name for name in boxes if motion.moves(name)] or [motion.scene.contacts[0].source]
    low = np.min([boxes[name][0] for name in moving], axis=0)
    high = np.max([boxes[name][1] for name in moving], axis=0)
    size = np.max(high - low)
    for name in boxes:
        joined = np.minimum(low, boxes[name][0]), np.maximum(high, boxes[name][1])
        if name not in moving and np.max(joined[1] - joined[0]) <= NEAR * size:
            low, high = joined
    # Halved first: the sum of two large coordinates could leave the range of a double.
    center, half = 0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low
    shown = [name for name in boxes if np.all(boxes[name][0] >= low) and np.all(boxes[name][1] <= high)]
    reach = max(_reach(motion, name, center) for name in shown)
    return center, max(min(reach, float(np.linalg.norm(half))), LEAST)


def _plane_place(motion: Motion, body: str) -> np.ndarray:
    """Where a plane is drawn: its point moved to below the middle of the way of what meets it, unless it
    turns"""
    point, normal = motion.position(body), motion.axis(body)
    if motion.orientation(body) is not None:
        return point  # it turns about that
    source = motion.position(next(one.source for one in motion.contacts_of(body)))
    middle = 0.5 * np.min(source, axis=0) + 0.5 * np.max(source, axis=0)
    away = middle - point[0]
    return point + (away - (away @ normal) * normal)


def _reach(motion: Motion, body: str, center: np.ndarray) -> float:
    """How far from the centre any point of the body gets, at most"""
    place = _plane_place(motion, body) if motion.is_plane(body) else motion.position(body)
    away = np.max(np.linalg.norm(place - center, axis=1))
    return float(away + np.hypot((motion.radius(body) or 0.0) + motion.ring(body), 0.5 * (motion.length(body) or 0.0)))


def _box(motion: Motion, body: str) -> tuple[np.ndarray, np.ndarray]:
    """The box around all its way. An infinite cylinder counts with its cross-section, a plane as its point."""
    if motion.is_plane(body):
        places = _plane_place(motion, body)
        return np.min(places, axis=0), np.max(places, axis=0)
    centers, axis = motion.position(body), motion.axis(body)
    radius = (motion.radius(body) or 0.0) + motion.ring(body)
    extent = np.full(3, radius)
    if axis is not None and not motion.ring(body):
        extent = cylinder_extent(radius, axis, motion.length(body) or 0.0)
    return np.min(centers, axis=0) - extent, np.max(centers, axis=0) + extent


def _looked_along(motion: Motion) -> list[float]:
    """A horizontal direction to look along first: across the way that is gone, and not along a cylinder"""
    spread = np.zeros(2)
    for body in motion.scene.bodies:
        spread += np.ptp(motion.position(body.name)[:, :2], axis=0) / motion.size()
        axis = motion.axis(body.name)
        if axis is not None and not motion.is_plane(body.name):
            spread += np.abs(axis[:2])
    return [0.0, 1.0] if spread[0] >= spread[1] else [-1.0, 0.0]


# Writes the page of one animation

HERE = Path(__file__).parent
SCRIPTS = ("path.js", "playback.js", "world.js", "overlay.js", "controls.js", "main.js")


def write_page(run: Run, file: Path) -> None:
    library = read_three()
    result = thinned(run.result)
    motion = motion_of(result)
    thin = Run(run.title, run.label, result)
    content: dict[str, Any] = stage_content(result, motion)
    content["times"] = [content["time"]]
    content["charts"] = [page.chart(panel, [thin]) for panel in usual(result)]
    template = environment(HERE, page.HERE).get_template("page.html")
    text = template.render(
        title=", ".join(part for part in (run.title, run.label) if part),
        scene=motion.scene.name,
        bodies=[body.name for body in motion.scene.bodies],
        library=library,
        scripts=[(HERE / "viewer" / name).read_text(encoding="utf-8") for name in SCRIPTS],
        data=page.script_json(content),
    )
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """0: written"""
    options = parse("animate", arguments)
    output = output_file(options.output, find(options.source, ANY).stem + ".html", (".html",))
    write_page(_chosen(open_runs(options.source, options.set, options.stop, options.fmu), options.variant), output)
    print(output)
    return 0


def _chosen(runs: list[Run], label: str | None) -> Run:
    if label is None:
        return runs[-1]
    found = [run for run in runs if run.label == label]
    if not found:
        labels = [run.label for run in runs if run.label]
        known = f"there are {', '.join(labels)}" if labels else "there is one run, without a label"
        raise UserError(f"--variant: no run '{label}'{similar(label, labels)}; {known}")
    return found[0]
