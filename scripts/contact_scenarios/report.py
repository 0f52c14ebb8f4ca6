"""The HTML page of all scenarios"""

from __future__ import annotations

import datetime
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, select_autoescape

from . import tables
from .runner import ScenarioResult


def write_report(results: list[ScenarioResult], folder: Path) -> Path:
    """index.html in `folder`, next to the plots it shows"""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=select_autoescape(["html"]),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"error": tables.format_error, "allowed": tables.format_allowed}
    page = environment.get_template("report.html").render(
        results=results,
        value=tables.format_value,
        plot=lambda result: result.plot.relative_to(folder).as_posix() if result.plot else None,
        made=datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
    )
    file = folder / "index.html"
    file.write_text(page, encoding="utf-8")
    return file
