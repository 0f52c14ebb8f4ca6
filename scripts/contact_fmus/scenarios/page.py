"""The HTML page of all scenarios"""

from __future__ import annotations

import datetime
from pathlib import Path

from contact_fmus.pages import write_pages

from . import tables
from .runner import ScenarioResult


def write_report(results: list[ScenarioResult], folder: Path) -> Path:
    """index.html in `folder`, next to the plots it shows"""
    context = {
        "results": results,
        "summary": summary(results),
        "contents": [("claims", "All claims")] + [(one.scenario.name, one.scenario.title) for one in results],
        "labels": plotted_labels,
        "value": tables.format_value,
        "error": tables.format_error,
        "allowed": tables.format_allowed,
        "plot": lambda result: result.plot.relative_to(folder).as_posix() if result.plot else None,
        "made": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
    }
    (file,) = write_pages(Path(__file__).parent, folder, context, {"page.html": "index.html"})
    return file


def summary(results: list[ScenarioResult]) -> str:
    """How many comparisons there are, and how many of them do not hold"""
    every = [one for result in results for one in result.results]
    broken = sum(not one.holds for one in every)
    failures = sum(len(result.failures) for result in results)
    text = f"{len(results)} scenario{'s' * (len(results) != 1)}, {len(every)} comparisons: "
    text += "all hold." if not broken else f"{broken} do not hold."
    return text + (f" {failures} runs failed." if failures else "")


def plotted_labels(result: ScenarioResult) -> str:
    """What the colours of the picture stand for; nothing where there is one run"""
    labels = [variant.label for variant in result.scenario.plotted()]
    return ", ".join(labels) if len(labels) > 1 else ""
