"""docs/importers.md: the table of what was tried, and what to click or write in tools that were not"""

from __future__ import annotations

from pathlib import Path

from .trying import AGREE, IMPORTERS, Importer, Trial

NOTES = Path(__file__).resolve().parent / "notes.md"


def page(trials: list[Trial], present: list[Importer], step: float, count: int) -> str:
    fmus = list(dict.fromkeys(trial.fmu for trial in trials))
    found = {(trial.importer.name, trial.fmu): trial for trial in trials}
    versions = {trial.importer.name: trial.version for trial in trials if trial.version}
    lines = [
        "# Importers",
        "",
        f"`contact-fmus importers build/fmus/*.fmu -o docs/importers.md` runs each FMU for {count} steps of",
        f"{step:g} s in each importer that is installed, in its own process, and compares the end values",
        "of all Real outputs with those that fmpy gives. The table has the largest difference, relative to",
        f"values above 1 and absolute below; up to {AGREE:g} counts as the same, for importers that add up",
        "their clock make steps of other lengths.",
        "",
        f"| importer | version | {' | '.join(fmus)} |",
        f"| --- | --- | {' | '.join('---' for _ in fmus)} |",
    ]
    problems: dict[str, str] = {}
    for importer in IMPORTERS:
        if importer not in present:
            cells = ["not installed"] * len(fmus)
        else:
            cells = [_cell(found[importer.name, fmu], found["fmpy", fmu], problems) for fmu in fmus]
        about = f"{importer.name} ({importer.registry})"
        lines.append(f"| {about} | {versions.get(importer.name, '')} | {' | '.join(cells)} |")
    lines += ["", *(f"- {name}: refused: {text}" for name, text in problems.items())]
    return "\n".join(lines).rstrip() + "\n\n" + NOTES.read_text(encoding="utf-8")


def _cell(trial: Trial, reference: Trial, problems: dict[str, str]) -> str:
    if trial.problem:
        problems[trial.importer.name] = trial.problem
        return "refused"
    if trial is reference:
        return "reference"
    off = trial.difference(reference)
    return ("0" if off == 0.0 else f"{off:.0e}") + ("" if off <= AGREE else " **differs**")
