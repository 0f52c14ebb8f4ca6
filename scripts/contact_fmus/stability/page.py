"""The atlas's page: index.html, which holds its figures, and README.md next to them"""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from pathlib import Path

from contact_fmus.pages import write_pages
from contact_fmus.pages.machine import versions

from . import figures, limits, text
from .checks import TOLERANCE
from .run import METHODS, MOST_STEPS, SceneRun
from .scenes import FAMILIES


def draw_page(rows: Sequence[SceneRun], folder: Path, plan: str) -> list[Path]:
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
        "legend": figures.LEGEND,
        "counts": limits.counts(rows),
        "limits": [limits.axes(rows), limits.refusals(rows)],
        "mistakes": limits.mistakes(rows),
        "checks": [limits.allowed(), limits.same_bits(rows)],
        "versions": versions(),
        "texts": text,
    }
    return write_pages(Path(__file__).parent, folder, context)
