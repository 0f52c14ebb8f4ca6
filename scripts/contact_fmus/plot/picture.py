"""Panels of one result, or of several over each other, as a picture: PNG, SVG or PDF; with the path or without"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .panels import Panel, threshold, together, touches, values
from .path import COLORS, EDGE, draw_path, is_wide
from .source import Run, motion_of

STYLE = Path(__file__).with_suffix(".mplstyle")
LINES = ("-", "--", ":", "-.")  # where several runs are compared: one for each body or contact
LEAST_SPAN = 1e-6  # of what an axis shows: less is rounding, and is drawn as what stays the same
# matplotlib writes the date and random names into SVG and PDF otherwise: the same result gives the same file.
FIXED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}
MARKED = 60  # contacts that are marked, at most: more would cover the lines


def draw(title: str, runs: list[Run], panels: list[Panel], file: Path, path: bool = False) -> None:
    """The contacts of the first run are shaded. `path`: the bodies' ways are drawn to scale beside the panels."""
    with mpl.rc_context({"svg.hashsalt": "contact-fmus"}, fname=STYLE):
        height = 0.9 + 1.75 * len(panels)
        figure = Figure(figsize=(11.0, max(7.2, height)) if path else (9.5, height), dpi=120, layout="constrained")
        figure.suptitle(title, fontsize=13, fontweight="bold", x=0.01, ha="left")
        if path:
            motions = [motion_of(run.result) for run in runs]
            way, rows = layout(figure, is_wide(motions), len(panels))
            draw_path(way, motions)
        else:
            rows = list(figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0])
        marks = touches(runs[0].result)
        for axes, panel in zip(rows, panels, strict=True):
            _draw_panel(axes, panel, runs)
            # Shaded while in contact, a line at each onset: a contact may be narrower than a pixel.
            for begin, end in together(marks[:MARKED]):
                axes.axvspan(begin, end, color=COLORS[1], alpha=0.10, linewidth=0)
            for begin in {touch.begin for touch in marks[:MARKED]}:
                axes.axvline(begin, color=COLORS[1], alpha=0.35, linewidth=0.6)
            below = axes.get_subplotspec().is_last_row()
            axes.tick_params(labelbottom=below)
            axes.set_xlabel("time [s]" if below else "")
        rows[0].set_xlim(runs[0].result.time[0], runs[0].result.time[-1])
        if marks:
            count = f"{len(marks)} contact{'s' if len(marks) > 1 else ''}"
            told = f"{count}, shaded" if len(marks) <= MARKED else f"{count}, the first {MARKED} shaded"
            rows[0].set_title(told, loc="right", fontsize=8, fontweight="normal", color=EDGE)
        file.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(file, metadata=FIXED[file.suffix])


def layout(figure: Figure, wide: bool, panels: int) -> tuple[Axes, list[Axes]]:
    """The path's axes beside those over time, or above them where the path is long and low"""
    if not wide:
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


def _draw_panel(axes: Axes, panel: Panel, runs: list[Run]) -> None:
    axes.set_title(panel.title)
    axes.set_ylabel(f"[{panel.unit}]" if panel.unit else "")
    drawn: list[np.ndarray] = []
    for number, run in enumerate(runs):
        for index, line in enumerate(panel.lines):
            y = values(run.result, line.name)
            place = index if line.color is None else line.color
            color = COLORS[(number if len(runs) > 1 else place) % len(COLORS)]
            style = LINES[index % len(LINES)] if len(runs) > 1 or index >= len(COLORS) else "-"
            if line.sum and len(runs) == 1:
                color, style = "black", "--"
            axes.plot(run.result.time, y, style, color=color)
            drawn.append(y)
    linear = threshold(drawn)
    if linear is not None and "gap" in panel.title:
        axes.set_yscale("symlog", linthresh=linear)
        axes.axhline(0.0, color=EDGE, linewidth=0.8)
    calm(axes)
    _explain(axes, panel, runs)


def _explain(axes: Axes, panel: Panel, runs: list[Run]) -> None:
    """Where there are several runs, colours tell the run and kinds of lines the quantity. The legend has each once."""
    if len(runs) == 1:
        names = [line.label for line in panel.lines] if len(panel.lines) > 1 else []
        shown = list(zip(axes.lines, names, strict=False))
    else:
        shown = [(Line2D([], [], color=COLORS[i % len(COLORS)]), run.label) for i, run in enumerate(runs)]
        kinds = enumerate(panel.lines if len(panel.lines) > 1 else ())
        shown += [(Line2D([], [], color=EDGE, linestyle=LINES[i % len(LINES)]), one.label) for i, one in kinds]
    if shown:
        handles, labels = zip(*shown, strict=True)
        axes.legend(handles, labels, loc="center left", bbox_to_anchor=(1.0, 0.5))
