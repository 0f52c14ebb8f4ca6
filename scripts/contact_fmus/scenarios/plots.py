"""One picture a scenario: the path to scale, and position, gap, force and energy over time"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon

from .experiment import ENERGIES, Recording

# One for each run, or for each body and contact of a single run
COLORS = ("#1f6fb4", "#d95f02", "#2b9348", "#8e44ad", "#b58900", "#b4235a", "#0097a7", "#7b4f2e", "#7f7f7f")
COLORS += ("#e0559a",)
BODY, EDGE = "#e3e7ee", "#4a5568"
STYLE = Path(__file__).with_suffix(".mplstyle")
LINES = ("-", "--", ":", "-.")  # where several runs are compared: one for each body or contact
FAR = 1e20  # a gap beyond this stands for infinity and is not drawn
THINNEST = 200.0  # a path with sides of such a ratio would be a line to scale
LEVEL = 1e-3  # motion whose rise is less than this part of its extent both ways is seen from above
LOWEST = 14.0  # the ratio of sides of a path's panel, at most
WIDE = 4.0  # a path with sides of such a ratio lies above the other panels, not beside them
STEADY = 1e-3  # a force that changes by less than this part of it is drawn with zero in sight
LEAST_SPAN = 1e-6  # of what an axis shows: less is rounding, and is drawn as what stays the same


def draw(runs: list[Recording], file: Path) -> Path:
    """Several runs are drawn over each other, one colour each."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(fname=STYLE):
        figure = Figure(figsize=(11.0, 7.2), dpi=120, layout="constrained")
        figure.suptitle(runs[0].scenario.title, fontsize=13, fontweight="bold", x=0.01, ha="left")
        panels = [_position, _gap, _force] + ([_energy] if "energy.kinetic" in runs[0].series else [])
        path, rows = _layout(figure, runs, len(panels))
        _path(path, runs)
        for axes, panel in zip(rows, panels, strict=True):
            panel(axes, runs)
            calm(axes)
            if axes.get_legend_handles_labels()[0]:
                axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
            below = axes.get_subplotspec().is_last_row()
            axes.tick_params(labelbottom=below)
            axes.set_xlabel("time [s]" if below else "")
        axes.set_xlim(runs[0].time[0], runs[0].time[-1])
        figure.savefig(file)
    return file


def _layout(figure: Figure, runs: list[Recording], panels: int) -> tuple[Axes, list[Axes]]:
    """The path's axes beside those over time, or above them where the path is long and low"""
    plane = _drawn_plane(runs[0])
    reach = max(runs[0].motion.radius(body) or 0.0 for body in _movers(runs[0]))
    tracks = [run.motion.position(body) @ plane.T for run in runs for body in _movers(run)]
    wide, high = np.ptp(np.concatenate(tracks), axis=0) + 2.0 * reach
    if wide < WIDE * high:
        grid = figure.add_gridspec(panels, 2, width_ratios=(1.0, 1.25))
        path, places = figure.add_subplot(grid[:, 0]), [grid[row, 1] for row in range(panels)]
    else:
        half = (panels + 1) // 2
        grid = figure.add_gridspec(1 + half, 2, height_ratios=(0.45, *[1.0] * half))
        path = figure.add_subplot(grid[0, :])
        places = [grid[1 + index % half, index // half] for index in range(panels)]
    rows: list[Axes] = []
    for place in places:
        rows.append(figure.add_subplot(place, sharex=rows[0] if rows else None))
    return path, rows


def calm(axes: Axes) -> None:
    """Rounding is not drawn as if it were motion, and labels are the values themselves"""
    if axes.get_yscale() != "linear":
        return
    low, high = axes.get_ylim()
    size = max(abs(low), abs(high))
    if high - low < LEAST_SPAN * size:
        axes.set_ylim(0.5 * (low + high) - 0.5 * size, 0.5 * (low + high) + 0.5 * size)
    axes.ticklabel_format(axis="y", useOffset=False)


def _movers(run: Recording) -> list[str]:
    """Bodies that move, or the source of the first contact where none does"""
    moving = [body.name for body in run.motion.scene.bodies if run.motion.moves(body.name)]
    return moving or [run.motion.scene.contacts[0].source]


def _color(index: int) -> str:
    return COLORS[index % len(COLORS)]


# the path


def _reference(run: Recording) -> str:
    """The body that the others are seen against: one that stands still and is hit, where there is one"""
    hit = [contact.destination for contact in run.motion.scene.contacts]
    return next((body for body in hit if not run.motion.moves(body)), hit[0])


def _horizontal(run: Recording) -> np.ndarray:
    """The drawn plane's horizontal unit vector: where the bodies go, or along x or y next to a cylinder"""
    motion, reference = run.motion, _reference(run)
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


def _seen_from_above(run: Recording) -> bool:
    """Where all motion is level and goes both ways"""
    x, y, z = np.max([np.ptp(run.motion.position(body), axis=0) for body in _movers(run)], axis=0)
    return bool(z < LEVEL * min(x, y))


def _drawn_plane(run: Recording) -> np.ndarray:
    """Two unit vectors as rows: to the right and up in the picture"""
    above = _seen_from_above(run)
    return np.array([np.eye(3)[0] if above else _horizontal(run), np.eye(3)[1 if above else 2]])


def _path(axes: Axes, runs: list[Recording]) -> None:
    above, plane = _seen_from_above(runs[0]), _drawn_plane(runs[0])
    horizontal = plane[0]
    along = [name for name, component in zip("xyz", horizontal, strict=True) if abs(component) > 1.0 - 1e-9]
    axes.set_title("path, from above" if above else "path")
    axes.set_xlabel(f"{along[0]} [m]" if along else f"along ({horizontal[0]:.2g}, {horizontal[1]:.2g}, 0) [m]")
    axes.set_ylabel("y [m]" if above else "z [m]")
    axes.set_aspect("equal", adjustable="box")
    axes.set_axisbelow(True)
    movers = _movers(runs[0])
    for body in runs[-1].motion.scene.bodies:
        if body.name not in movers and not (above and runs[0].motion.is_plane(body.name)):
            _draw_standing(axes, runs[-1], body.name, plane)
    for number, run in enumerate(runs):
        for index, body in enumerate(movers):
            color = _color(number if len(runs) > 1 else index)
            _draw_moving(axes, run, body, plane, color, ghosts=len(runs) == 1)
    axes.autoscale_view()
    wide, high = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    if max(wide, high) > THINNEST * min(wide, high):
        axes.set_title("path, not to scale")
        axes.set_aspect("auto")
    elif wide > LOWEST * high:  # room for the labels of a low strip
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - 0.5 * wide / LOWEST, middle + 0.5 * wide / LOWEST)


def _draw_moving(axes: Axes, run: Recording, body: str, plane: np.ndarray, color: str, ghosts: bool) -> None:
    track = run.motion.position(body) @ plane.T
    axes.plot(*track.T, color=color, label=run.variant.label or body, linewidth=1.0)
    if ghosts and not run.motion.is_hollow(body):
        for index in np.searchsorted(run.time, np.linspace(run.time[0], run.time[-1], 7)):
            look = {"facecolor": color, "alpha": 0.15}
            axes.add_patch(_outline(run, body, int(index), plane, look))
    look = {"facecolor": "none", "edgecolor": color, "linewidth": 1.2}
    axes.add_patch(_outline(run, body, -1, plane, look))


def _draw_standing(axes: Axes, run: Recording, body: str, plane: np.ndarray) -> None:
    fill = "none" if run.motion.is_hollow(body) else BODY
    look = {"facecolor": fill, "edgecolor": EDGE, "linewidth": 1.2, "zorder": 0.8}
    axes.add_patch(_outline(run, body, -1, plane, look))


def _outline(run: Recording, body: str, index: int, plane: np.ndarray, look: dict) -> Patch:
    """At one time: a circle; a rectangle for a plane and for a cylinder that is not seen along its axis"""
    center, axis = plane @ run.motion.position(body)[index], run.motion.axis_at(body, index)
    if axis is not None and run.motion.is_plane(body):
        return _strip(run, body, center, plane @ axis, plane, look)
    radius = run.motion.radius(body) or 0.0
    along = np.zeros(2) if axis is None else plane @ axis
    if np.linalg.norm(along) < 0.5:
        return Circle(center, radius, **look)
    length = run.motion.length(body)
    ends, side = along * (2.0 * radius if length is None else 0.5 * length), np.array([-along[1], along[0]])
    side = side / np.linalg.norm(side) * radius
    corners = [center + a * ends + b * side for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return Polygon(corners, **look)


def _strip(run: Recording, body: str, center: np.ndarray, normal: np.ndarray, plane: np.ndarray, look: dict) -> Patch:
    """A plane is drawn below all places of its sources, as deep as a ball."""
    normal = normal / np.linalg.norm(normal)
    level = np.array([-normal[1], normal[0]])
    sources = [one.source for one in run.motion.contacts_of(body)]
    along = np.concatenate([(run.motion.position(one) @ plane.T - center) @ level for one in sources])
    deep = max(run.motion.radius(one) for one in sources)
    low, high = np.min(along) - 2.0 * deep, np.max(along) + 2.0 * deep
    corners = [center + a * level - b * normal for a, b in ((low, 0), (high, 0), (high, deep), (low, deep))]
    return Polygon(corners, **look)


# over time


def _position(axes: Axes, runs: list[Recording]) -> None:
    movers = _movers(runs[0])
    axes.set_ylabel("position [m]")
    if len(runs) == 1 and len(movers) == 1:
        axes.set_title(f"position of the {movers[0]}")
        values = runs[0].motion.position(movers[0])
        for component in range(3):
            axes.plot(runs[0].time, values[:, component], color=_color(component), label="xyz"[component])
        return
    ranges = sum(np.ptp(runs[0].motion.position(body), axis=0) for body in movers)
    component = int(np.argmax(ranges))
    whose = f"of the {movers[0]}" if len(movers) == 1 else "of the bodies"
    axes.set_title(f"position {whose}, {'xyz'[component]}")
    _compare(axes, runs, movers, lambda run, body: run.motion.position(body)[:, component])


def _gap(axes: Axes, runs: list[Recording]) -> None:
    axes.set_title("gap")

    def gap(run: Recording, contact: str) -> np.ndarray:
        values = run.series[f"{contact}.gap"]
        return 1e3 * np.where(values < FAR, values, np.nan)

    contacts = _contacts(runs[0])
    drawn = np.concatenate([gap(run, contact) for run in runs for contact in contacts])
    deepest, widest = (-np.nanmin(drawn), np.nanmax(drawn)) if np.any(np.isfinite(drawn)) else (0.0, 0.0)
    if 0.0 < deepest < 0.05 * widest:  # penetrations next to flights: linear below, logarithmic above
        axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(deepest)))
    axes.axhline(0.0, color=EDGE, linewidth=0.8)
    _compare(axes, runs, contacts, gap)
    if deepest > 0.0:
        axes.axhspan(axes.get_ylim()[0], 0.0, color="#d95f02", alpha=0.07)
    axes.set_ylabel("gap [mm]")


def _force(axes: Axes, runs: list[Recording]) -> None:
    contacts = _contacts(runs[0])
    drawn = [run.series[f"{contact}.normal_force"] for run in runs for contact in contacts]
    largest = max(float(np.max(np.abs(values))) for values in drawn)
    axes.set_title("normal force")
    _compare(axes, runs, contacts, lambda run, contact: run.series[f"{contact}.normal_force"])
    if max(float(np.ptp(values)) for values in drawn) < STEADY * largest:
        least, most = min(map(np.min, drawn)), max(map(np.max, drawn))
        axes.set_ylim(min(0.0, 1.3 * float(least)), max(0.0, 1.3 * float(most)))
    axes.set_ylabel("force [N]")


def _contacts(run: Recording) -> list[str]:
    return [contact.name for contact in run.motion.scene.contacts]


def _energy(axes: Axes, runs: list[Recording]) -> None:
    axes.set_ylabel("energy [J]")
    if len(runs) > 1:
        sizes = {name: max(np.ptp(run.series[f"energy.{name}"]) for run in runs) for name in ("dissipated", "kinetic")}
        term = "dissipated" if sizes["dissipated"] > 1e-6 * sizes["kinetic"] else "kinetic"
        axes.set_title(f"{term} energy")
        _compare(axes, runs, [f"energy.{term}"], lambda run, name: run.series[name])
        return
    axes.set_title("energy")
    known = {name: runs[0].series.get(f"energy.{name}") for name in ENERGIES}
    # A model in which nothing turns or rubs has no such terms, or they stay zero.
    always = ("kinetic", "potential", "contact", "dissipated")
    terms = {
        name: values
        for name, values in known.items()
        if values is not None and (name in always or np.any(values != 0.0))
    }
    work = runs[0].series["energy.external_work"]
    for index, (name, values) in enumerate(terms.items()):
        axes.plot(runs[0].time, values, color=_color(index), label="stored" if name == "contact" else name)
    axes.plot(runs[0].time, sum(terms.values()) - work, color="black", linestyle="--", label="sum")


def _compare(
    axes: Axes, runs: list[Recording], names: list[str], values: Callable[[Recording, str], np.ndarray]
) -> None:
    """A line for each run and name; what tells them apart, runs or names, has the colours"""
    for number, run in enumerate(runs):
        for index, name in enumerate(names):
            several = [run.variant.label] * (len(runs) > 1) + [name] * (len(names) > 1)
            color = _color(number if len(runs) > 1 else index)
            line = LINES[index % len(LINES)] if len(runs) > 1 else "-"
            axes.plot(run.time, values(run, name), line, color=color, label=", ".join(several) or None)
