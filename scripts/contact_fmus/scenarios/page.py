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
        "value": tables.format_value,
        "error": tables.format_error,
        "allowed": tables.format_allowed,
        "plot": lambda result: result.plot.relative_to(folder).as_posix() if result.plot else None,
        "made": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
    }
    (file,) = write_pages(Path(__file__).parent, folder, context, {"page.html": "index.html"})
    return file
