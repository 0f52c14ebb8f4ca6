"""The rows of the report and the files its parts leave for the page.

The page is made of files in the output folder (docs/report), each written by a command of its own:

    results.csv          python -m contact_fmus measure --output DIR [--quick]         this FMU
    force_element.json   python -m contact_fmus force-element --output DIR [--quick]   the coupling study
    peers.csv            python -m contact_fmus peers --output DIR [--quick]           other simulators

scripts/report.sh calls them in this order and draws the page last (python -m contact_fmus page), with
whatever of the optional ones is there: peers.csv, peers.json, force_element.json.

peers.csv has COLUMNS; its rows have group "peer". An error or time that is missing is an empty cell, and
`note` says why ("cannot express a hollow cylinder"; "not done after 60 s").

peers.json (optional) and force_element.json are objects; the page reads these keys and leaves others alone:

    "versions": {"exudyn": "1.13.6", ...}          added to the table of versions
    "sections": [{"title": "...",
                  "paragraphs": ["...", ...],        text, formulas between $ (pages/formula.py)
                  "tables": [{"caption": "...", "header": ["...", ...], "rows": [["...", ...], ...]}],
                  "figures": [{"name": "force_element", "caption": "..."}]}]

Every key of a section but the title may be left out. A figure's name stands for name.svg, shown in the
HTML page, and name.png, shown in README.md, both in the same folder. A cell of a table is text or a number.
"""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

THIS_FMU, PEER = "this FMU", "peer"
SAME, SIMILAR = "same", "similar"  # force law of the problem
RELATIVE_TOLERANCE = "relative tolerance"
COLUMNS = (
    "problem",  # P1, P2, P3, P3b, one of them with another shape or law, F1 to F4, or a stiffness family
    "group",  # THIS_FMU or PEER
    "solver",  # event_driven, cvode_bdf, cvode_adams; a peer's name and integrator
    "law",  # SAME or SIMILAR
    "setting",  # what `parameter` is: relative tolerance, step size in s, ...
    "parameter",
    "communication_steps",  # for the whole time; empty where there are none
    "time_s",  # median of the runs, stepping only
    "time_min_s",
    "error_m",  # distance of the source's position at the end from the reference
    "onsets",  # contacts counted, where the solver can tell
    "note",
)


@dataclass(frozen=True)
class Row:
    """A line of results.csv or peers.csv; numbers that are missing are None"""

    problem: str
    group: str
    solver: str
    law: str
    setting: str
    parameter: float | None
    communication_steps: int | None
    time_s: float | None
    time_min_s: float | None
    error_m: float | None
    onsets: int | None
    note: str = ""

    @property
    def measured(self) -> bool:
        return self.time_s is not None and self.error_m is not None


def write_rows(file: Path, rows: list[Row]) -> None:
    """Numbers with as many digits as they are good for: times 4, errors 3."""
    digits = {"time_s": "%.4g", "time_min_s": "%.4g", "error_m": "%.3g", "parameter": "%.10g"}
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in rows:
            cells = [(name, getattr(row, name)) for name in COLUMNS]
            writer.writerow(
                [
                    "" if cell is None else digits[name] % cell if name in digits else cell
                    for name, cell in cells
                ]
            )


def read_rows(file: Path) -> list[Row]:
    with file.open(newline="", encoding="utf-8") as stream:
        reader = csv.DictReader(stream)
        if tuple(reader.fieldnames or ()) != COLUMNS:
            raise ValueError(f"{file}: the columns are {reader.fieldnames}, not {list(COLUMNS)}")
        return [_row(cells) for cells in reader]


def _row(cells: dict[str, str]) -> Row:
    numbers: dict[str, Any] = {}
    for name in ("parameter", "time_s", "time_min_s", "error_m"):
        value = float(cells[name]) if cells[name] else math.nan
        numbers[name] = value if math.isfinite(value) else None
    for name in ("communication_steps", "onsets"):
        numbers[name] = int(float(cells[name])) if cells[name] else None
    return Row(**{**cells, **numbers})


def read_part(file: Path) -> dict[str, Any]:
    """peers.json or force_element.json; empty when it is not there"""
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
