"""The measurements of study.py as sections of the report's page, tables on the terminal and a figure"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_fmus.pages import Table, read_words, show
from contact_fmus.scenarios.plots import STYLE

FIGURE = "force_element"
COLORS = {
    "at once": "#1f6fb4",
    "held": "#7f7f7f",
    "derivative 1": "#e0a100",
    "derivatives 1, 2": "#d95f02",
    "mean, predicted": "#8e44ad",
    "mean, iterated": "#2b9348",
}
LINES = {"at once": "-", "held": ":", "derivatives 1, 2": "--"}
DRAWN = ("bounce", "P1", "P3")


def sections(data: dict[str, Any]) -> list[dict[str, Any]]:
    """The sections, as report/measure.py describes them"""
    bounce = _problem(data, "bounce")
    wanted = {_key(curve): curve["steps_wanted"] for curve in bounce["curves"]}
    verlet = {coupling: wanted.get(("velocity Verlet", coupling)) for coupling in COLORS}
    counts = ", ".join(f"{_number(count)} ({coupling})" for coupling, count in verlet.items() if count)
    words = read_words(__file__)
    return [
        {
            "title": words["title"],
            "paragraphs": [one.replace("{counts}", counts or "more than were tried") for one in words["paragraphs"]],
            "tables": [_summary(data), *(_errors(data, name) for name in ("P1", "P3"))],
            "figures": [{"name": FIGURE, "caption": words["caption"]}],
        }
    ]


def _key(curve: dict[str, Any]) -> tuple[str, str]:
    return curve["integrator"], curve["coupling"]


def _problem(data: dict[str, Any], name: str) -> dict[str, Any]:
    return next(problem for problem in data["problems"] if problem["name"] == name)


def _number(value: Any, digits: int = 3) -> str:
    return value if isinstance(value, str) else "–" if value is None else f"{value:.{digits}g}"


def _limit(value: Any) -> str:
    return "none" if value == 0.0 else _number(value)


def _summary(data: dict[str, Any]) -> dict[str, Any]:
    header = ["integrator", "force"]
    for ratio in data["damping_ratios"]:
        header += [f"stable h omega, zeta = {ratio:g}: theory", "measured"]
    header += ["order", "steps per contact for 1 %"]
    orders = {_key(curve): curve["order"] for curve in _problem(data, "press")["curves"]}
    wanted = {_key(curve): curve["steps_wanted"] for curve in _problem(data, "bounce")["curves"]}
    rows = []
    for one in data["stable"]:
        row = [*_key(one)]
        for theory, measured in zip(one["theory"], one["measured"], strict=True):
            row += [_limit(theory), _limit(measured)]
        rows.append([*row, _number(orders[_key(one)], 2), _number(wanted[_key(one)])])
    caption = "Stable step in units of 1/omega, measured order in lasting contact, steps an impact wants"
    return {"caption": caption, "header": header, "rows": rows}


def _errors(data: dict[str, Any], name: str) -> dict[str, Any]:
    problem = _problem(data, name)
    steps = [point["step"] for point in problem["curves"][0]["points"]]
    header = ["integrator", "force", *(f"h = {step * 1e3:g} ms" for step in steps)]
    rows = [[*_key(curve), *(_number(point["error"], 2) for point in curve["points"])] for curve in problem["curves"]]
    caption = (
        f"{name}, {problem['title']}: error of the {problem['what']} in {problem['unit']}; "
        f"1/omega = {1e3 / problem['omega']:.3g} ms; –: the ball is lost"
    )
    return {"caption": caption, "header": header, "rows": rows}


def print_tables(data: dict[str, Any]) -> None:
    for section in sections(data):
        for table in section["tables"]:
            show(Table(**table, numbers=2))


def draw(data: dict[str, Any], folder: Path) -> None:
    """A row for each problem, a column for each integrator, a colour for each coupling"""
    integrators = list(dict.fromkeys(one["integrator"] for one in data["stable"]))
    with mpl.rc_context({"svg.hashsalt": FIGURE, "svg.fonttype": "none"}, fname=STYLE):
        figure = Figure(figsize=(11.0, 9.0), dpi=120, layout="constrained")
        grid = figure.subplots(len(DRAWN), len(integrators), sharey="row", sharex="row", squeeze=False)
        for row, name in zip(grid, DRAWN, strict=True):
            problem = _problem(data, name)
            for axes, integrator in zip(row, integrators, strict=True):
                _panel(axes, problem, integrator)
            row[0].set_ylabel(f"{name}: error [{problem['unit']}]")
        for axes, integrator in zip(grid[0], integrators, strict=True):
            axes.set_title(integrator)
        for axes in grid[-1]:
            axes.set_xlabel("communication step h ω")
        handles = {}
        for axes in grid.flat:
            found, labels = axes.get_legend_handles_labels()
            handles |= zip(labels, found, strict=True)
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(COLORS))
        for kind in ("svg", "png"):
            figure.savefig(folder / f"{FIGURE}.{kind}", metadata={"Date": None} if kind == "svg" else None)


def _panel(axes: Axes, problem: dict[str, Any], integrator: str) -> None:
    for curve in problem["curves"]:
        if curve["integrator"] != integrator:
            continue
        points = [(p["step"] * problem["omega"], p["error"]) for p in curve["points"] if p["error"]]
        points = [(step, error) for step, error in points if error < 10.0]
        if points:
            coupling = curve["coupling"]
            line = LINES.get(coupling, "-")
            axes.loglog(*zip(*points, strict=True), line, marker="o", ms=3, color=COLORS[coupling], label=coupling)
    axes.axvline(2.0, color="#aaaaaa", lw=0.8)
