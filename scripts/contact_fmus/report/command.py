"""The commands measure and page of contact_fmus

measure writes results.csv and summary.json; page draws figures, index.html and README.md from them and from
what the optional parts left in the same folder (measure.py).
"""

from __future__ import annotations

import datetime

from contact_fmus import pages
from contact_fmus.bench.problems import benchmarks, hertz_problems, shape_problems, turning_problems
from contact_fmus.options import parse

from . import measure as solvers
from .measure import write_rows
from .page import draw_page


def measure(arguments: list[str] | None = None) -> int:
    """0: done; 2: something is not built; 3: an FMU refused"""
    options = parse("measure", arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    plan = solvers.QUICK if options.quick else solvers.FULL
    say, rows, ratios = pages.stopwatch(), [], []
    for some in (benchmarks, shape_problems, hertz_problems, turning_problems):
        problems = some().values()
        found = solvers.work_precision(problems, plan, say)
        ratios.append(solvers.compare_best(problems, found, plan, say))
        rows += found
    rows += solvers.stiffness(plan, say)
    write_rows(options.output / "results.csv", rows)
    summary = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": _describe(plan, options.quick),
        "versions": pages.versions(),
        "ratios": ratios[0],
        "shape_ratios": ratios[1],
        "hertz_ratios": ratios[2],
        "turning_ratios": ratios[3],
    }
    pages.write_json(options.output / "summary.json", summary)
    say("measured")
    return 0


def _describe(plan: solvers.Plan, quick: bool) -> str:
    text = "A quick run with few repetitions, for trying out. " if quick else ""
    text += f"Settings of a problem take turns in one process, {plan.repeat} turns of {plan.burst} runs, fewer"
    return f"{text} once a setting has run {plan.budget:g} s; a run is ended after {plan.limit:g} s."


def page(arguments: list[str] | None = None) -> int:
    """0: drawn; 2: something is missing"""
    for file in draw_page(parse("page", arguments).output):
        print(file)
    return 0
