"""Panels as a page of their own, with a cursor and a zoom; it needs nothing from anywhere"""

import base64
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.pages import environment

from .panels import Panel, threshold, touches, values
from .source import Run

# What a page's script is handed: JSON, with arrays of numbers as the bytes of doubles in base64

COLORS = 10  # --color-0 and so on of charts.css


def numbers(array: Iterable[float] | np.ndarray) -> str:
    """Little-endian doubles: all digits, in a third of the room of text"""
    return base64.b64encode(np.ascontiguousarray(array, dtype="<f8").tobytes()).decode("ascii")


def script_json(content: Any) -> str:
    """Inside a script element `</` would end it, wherever it stands."""
    return json.dumps(content, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")


def chart(panel: Panel, runs: list[Run]) -> dict[str, Any]:
    drawn = [[values(run.result, line.name) for line in panel.lines] for run in runs]
    factor, unit = _readable(panel.unit, [y for lines in drawn for y in lines])
    linear = threshold([y for lines in drawn for y in lines]) if "gap" in panel.title else None
    lines = []
    for number, (run, arrays) in enumerate(zip(runs, drawn, strict=True)):
        for index, (line, y) in enumerate(zip(panel.lines, arrays, strict=True)):
            label = [run.label] * (len(runs) > 1) + [line.label] * (len(panel.lines) > 1 or len(runs) == 1)
            lines.append(
                {
                    "label": ", ".join(label),
                    "run": number,
                    "color": number if len(runs) > 1 else index if line.color is None else line.color,
                    "sum": line.sum and len(runs) == 1,
                    "dash": index if len(runs) > 1 else index // COLORS,
                    "values": numbers(factor * y),
                }
            )
    linear = None if linear is None else linear * factor
    return {"title": panel.title, "unit": unit, "linear": linear, "lines": lines}


PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
PREFIXED = ("m", "N", "J", "s", "m/s", "Pa", "W")  # units whose name starts with what takes the prefix


def _readable(unit: str, drawn: list[np.ndarray]) -> tuple[float, str]:
    """A factor and the unit with its prefix, so that the largest value reads from 1 to 1000"""
    sizes = [float(np.nanmax(np.abs(y))) for y in drawn if np.any(np.isfinite(y))]
    size = max(sizes, default=0.0)
    if unit not in PREFIXED or size <= 0.0:
        return 1.0, unit
    scale, prefix = next((one for one in PREFIXES if size >= one[0]), PREFIXES[-1])
    return 1.0 / scale, prefix + unit


HERE = Path(__file__).parent


def write_page(title: str, runs: list[Run], panels: list[Panel], file: Path) -> None:
    content = {
        "title": title,
        "times": [numbers(run.result.time) for run in runs],
        "charts": [chart(panel, runs) for panel in panels],
        "touches": [[one.begin, one.end, one.contact] for one in touches(runs[0].result)],
    }
    text = environment(HERE).get_template("plot.html").render(title=title, data=script_json(content))
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
