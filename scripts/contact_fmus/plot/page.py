"""Panels as a page of their own, with a cursor and a zoom; it needs nothing from anywhere"""

from __future__ import annotations

from pathlib import Path

import jinja2

from . import payload
from .contacts import touches
from .panels import Panel
from .source import Run

HERE = Path(__file__).parent


def environment() -> jinja2.Environment:
    """Templates of this package, with `include_text` for scripts and styles, which are no templates"""
    folders = [HERE, HERE.parent / "animate"]
    result = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def include_text(name: str) -> str:
        return next((one / name).read_text(encoding="utf-8") for one in folders if (one / name).is_file())

    result.globals["include_text"] = include_text
    return result


def write_page(title: str, runs: list[Run], panels: list[Panel], file: Path) -> None:
    content = {
        "title": title,
        "times": [payload.times(run.result) for run in runs],
        "charts": payload.charts(panels, runs),
        "touches": [[one.begin, one.end, one.contact] for one in touches(runs[0].result)],
    }
    text = environment().get_template("plot.html").render(title=title, data=payload.script_json(content))
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
