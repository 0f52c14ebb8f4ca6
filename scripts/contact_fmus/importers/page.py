"""docs/importers.md: the table of what was tried, and what to click or write in tools that were not"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from .trying import AGREE, IMPORTERS, Importer, Trial

NOTES = Path(__file__).resolve().parent / "notes.md"


TOP = """\
# Importers

`contact-fmus importers build/fmus/*.fmu build/fmus-fmi3/*.fmu -o docs/importers.md` runs each FMU for
{count} steps of {step:g} s in each importer that is installed, in its own process, and compares the end
values of all outputs with those that fmpy gives; in FMI 3.0 of those that are no arrays, which the others
cannot read. A table has the largest difference, relative to values above 1 and absolute below; up to
{agree:g} counts as the same, for importers that add up their clock make steps of other lengths.
"""


def page(tables: dict[int, list[str]], step: float, count: int) -> str:
    """Of tables by version of FMI"""
    parts = [f"## FMI {version}.0\n\n" + "\n".join(lines) + "\n" for version, lines in tables.items()]
    notes = NOTES.read_text(encoding="utf-8")
    return "\n".join([TOP.format(count=count, step=step, agree=AGREE), *parts, notes])


def table(
    trials: list[Trial], present: list[Importer], importers: Sequence[Importer] = IMPORTERS
) -> list[str]:
    """Its lines: a row for each of the importers"""
    fmus = list(dict.fromkeys(trial.fmu for trial in trials))
    found = {(trial.importer.name, trial.fmu): trial for trial in trials}
    versions = {trial.importer.name: trial.version for trial in trials if trial.version}
    lines = [
        f"| importer | version | {' | '.join(fmus)} |",
        f"| --- | --- | {' | '.join('---' for _ in fmus)} |",
    ]
    problems: dict[str, str] = {}
    for importer in importers:
        if importer not in present:
            cells = ["not installed"] * len(fmus)
        else:
            cells = [_cell(found[importer.name, fmu], found["fmpy", fmu], problems) for fmu in fmus]
        about = f"{importer.name} ({importer.registry})"
        lines.append(f"| {about} | {versions.get(importer.name, '')} | {' | '.join(cells)} |")
    if problems:
        lines += ["", *(f"- {name} refuses: {text}" for name, text in problems.items())]
    return lines


def _cell(trial: Trial, reference: Trial, problems: dict[str, str]) -> str:
    if trial.problem:
        problems[trial.importer.name] = trial.problem
        return "refused"
    if trial is reference:
        return "reference"
    off = trial.difference(reference)
    return ("0" if off == 0.0 else f"{off:.0e}") + ("" if off <= AGREE else " **differs**")
