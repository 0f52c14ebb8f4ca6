"""The page of the report: index.html, which holds its figures, and README.md next to them"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.bench.problems import (
    Problem,
    benchmarks,
    hertz_problems,
    shape_problems,
    stiff_families,
    turning_problems,
)
from contact_fmus.pages import Table, write_pages

from . import figures, tables
from .measure import Row, read_part, read_rows


@dataclass
class Section:
    """What stands under one heading"""

    title: str
    paragraphs: Sequence[str] = ()
    tables: Sequence[Table] = ()
    figures: Sequence[dict[str, str]] = field(default_factory=list)  # name and caption


def draw_page(folder: Path) -> list[Path]:
    """Reads what the parts left in the folder and writes figures, index.html and README.md."""
    own = read_rows(folder / "results.csv")
    measured = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    others = read_rows(folder / "peers.csv") if (folder / "peers.csv").is_file() else []
    parts = [read_part(folder / name) for name in ("peers.json", "force_element.json")]
    versions = dict(measured["versions"])
    for part in parts:
        versions |= part.get("versions", {})
    given = [given_section(section, folder) for part in parts for section in part.get("sections", ())]
    sections = [
        _summary(measured["ratios"], others),
        _work_precision(own, others, measured["ratios"], "sections" in parts[0], folder),
        *_shapes(own, measured.get("shape_ratios", ()), folder),
        *_hertz(own, measured.get("hertz_ratios", ()), folder),
        *_turning(own, measured.get("turning_ratios", ()), folder),
        _stiffness(own, folder),
        *given,
    ]
    contents = [(f"section-{k}", section.title) for k, section in enumerate(sections, 1)]
    contents.append(("versions", "Versions and machine"))
    context = {key: measured[key] for key in ("made", "plan")}
    context |= {"contents": contents, "versions": versions, "sections": sections}
    return write_pages(Path(__file__).parent, folder, context)


def _summary(ratios: list[dict], others: list[Row]) -> Section:
    listed = [tables.comparison(ratios, others), tables.problems()]
    return Section("Summary", tables.paragraphs(ratios, others), listed)


def _work_precision(own: list[Row], others: list[Row], ratios: list[dict], given: bool, folder: Path) -> Section:
    """`given`: the peers tell by themselves what could not be measured"""
    rows = tables.own_work_precision(own)
    figures.work_precision(rows, benchmarks().values(), folder, "work_precision")
    caption = "Error against time of the three solvers of the FMU, over relative tolerances."
    shown = [{"name": "work_precision", "caption": caption}]
    if figures.has_peers(others):
        figures.peers(rows, others, folder)
        caption = "The event-driven solver with the fewest communication steps, and other simulators over"
        caption += " their own step sizes or tolerances. A line joins the best settings of a solver; faint marks are"
        caption += f" the others; errors above {figures.WORST:g} m are left out."
        shown.append({"name": "peers", "caption": caption})
    every = [*rows, *others]
    listed = [tables.least_times(problem, every) for problem in benchmarks()]
    paragraphs = [
        "The error is the distance of the ball's centre at the end from the reference. A time is the median "
        "of the runs, of stepping alone: fmi2DoStep called by a C program, without loading and "
        "initialization. The absolute tolerance goes along at 1e-4 of the relative one."
    ]
    unable = [f"{row.solver}, {row.problem}: {row.note}" for row in others if not row.measured]
    if unable and not given:
        paragraphs.append("Not measured: " + "; ".join(dict.fromkeys(unable)) + ".")
    return Section("Error against time", paragraphs, [*listed, tables.ratios_table(ratios)], shown)


def _shapes(own: list[Row], ratios: Sequence[dict], folder: Path) -> list[Section]:
    """P1 and P2 on a plane, P1 to P3b over a rim, where they have been measured"""
    text = (
        "P1 and P2 with a plane in place of the sphere (P2 with 0.5 m/s along it), and P1 to P3b on a solid "
        "cylinder, 1 m wide and long, where the contact meets the sharp rims of its caps. P1: head-on on the "
        "rim of a tilted one, for 3 impacts: more would multiply the rounding of the start too often. P2: an "
        "impact on the upper rim, then one that begins on the cap and goes on over its lower rim. P3: a ball "
        "slides at 0.1 m/s over a level cap and, for 0.19 s, over its rim until it leaves. P3b: the same "
        "dropped from 10 mm, 34 impacts on the cap, 35 on the rim, and lasting contact there. The references "
        "are computed by extrapolation in extended precision."
    )
    figure = ("shapes", "Error against time on a plane and over a rim.")
    return _more_problems("Planes and rims", text, figure, shape_problems(), own, ratios, folder)


def _hertz(own: list[Row], ratios: Sequence[dict], folder: Path) -> list[Section]:
    """The same four by Hertz's law, where they have been measured"""
    text = (
        "P1 to P3b with $F_n = k_h delta^(3/2)$ in place of the penalty, as stiff or as deep; all but P1 "
        "are damped by Hunt and Crossley. P3b has 123 impacts. The references are computed by "
        "extrapolation in extended precision."
    )
    caption = "Error against time under Hertz's law."
    return _more_problems("Hertz's law", text, ("hertz", caption), hertz_problems(), own, ratios, folder)


def _turning(own: list[Row], ratios: Sequence[dict], folder: Path) -> list[Section]:
    """Friction and rotation, where they have been measured"""
    text = (
        "With regularized friction ($v_0$ = 1 mm/s, in bowl and tube 10 mm/s): a ball with "
        "back-spin that bounces, one that rolls in a bowl for 10 s, one in a golfer's tube, and a tumbling "
        "cylinder hit by a ball. The references are computed by independent code."
    )
    figure = ("turning", "Error against time with friction and rotation.")
    return _more_problems("Friction and rotation", text, figure, turning_problems(), own, ratios, folder)


def _more_problems(
    title: str,
    text: str,
    figure: tuple[str, str],  # name and caption
    problems: dict[str, Problem],
    own: list[Row],
    ratios: Sequence[dict],
    folder: Path,
) -> list[Section]:
    rows = [row for row in tables.own_work_precision(own) if row.problem in problems]
    if not rows:
        return []
    figures.work_precision(rows, problems.values(), folder, figure[0])
    listed = [*(tables.least_times(problem, rows) for problem in problems), tables.ratios_table(ratios)]
    return [Section(title, [text], listed, [{"name": figure[0], "caption": figure[1]}])]


def _stiffness(own: list[Row], folder: Path) -> Section:
    figures.stiffness(own, folder)
    families = stiff_families()
    listed = [tables.stiffness(name, family, own) for name, family in families.items()]
    caption = "Time and error against the penalty factor; one communication step for the whole time."
    paragraphs = [
        "Problem P3, the ball let go at the wall of a hollow cylinder, and the same in a hollow sphere, with "
        "the dashpot at 10 % of critical damping and without one. Runs that take too long are ended, and "
        "stiffer contacts are then not tried with that solver."
    ]
    figure = {"name": "stiffness", "caption": caption}
    return Section("Stiffness", paragraphs, [tables.growth(families, own), *listed], [figure])


def given_section(section: dict[str, Any], folder: Path) -> Section:
    """A section of peers.json or force_element.json (measure.py describes it)"""
    listed = [
        Table(one.get("caption", ""), one["header"], [[_text(cell) for cell in row] for row in one["rows"]])
        for one in section.get("tables", ())
    ]
    shown = list(section.get("figures", ()))
    for figure in shown:
        for kind in ("svg", "png"):
            file = folder / f"{figure['name']}.{kind}"
            if not file.is_file():
                raise FileNotFoundError(f"section '{section['title']}' shows {file}, which does not exist")
    return Section(section["title"], section.get("paragraphs", ()), listed, shown)


def _text(cell: Any) -> str:
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
