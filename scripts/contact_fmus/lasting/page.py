"""Figure and tables of the comparison of Radau IIA and exponential collocation"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from contact_fmus.report import figures

from .point import Point

COLORS = ("#94a3b8", "#0369a1", "#6d28d9", "#4d7c0f")  # of Radau IIA's stages
OWN = "#c2410c"
SHOWN = (1e5, 1e7, 1e9, 1e11)
WANTED = 1e-9  # m
LEFT_OUT = [f"Radau IIA, {stages} stages, plane" for stages in (3, 5, 12)]  # of the long table


def _names(points: Sequence[Point]) -> list[str]:
    return list(dict.fromkeys(point.method for point in points))


def _of(points: Sequence[Point], **wanted) -> list[Point]:
    return [point for point in points if all(getattr(point, name) == value for name, value in wanted.items())]


def _styles(points: Sequence[Point]) -> dict[str, dict]:
    """Those in the plane are drawn in the tables only."""
    space = [name for name in _names(points) if name.startswith("Radau") and not name.endswith("plane")]
    styles = {
        name: {"color": color, "marker": "s", "markersize": 3.5}
        for name, color in zip(space, COLORS, strict=True)
    }
    own = {
        name: {"color": OWN, "marker": "o", "markersize": 5} for name in _names(points) if name not in styles
    }
    return styles | {name: style for name, style in own.items() if not name.startswith("Radau")}


def _power(penalty: float) -> str:
    return f"$10^{{{round(math.log10(penalty))}}}$"


def draw(points: Sequence[Point], amplitudes: Sequence[float], folder: Path) -> None:
    """Error against step, a row of panels damped, one undamped with the oscillation's amplitude"""
    styles = _styles(points)
    with mpl.rc_context(figures.STYLE):
        figure = Figure(figsize=(9.6, 5.4), layout="constrained")
        panels = figure.subplots(2, len(SHOWN), sharex=True, sharey=True)
        dampings = list(dict.fromkeys(point.damping for point in points))
        for row, damping in zip(panels, dampings, strict=True):
            for panel, penalty, swing in zip(row, SHOWN, amplitudes, strict=True):
                here = _of(points, damping=damping, penalty=penalty)
                _draw_panel(panel, here, styles, None if damping else swing)
                panel.set_title(f"{'damped' if damping else 'undamped'}, {_power(penalty)} N/m")
            row[0].set_ylabel("error of the position\nafter 2 s, m")
        for panel in panels[-1]:
            panel.set_xlabel("step, s")
        marks = [Line2D([], [], label=name, **style) for name, style in styles.items()]
        marks.append(Line2D([], [], color="#475569", linestyle=":", label="amplitude of the oscillation"))
        figure.legend(handles=marks, loc="outside upper center", ncols=3, frameon=False)
        figures.save(figure, folder, "lasting")


def _draw_panel(panel, points: Sequence[Point], styles: dict[str, dict], swing: float | None) -> None:
    panel.set(xscale="log", yscale="log", ylim=(1e-16, 1.0))
    panel.set_xticks([0.4, 0.1, 0.02, 0.005], ["0.4", "0.1", "0.02", "0.005"])
    panel.minorticks_off()
    if swing:
        panel.axhline(swing, color="#475569", linestyle=":", zorder=1)
    for name, style in styles.items():
        found = [point for point in _of(points, method=name) if point.error is not None]
        panel.plot(
            [one.step for one in found], [max(one.error, 1e-16) for one in found], linewidth=1.2, **style
        )


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join([_row(header), _row(["---"] * len(header)), *map(_row, rows)])


def _short(number: float) -> str:
    """1e7, 2e-9"""
    digits, exponent = f"{number:.0e}".split("e")
    return f"{digits}e{int(exponent)}"


def _error(point: Point) -> str:
    return "–" if point.error is None else _short(point.error)


def cost_table(points: Sequence[Point], penalty: float, step: float) -> str:
    rows = []
    for name in _names(points):
        damped, undamped = (
            _of(points, method=name, penalty=penalty, step=step, damping=damping)[0]
            for damping in dict.fromkeys(point.damping for point in points)
        )
        work = [f"{damped.iterations}", f"{damped.evaluations}", f"{damped.solves or '–'}"]
        rows.append([name, _error(damped), _error(undamped), *work, f"{1e6 * damped.seconds:.0f}"])
    work = ["iterations", "evaluations", "linear solves", "time, µs"]
    return _table(["", "error damped, m", "error undamped, m", *work], rows)


def least_table(points: Sequence[Point]) -> str:
    """Least time in microseconds for an error of 1e-9 m, with the step that took it"""
    names = _names(points)
    rows = []
    for damping in dict.fromkeys(point.damping for point in points):
        for penalty in dict.fromkeys(point.penalty for point in _of(points, damping=damping)):
            cells = ["damped" if damping else "undamped", _short(penalty)]
            for name in names:
                there = _of(points, method=name, damping=damping, penalty=penalty)
                good = [point for point in there if point.error is not None and point.error <= WANTED]
                best = min(good, key=lambda point: point.seconds, default=None)
                cells.append(f"{1e6 * best.seconds:.0f} ({best.step:g} s)" if best else "–")
            rows.append(cells)
    return _table(["", "p_n, N/m", *names], rows)


def print_tables(points: Sequence[Point]) -> None:
    print("\np_n = 1e7 N/m, 10 steps of 0.2 s\n")
    print(cost_table(points, 1e7, 0.2))
    print(f"\nLeast time for an error of {_short(WANTED)} m, µs (step)\n")
    print(least_table([point for point in points if point.method not in LEFT_OUT]))
