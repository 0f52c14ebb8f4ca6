"""contact-fmus stability [--quick] [--check] [--workers N] [--output FOLDER] [--beyond FIRST LAST]

Runs the atlas's scenes and writes runs.csv, summary.csv, figures, index.html and README.md.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from contact_fmus.fmu.files import results_folder

from . import beyond
from .limits import groups, write_csv
from .page import draw_page
from .run import SceneRun, not_right, run_all, thinned
from .scenes import all_scenes

QUICK = 37  # every so many-th scene


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: with --check, a run of event_driven is wrong or did not end; 2: something is not built"""
    options = _parser().parse_args(arguments)
    if options.beyond:
        return beyond.main([*map(str, options.beyond), "--workers", str(options.workers)])
    options.output.mkdir(parents=True, exist_ok=True)
    rows = _measured(options)
    write_csv(rows, options.output / "runs.csv")
    write_csv(groups(rows), options.output / "summary.csv")
    plan = "A quick run with few of the scenes. " if options.quick else ""
    for file in draw_page(rows, options.output, plan):
        print(file)
    print(ending(rows))
    failed = not_right(rows, "event_driven")
    for row in failed if options.check else ():
        print(
            f"not right: {row.family}, {row.value:g}, {row.geometry}, {row.law}: {row.wrong or row.message}"
        )
    return int(options.check and bool(failed))


def ending(rows: Sequence[SceneRun]) -> str:
    """How many runs are wrong or refused, and of which method"""
    wrong = Counter(row.method for row in rows if row.wrong)
    refused = Counter(row.method for row in rows if row.status != "ok")
    return f"{len(rows)} runs, {_of_methods('wrong', wrong)}, {_of_methods('refused', refused)}"


def _of_methods(what: str, count: Counter[str]) -> str:
    """4 wrong (cvode_bdf 3, cvode_adams 1)"""
    each = ", ".join(f"{method} {number}" for method, number in count.most_common())
    return f"{count.total()} {what}" + (f" ({each})" if each else "")


def _measured(options: argparse.Namespace) -> list[SceneRun]:
    begin, family, rows = time.monotonic(), "", []
    for scene, found in run_all(thinned(all_scenes(), QUICK if options.quick else 1), options.workers):
        if scene.family != family:
            family = scene.family
            print(f"{time.monotonic() - begin:6.1f} s  {family}", flush=True)
        rows += found
    print(f"{time.monotonic() - begin:6.1f} s  done", flush=True)
    return rows


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="contact-fmus stability", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few of the scenes")
    parser.add_argument(
        "--check", action="store_true", help="the status is 1 unless event_driven is right everywhere"
    )
    parser.add_argument(
        "--beyond",
        type=int,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help="nothing of that: random scenes far beyond the atlas's axes; seeds",
    )
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes (2)")
    parser.add_argument("--output", type=Path, default=results_folder("docs/stability"), metavar="FOLDER")
    return parser
