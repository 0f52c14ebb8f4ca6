"""python -m contact_fmus peers --output FOLDER [--quick] [--only NAME]

Writes peers.csv and peers.json for the report's page. FOLDER may also be the name of the CSV file itself.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterable
from pathlib import Path

from contact_fmus.report.rows import Row, write_rows

from .run import NAMES, module_of, run, versions


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="contact-fmus peers", description=__doc__)
    parser.add_argument("--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--quick", action="store_true", help="few runs, to see that it works")
    parser.add_argument("--only", action="append", choices=NAMES, metavar="NAME", help=", ".join(NAMES))
    options = parser.parse_args(arguments)
    file = options.output if options.output.suffix == ".csv" else options.output / "peers.csv"
    file.parent.mkdir(parents=True, exist_ok=True)
    rows, begin = [], time.monotonic()
    for row in run(quick=options.quick, names=options.only or NAMES):
        rows.append(row)
        print(f"{time.monotonic() - begin:6.1f} s  {line(row)}", flush=True)
    write_rows(file, rows)
    part = {"versions": versions(), "sections": [section(rows, options.only or NAMES)]}
    text = json.dumps(part, indent=1, ensure_ascii=False)
    file.with_suffix(".json").write_text(text + "\n", encoding="utf-8")
    return 0


def line(row: Row) -> str:
    if not row.measured:
        return f"{row.problem} {row.solver} {row.parameter or ''}: {row.note}"
    result = f"{row.time_s * 1e3:.3g} ms, error {row.error_m:.1e} m"
    return f"{row.problem} {row.solver}, {row.setting} {row.parameter:g}: {result}"


def section(rows: Iterable[Row], names: Iterable[str]) -> dict:
    """For the page: each peer's law, and what there is no measurement of"""
    peers = [[module_of(name).NAME, module_of(name).LAW] for name in names]
    gaps = dict.fromkeys(
        (row.solver, row.problem, row.setting, f"{row.parameter or ''}", row.note)
        for row in rows
        if not row.measured
    )
    tables = [{"caption": "What each peer computes", "header": ["peer", "law"], "rows": peers}]
    if gaps:
        header = ["solver", "problem", "setting", "", "why"]
        tables.append({"caption": "Not measured", "header": header, "rows": [list(gap) for gap in gaps]})
    return {
        "title": "How the peers were run",
        "paragraphs": [
            "Each peer runs in a process of its own, on one thread; only its stepping is timed, and every"
            " repeat starts from a model made anew. scipy's right-hand side is Python, called for every"
            " evaluation.",
        ],
        "tables": tables,
    }
