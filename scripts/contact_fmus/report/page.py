"""The command page: the report's index.html, which holds its figures, and README.md next to them"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.bench.problems import SETS, stiff_families
from contact_fmus.options import parse
from contact_fmus.pages import Table, read_words, write_pages

from . import figures, tables
from .measure import RELATIVE_TOLERANCE, THIS_FMU, Row, read_part, read_rows

WORDS = read_words(__file__)


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
    parts = [read_part(folder / name) for name in ("energy.json", "peers.json", "force_element.json")]
    versions = dict(measured["versions"])
    for part in parts:
        versions |= part.get("versions", {})
    given = [given_section(section, folder) for part in parts for section in part.get("sections", ())]
    sections = []
    if ratios := measured.get("ratios"):
        listed = [tables.comparison(ratios, others), tables.problems()]
        sections.append(Section(WORDS["summary"]["title"], tables.paragraphs(ratios, others), listed))
    for name in SETS:
        sections += _work_precision(name, own, others, measured, folder)
    sections += [_stiffness([*own, *others], folder), *given]
    contents = [(f"section-{k}", section.title) for k, section in enumerate(sections, 1)]
    contents.append(("versions", "Versions and machine"))
    context = {key: measured[key] for key in ("made", "plan")}
    context |= {"contents": contents, "versions": versions, "sections": sections}
    return write_pages(Path(__file__).parent, folder, context)


def _work_precision(
    name: str, own: list[Row], others: list[Row], measured: dict[str, Any], folder: Path
) -> list[Section]:
    """Nothing where these problems have not been measured"""
    ratios, problems = measured.get(SETS[name][0], ()), SETS[name][1]()
    made = (row for row in own if row.group == THIS_FMU and row.setting == RELATIVE_TOLERANCE)
    rows = [row for row in made if row.problem in problems]
    problems = {problem: one for problem, one in problems.items() if any(row.problem == problem for row in rows)}
    if not rows:
        return []
    words = WORDS[name]
    figures.work_precision(rows, problems.values(), folder, name)
    shown = [{"name": name, "caption": words["caption"]}]
    others = [row for row in others if row.problem in problems]
    if name == "work_precision" and any(row.measured for row in others):
        figures.peers(rows, others, folder)
        shown.append({"name": "peers", "caption": words["peers"].format(worst=figures.WORST)})
    listed = [tables.least_times(problem, [*rows, *others]) for problem in problems]
    texts = [words["text"], *measured.get(f"{name}_apart", ())]
    return [Section(words["title"], texts, [*listed, tables.ratios_table(ratios, others)], shown)]


def _stiffness(own: list[Row], folder: Path) -> Section:
    words = WORDS["stiffness"]
    figures.stiffness(own, folder)
    listed = [tables.stiffness(name, family, own) for name, family in stiff_families().items()]
    figure = {"name": "stiffness", "caption": words["caption"]}
    return Section(words["title"], [words["text"]], listed, [figure])


def given_section(section: dict[str, Any], folder: Path) -> Section:
    """A section of peers.json or force_element.json (docs/report_parts.md)"""
    listed = [
        Table(
            one.get("caption", ""),
            one["header"],
            [[f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row] for row in one["rows"]],
        )
        for one in section.get("tables", ())
    ]
    shown = list(section.get("figures", ()))
    for figure in shown:
        for kind in ("svg", "png"):
            file = folder / f"{figure['name']}.{kind}"
            if not file.is_file():
                raise FileNotFoundError(f"section '{section['title']}' shows {file}, which does not exist")
    return Section(section["title"], section.get("paragraphs", ()), listed, shown)


def main(arguments: list[str] | None = None) -> int:
    """0: drawn; 2: something is missing"""
    for file in draw_page(parse("page", arguments).output):
        print(file)
    return 0
