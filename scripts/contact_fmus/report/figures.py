"""The report's figures, each as SVG for the HTML page and as PNG for README.md"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from contact_fmus.bench.problems import METHODS, STIFF_TOLERANCE, Problem, benchmarks, stiff_families

from . import tables
from .measure import SIMILAR, Row, stiff_setting

COLORS = {"event_driven": "#c2410c", "cvode_bdf": "#1d4ed8", "cvode_adams": "#0f766e"}
MARKERS = {"event_driven": "o", "cvode_bdf": "s", "cvode_adams": "^"}
PEER_COLORS = ("#6d28d9", "#0369a1", "#be185d", "#4d7c0f", "#475569", "#a16207", "#0d9488", "#57534e")
FLOOR = 1e-16  # m; errors of rounding and less are drawn here
WORST = 1.0  # m; peers that are further off are not drawn
STYLE = Path(__file__).with_suffix(".mplstyle")


def save(figure: Figure, folder: Path, name: str) -> None:
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None, "Creator": None})
    figure.savefig(folder / f"{name}.png", dpi=130, metadata={"Software": None})


def panels(rows: int, columns: int, height: float) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(9.6, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    for one in axes.flat:
        one.set(xscale="log", yscale="log")
        one.minorticks_off()
    return figure, list(axes.flat)


def work_precision(rows: Sequence[Row], problems: Iterable[Problem], folder: Path, name: str) -> None:
    """Our solvers on an even number of problems; marks of one communication step are filled"""
    chosen = list(problems)
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(len(chosen) // 2, 2, 3.6 * (len(chosen) // 2))
        for panel, problem in zip(axes, chosen, strict=True):
            found = tables.curves(rows, problem.name)
            least = min((steps for _, steps in found), default=1)
            for (solver, steps), points in found.items():
                color, filled = COLORS[solver], steps == least
                style = {"linestyle": "-", "linewidth": 1.3} if filled else {"linestyle": "--", "linewidth": 0.9}
                style |= {"color": color, "markerfacecolor": color if filled else "white"}
                _draw(panel, points, marker=MARKERS[solver], **style)
            panel.set_title(f"{problem.name}: {problem.title}")
            panel.set(xlabel="error of the position at the end, m", ylabel="time, s")
        steps = sorted({row.communication_steps for row in rows})
        legend(figure, [*_solver_marks(), *_step_marks(steps)])
        save(figure, folder, name)


def _draw(panel: Axes, points: Sequence[Row], **style: Any) -> None:
    errors = [max(row.error_m, FLOOR) for row in points]
    panel.plot(errors, [row.time_s for row in points], markersize=4.5, **style)


def _step_marks(steps: Sequence[int]) -> list[Line2D]:
    marks = []
    for count in steps:
        filled = count == steps[0]
        text = "one communication step" if count == 1 else f"{count} communication steps"
        face, line = ("#475569", "-") if filled else ("white", "--")
        marks.append(Line2D([], [], color="#475569", marker="o", markersize=5, mfc=face, linestyle=line, label=text))
    return marks


def legend(figure: Figure, marks: Sequence[Line2D], columns: int = 5) -> None:
    figure.legend(handles=marks, loc="outside upper center", ncols=min(columns, len(marks)), frameon=False)


def peers(own: Sequence[Row], others: Sequence[Row], folder: Path) -> None:
    """All settings of the peers as points, a line through the best of each solver, dashed where its law is
    only similar; and our event_driven with the fewest communication steps
    """
    others = [row for row in others if row.measured and row.error_m <= WORST]
    styles = _peer_styles(list(dict.fromkeys(row.solver for row in others)))
    fewest = min(row.communication_steps for row in own)
    best = [row for row in own if (row.solver, row.communication_steps) == (METHODS[0], fewest)]
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(2, 2, 7.8)
        for panel, problem in zip(axes, benchmarks().values(), strict=True):
            for solver, (color, marker) in styles.items():
                points = [row for row in others if (row.problem, row.solver) == (problem.name, solver)]
                dashed = any(row.law == SIMILAR for row in points)
                _draw_peer(panel, points, color, marker, dashed)
            points = [row for row in best if row.problem == problem.name]
            _draw_peer(panel, points, COLORS[METHODS[0]], "o", False)
            panel.set_title(f"{problem.name}: {problem.title}")
            panel.set(xlabel="error of the position at the end, m", ylabel="time, s")
        marks = [_mark(f"this FMU, {METHODS[0]}", COLORS[METHODS[0]], "o")]
        marks += [_mark(solver, *style) for solver, style in styles.items()]
        if any(row.law == SIMILAR for row in others):
            marks.append(Line2D([], [], color="#475569", linestyle="--", label="similar law"))
        legend(figure, marks, 4)
        save(figure, folder, "peers")


def _peer_styles(solvers: Sequence[str]) -> dict[str, tuple[str, str]]:
    """A color for each simulator, the first word of a solver's name, and a marker for each of its solvers"""
    simulators = list(dict.fromkeys(solver.split()[0] for solver in solvers))
    styles = {}
    for solver in solvers:
        which = simulators.index(solver.split()[0])
        earlier = sum(other.split()[0] == solver.split()[0] for other in styles)
        styles[solver] = (PEER_COLORS[which % len(PEER_COLORS)], "sD^vP*X"[earlier % 7])
    return styles


def _draw_peer(panel: Axes, points: Sequence[Row], color: str, marker: str, dashed: bool) -> None:
    style = {"color": color, "marker": marker}
    _draw(panel, points, linestyle="", alpha=0.35, markeredgewidth=0, **style)
    _draw(panel, tables.front(points), linestyle="--" if dashed else "-", linewidth=1.3, **style)


def _mark(label: str, color: str, marker: str) -> Line2D:
    return Line2D([], [], color=color, marker=marker, markersize=5, label=label)


def _solver_marks() -> list[Line2D]:
    return [_mark(solver, COLORS[solver], MARKERS[solver]) for solver in METHODS]


def stiffness(rows: Sequence[Row], folder: Path) -> None:
    """Time above, error below; damped on the left, undamped on the right"""
    chosen = [row for row in rows if row.setting == stiff_setting(STIFF_TOLERANCE) and row.measured]
    chosen = [row for row in chosen if row.communication_steps == 1]
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(2, 2, 6.6)
        for column, damping in enumerate(("damped", "undamped")):
            time, error = axes[column], axes[2 + column]
            for shape in ("cylinder", "sphere"):
                for method in METHODS:
                    name = f"stiff {shape}, {damping}"
                    points = [row for row in chosen if (row.problem, row.solver) == (name, method)]
                    style = {"color": COLORS[method], "marker": MARKERS[method], "markersize": 4.5}
                    style |= {"linewidth": 1.3, "linestyle": "-" if shape == "cylinder" else "--"}
                    style |= {"markerfacecolor": COLORS[method] if shape == "cylinder" else "white"}
                    stiff = [row.parameter for row in points]
                    time.plot(stiff, [row.time_s for row in points], **style)
                    error.plot(stiff, [max(row.error_m, FLOOR) for row in points], **style)
                family = stiff_families()[name]
                limit = [problem.penalty_factor for problem in family], [problem.uncertainty for problem in family]
                error.plot(*limit, color="#94a3b8", linestyle=":", zorder=1)
            title = "damped, 10 % of critical" if damping == "damped" else "undamped"
            time.set(title=f"{title}: time", xlabel="$p_n$, N/m", ylabel="time, s")
            error.set(title=f"{title}: error", xlabel="$p_n$, N/m", ylabel="error at the end, m")
        for left, right in ((axes[0], axes[1]), (axes[2], axes[3])):
            right.sharey(left)
        most = max(len(family) for family in stiff_families().values())
        for panel in axes:
            panel.set_xlim(0.5 * 1e5, 2 * 10.0 ** (4 + most))
        marks = _solver_marks()
        for shape, line, face in (("cylinder", "-", "#475569"), ("sphere", "--", "white")):
            style = {"color": "#475569", "marker": "o", "markersize": 5, "mfc": face, "linestyle": line}
            marks.append(Line2D([], [], label=f"in a hollow {shape}", **style))
        marks.append(Line2D([], [], color="#94a3b8", linestyle=":", label="what the reference is good for"))
        legend(figure, marks, 3)
        save(figure, folder, "stiffness")
