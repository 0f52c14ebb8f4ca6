"""The report's figures, each as SVG for the HTML page and as PNG for README.md"""

import itertools
from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_fmus.bench.problems import METHODS, STIFF_TOLERANCE, Problem, benchmarks, stiff_families

from . import tables
from .measure import SIMILAR, Row, stiff_setting

LOOKS = {"event_driven": ("#c2410c", "o"), "cvode_bdf": ("#1d4ed8", "s"), "cvode_adams": ("#0f766e", "^")}
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


def legend(figure: Figure, columns: int) -> None:
    """Each label of the panels once, above them"""
    shown: dict = {}
    for panel in figure.axes:
        handles, labels = panel.get_legend_handles_labels()
        shown = dict(zip(labels, handles, strict=True)) | shown
    figure.legend(shown.values(), shown.keys(), loc="outside upper center", ncols=columns, frameon=False)


def _draw(panel: Axes, solver: str, x: list[float], y: list[float], first: bool, label: str) -> None:
    """The first of two kinds of runs of a solver is filled, the other one dashed"""
    color, marker = LOOKS[solver]
    style = {"linestyle": "-", "linewidth": 1.3} if first else {"linestyle": "--", "linewidth": 0.9, "mfc": "white"}
    panel.plot(x, y, color=color, marker=marker, markersize=4.5, label=label, **style)


def _errors(points: Sequence[Row]) -> list[float]:
    return [max(row.error_m, FLOOR) for row in points]


def work_precision(rows: Sequence[Row], problems: Iterable[Problem], folder: Path, name: str) -> None:
    """Our solvers on an even number of problems"""
    chosen = list(problems)
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(len(chosen) // 2, 2, 3.6 * (len(chosen) // 2))
        for panel, problem in zip(axes, chosen, strict=True):
            found = tables.curves(rows, problem.name)
            least = min((steps for _, steps in found), default=1)
            for (solver, steps), points in found.items():
                label = f"{solver}, {tables.steps_of(steps)}"
                _draw(panel, solver, _errors(points), [row.time_s for row in points], steps == least, label)
            panel.set_title(f"{problem.name}: {problem.title}")
            panel.set(xlabel="error of the position at the end, m", ylabel="time, s")
        legend(figure, 3)
        save(figure, folder, name)


def peers(own: Sequence[Row], others: Sequence[Row], folder: Path) -> None:
    """All settings of the peers as points, a line through the best of each solver, dashed where its law is
    only similar; and our event_driven with the fewest communication steps"""
    others = [row for row in others if row.measured and row.error_m <= WORST]
    fewest = min(row.communication_steps for row in own)
    best = [row for row in own if (row.solver, row.communication_steps) == (METHODS[0], fewest)]
    solvers = list(dict.fromkeys(row.solver for row in others))
    colors = dict(zip(dict.fromkeys(solver.split()[0] for solver in solvers), itertools.cycle(PEER_COLORS)))
    styles = {METHODS[0]: LOOKS[METHODS[0]]}
    styles |= {solver: (colors[solver.split()[0]], "sD^vP*X"[k % 7]) for k, solver in enumerate(solvers)}
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(2, 2, 7.8)
        for panel, problem in zip(axes, benchmarks().values(), strict=True):
            for solver, (color, marker) in styles.items():
                points = [row for row in [*best, *others] if (row.problem, row.solver) == (problem.name, solver)]
                similar, front = any(row.law == SIMILAR for row in points), tables.front(points)
                style = {"color": color, "marker": marker, "markersize": 4.5}
                panel.plot(_errors(points), [row.time_s for row in points], ls="", alpha=0.35, mew=0, **style)
                style |= {"linestyle": "--" if similar else "-", "linewidth": 1.3}
                label = f"{solver}, similar law" if similar else solver if points else "_"
                panel.plot(_errors(front), [row.time_s for row in front], label=label, **style)
            panel.set_title(f"{problem.name}: {problem.title}")
            panel.set(xlabel="error of the position at the end, m", ylabel="time, s")
        legend(figure, 4)
        save(figure, folder, "peers")


def stiffness(rows: Sequence[Row], folder: Path) -> None:
    """Time above, error below; damped on the left, undamped on the right"""
    chosen = [row for row in rows if row.setting == stiff_setting(STIFF_TOLERANCE) and row.measured]
    chosen = [row for row in chosen if row.communication_steps == 1]
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(2, 2, 6.6)
        for name, family in stiff_families().items():
            _, shape, damping = name.replace(",", "").split()
            time, error = axes[damping == "undamped"], axes[2 + (damping == "undamped")]
            for method in METHODS:
                points = [row for row in chosen if (row.problem, row.solver) == (name, method)]
                stiff, kind = [row.parameter for row in points], (shape == "cylinder", f"{method}, hollow {shape}")
                _draw(time, method, stiff, [row.time_s for row in points], *kind)
                _draw(error, method, stiff, _errors(points), *kind)
            limit = [one.penalty_factor for one in family], [one.uncertainty for one in family]
            error.plot(*limit, color="#94a3b8", linestyle=":", zorder=1, label="what the reference is good for")
            title = "damped, 10 % of critical" if damping == "damped" else "undamped"
            time.set(title=f"{title}: time", xlabel="$p_n$, N/m", ylabel="time, s")
            error.set(title=f"{title}: error", xlabel="$p_n$, N/m", ylabel="error at the end, m")
        for left, right in ((axes[0], axes[1]), (axes[2], axes[3])):
            right.sharey(left)
        factors = [one.penalty_factor for family in stiff_families().values() for one in family]
        for panel in axes:
            panel.set_xlim(0.5 * min(factors), 2 * max(factors))
        legend(figure, 4)
        save(figure, folder, "stiffness")
