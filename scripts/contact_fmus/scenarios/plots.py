"""One picture a scenario: the path to scale, and position, gap, force and energy over time"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from .experiment import Recording

COLORS = ("#1f6fb4", "#d95f02", "#2b9348", "#8e44ad", "#7f7f7f")
BODY, EDGE = "#e3e7ee", "#4a5568"
STYLE = {
    "font.size": 9,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8,
}
FAR = 1e20  # a gap beyond this stands for infinity and is not drawn


def draw(runs: list[Recording], file: Path) -> Path:
    """Several runs are drawn over each other, one colour each."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 7.2), dpi=120, layout="constrained")
        figure.suptitle(runs[0].scenario.title, fontsize=13, fontweight="bold", x=0.01, ha="left")
        panels = [_position, _gap, _force] + ([_energy] if "energy.kinetic" in runs[0].series else [])
        grid = figure.add_gridspec(len(panels), 2, width_ratios=(1.0, 1.25))
        _path(figure.add_subplot(grid[:, 0]), runs)
        first = None
        for row, panel in enumerate(panels):
            first = axes = figure.add_subplot(grid[row, 1], sharex=first)
            panel(axes, runs)
            if axes.get_legend_handles_labels()[0]:
                axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
            axes.tick_params(labelbottom=row == len(panels) - 1)
        axes.set_xlabel("time [s]")
        axes.set_xlim(runs[0].time[0], runs[0].time[-1])
        figure.savefig(file)
    return file


def positions(run: Recording, body: str) -> np.ndarray:
    """Centre of a body at the communication points: an output, or what a fixed or driven body starts from"""
    if f"{body}.position" in run.series:
        return run.series[f"{body}.position"]
    driven = run.series.get(f"{body}.prescribed_displacement", np.zeros((len(run.time), 3)))
    return np.asarray(run.value(f"{body}.center")) + driven


def _label(run: Recording) -> str:
    return run.variant.label or "source"


# the path


def _horizontal(run: Recording) -> np.ndarray:
    """The drawn plane's horizontal unit vector: where the source goes, or along x or y next to a cylinder"""
    relative = positions(run, "source") - positions(run, "destination")
    relative[:, 2] = 0.0
    if run.has("destination.axis"):
        return np.eye(3)[int(np.argmax(np.max(np.abs(relative), axis=0)))]
    farthest = relative[int(np.argmax(np.linalg.norm(relative, axis=1)))]
    length = np.linalg.norm(farthest)
    return farthest / length if length > 0.0 else np.eye(3)[0]


def _path(axes: Axes, runs: list[Recording]) -> None:
    horizontal = _horizontal(runs[0])
    plane = np.array([horizontal, [0.0, 0.0, 1.0]])
    along = [name for name, component in zip("xyz", horizontal, strict=True) if abs(component) > 1.0 - 1e-9]
    axes.set_title("path")
    axes.set_xlabel(
        f"{along[0]} [m]" if along else f"along ({horizontal[0]:.2g}, {horizontal[1]:.2g}, 0) [m]"
    )
    axes.set_ylabel("z [m]")
    axes.set_aspect("equal", adjustable="box")
    axes.set_axisbelow(True)
    _draw_destination(axes, runs[-1], plane)
    radius = runs[0].value("source.radius")
    for run, color in zip(runs, COLORS, strict=False):
        track = positions(run, "source") @ plane.T
        axes.plot(*track.T, color=color, label=_label(run), linewidth=1.0)
        if len(runs) == 1:
            for index in np.linspace(0, len(track) - 1, 7).astype(int):
                axes.add_patch(Circle(track[index], radius, facecolor=color, alpha=0.15))
        axes.add_patch(Circle(track[-1], radius, facecolor="none", edgecolor=color, linewidth=1.2))
    axes.autoscale_view()


def _is_hollow(run: Recording) -> bool:
    location = run.value("contact.location")
    if location != "automatic":
        return location == "inside"
    apart, radius = (
        (positions(run, "source") - positions(run, "destination"))[0],
        run.value("destination.radius"),
    )
    if run.has("destination.axis"):
        axis = np.asarray(run.value("destination.axis"), dtype=float)
        apart = apart - (apart @ axis) / (axis @ axis) * axis
    return np.linalg.norm(apart) < radius and run.value("source.radius") < radius


def _draw_destination(axes: Axes, run: Recording, plane: np.ndarray) -> None:
    radius, center = run.value("destination.radius"), plane @ positions(run, "destination")[-1]
    fill = "none" if _is_hollow(run) else BODY
    look = {"facecolor": fill, "edgecolor": EDGE, "linewidth": 1.2, "zorder": 0.8}
    along = np.zeros(2)
    if run.has("destination.axis"):
        axis = np.asarray(run.value("destination.axis"), dtype=float)
        along = plane @ axis / np.linalg.norm(axis)
    if np.linalg.norm(along) < 0.5:  # seen along its axis, near enough
        axes.add_patch(Circle(center, radius, **look))
        return
    half = 0.5 * run.value("destination.length") if run.value("destination.finite_length") else 2.0 * radius
    axis, side = along * half, np.array([-along[1], along[0]]) * radius
    corners = [center + a * axis + b * side for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    axes.add_patch(Polygon(corners, **look))


# over time


def _position(axes: Axes, runs: list[Recording]) -> None:
    if len(runs) == 1:
        axes.set_title("position of the source")
        for component, color in zip(range(3), COLORS, strict=False):
            axes.plot(
                runs[0].time, positions(runs[0], "source")[:, component], color=color, label="xyz"[component]
            )
    else:
        component = int(np.argmax(np.ptp(positions(runs[0], "source"), axis=0)))
        axes.set_title(f"position of the source, {'xyz'[component]}")
        _compare(axes, runs, [positions(run, "source")[:, component] for run in runs])
    axes.set_ylabel("position [m]")


def _gap(axes: Axes, runs: list[Recording]) -> None:
    axes.set_title("gap")
    gaps = [
        1e3 * np.where(run.series["contact.gap"] < FAR, run.series["contact.gap"], np.nan) for run in runs
    ]
    drawn = np.concatenate(gaps)
    deepest, widest = -np.nanmin(drawn), np.nanmax(drawn)
    if 0.0 < deepest < 0.05 * widest:  # penetrations next to flights: linear below, logarithmic above
        axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(deepest)))
    axes.axhline(0.0, color=EDGE, linewidth=0.8)
    _compare(axes, runs, gaps)
    if deepest > 0.0:
        axes.axhspan(axes.get_ylim()[0], 0.0, color="#d95f02", alpha=0.07)
    axes.set_ylabel("gap [mm]")


def _force(axes: Axes, runs: list[Recording]) -> None:
    axes.set_title("normal force")
    _compare(axes, runs, [run.series["contact.normal_force"] for run in runs])
    axes.set_ylabel("force [N]")


def _energy(axes: Axes, runs: list[Recording]) -> None:
    axes.set_ylabel("energy [J]")
    if len(runs) > 1:
        sizes = {
            name: max(np.ptp(run.series[f"energy.{name}"]) for run in runs)
            for name in ("dissipated", "kinetic")
        }
        term = "dissipated" if sizes["dissipated"] > 1e-6 * sizes["kinetic"] else "kinetic"
        axes.set_title(f"{term} energy")
        _compare(axes, runs, [run.series[f"energy.{term}"] for run in runs])
        return
    axes.set_title("energy")
    terms = {
        name: runs[0].series[f"energy.{name}"] for name in ("kinetic", "potential", "contact", "dissipated")
    }
    work = runs[0].series["energy.external_work"]
    for (name, values), color in zip(terms.items(), COLORS, strict=False):
        axes.plot(runs[0].time, values, color=color, label="stored" if name == "contact" else name)
    axes.plot(runs[0].time, sum(terms.values()) - work, color="black", linestyle="--", label="sum")


def _compare(axes: Axes, runs: list[Recording], series: list[np.ndarray]) -> None:
    for run, values, color in zip(runs, series, COLORS, strict=False):
        axes.plot(run.time, values, color=color, label=_label(run) if len(runs) > 1 else None)
