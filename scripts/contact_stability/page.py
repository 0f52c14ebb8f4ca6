"""The atlas's page: index.html, which holds its figures, and README.md next to them"""

from __future__ import annotations

import base64
import datetime
from collections.abc import Sequence
from pathlib import Path

from contact_report.machine import versions
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

from . import figures, limits, text
from .checks import TOLERANCE
from .run import METHODS, MOST_STEPS, Row
from .scenes import FAMILIES


def draw_page(rows: Sequence[Row], folder: Path, plan: str) -> list[Path]:
    """Figures, index.html and README.md"""
    drawn = figures.draw(rows, folder)
    context = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": plan,
        "scenes": len(rows) // len(METHODS),
        "tolerance": f"{TOLERANCE:g}",
        "most_steps": MOST_STEPS,
        "families": [family for family in FAMILIES if any(row.family == family.name for row in rows)],
        "figures": drawn,
        "counts": limits.counts(rows),
        "limits": [limits.axes(rows), limits.refusals(rows)],
        "mistakes": limits.mistakes(rows),
        "checks": [limits.allowed(), limits.same_bits(rows)],
        "versions": versions(),
        "texts": text,
    }
    files = []
    for template, name in (("page.html", "index.html"), ("page.md", "README.md")):
        page = _environment(folder).get_template(template).render(context)
        (folder / name).write_text(page.rstrip() + "\n", encoding="utf-8")
        files.append(folder / name)
    return files


def _environment(folder: Path) -> Environment:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )

    def embedded(name: str) -> str:
        return "data:image/png;base64," + base64.b64encode((folder / f"{name}.png").read_bytes()).decode()

    def cell(text: str) -> str:
        return str(text).replace("|", "\\|").replace("\n", " ")

    environment.filters |= {"embedded": embedded, "cell": cell}
    return environment
