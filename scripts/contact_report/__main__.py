"""python -m contact_report measure [--quick] --output FOLDER | page --output FOLDER

measure writes results.csv and summary.json; page draws figures, index.html and README.md from them and from
what the optional parts left in the same folder (rows.py).
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
import time
from pathlib import Path

from contact_scenarios.fmu_files import repository

from . import machine, measure
from .host import HostError
from .page import draw_page
from .rows import write_rows


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: an FMU refused, or something is not built"""
    options = _parser().parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    try:
        return options.command(options)
    except (HostError, FileNotFoundError) as error:
        print(error, file=sys.stderr)
        return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m contact_report", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, command, text in (
        ("measure", _measure, "run the FMU's solvers and write results.csv and summary.json"),
        ("page", _page, "draw the page from what is in the folder"),
    ):
        one = commands.add_parser(name, help=text)
        one.add_argument("--output", type=Path, default=repository() / "docs" / "report", metavar="FOLDER")
        one.set_defaults(command=command)
        if command is _measure:
            one.add_argument("--quick", action="store_true", help="few runs, to see that it works")
    return parser


def _measure(options: argparse.Namespace) -> int:
    plan = measure.QUICK if options.quick else measure.FULL
    begin = time.monotonic()

    def say(text: str) -> None:
        print(f"{time.monotonic() - begin:6.1f} s  {text}", flush=True)

    rows = measure.work_precision(plan, say)
    ratios = measure.compare_best(rows, plan, say)
    rows += measure.stiffness(plan, say)
    write_rows(options.output / "results.csv", rows)
    summary = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": _describe(plan, options.quick),
        "versions": machine.versions(),
        "ratios": ratios,
    }
    text = json.dumps(summary, indent=1, ensure_ascii=False)
    (options.output / "summary.json").write_text(text + "\n", encoding="utf-8")
    say("measured")
    return 0


def _describe(plan: measure.Plan, quick: bool) -> str:
    text = "A quick run with few repetitions, for trying out. " if quick else ""
    text += (
        f"Settings of a problem take turns in one process, {plan.repeat} turns of {plan.burst} runs, fewer"
    )
    return f"{text} once a setting has run {plan.budget:g} s; a run is ended after {plan.limit:g} s."


def _page(options: argparse.Namespace) -> int:
    for file in draw_page(options.output):
        print(file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
