"""What the page opens with: the problems, and how much less time event_driven takes"""

from __future__ import annotations

from collections.abc import Sequence

from contact_fmus.bench.problems import Problem, benchmarks
from contact_fmus.pages.table import Table

from .rows import Row
from .tables import MISSING, ratio_text, seconds

WHAT = {
    "P1": "a ball dropped head-on on a fixed sphere, without damping: 8 impacts",
    "P2": "the same dropped off the top, with a dashpot: 2 oblique impacts, then free fall",
    "P3": "a ball let go at the stiff wall of a hollow cylinder: it slides to and fro and stays on the wall",
    "P3b": "the same let go 10 mm off the wall: 63 impacts, ever closer, then lasting contact",
}
PEER_ERROR = 1e-9  # m, what event_driven is asked for too


def paragraphs(ratios: Sequence[dict], others: Sequence[Row]) -> list[str]:
    """In short, computed from what was measured"""
    counts = sorted({one["communication_steps"] for one in ratios})
    sides = [_range_of(count, ratios) for count in counts]
    texts = [
        "In short: to place the ball to 1e-9 m, event_driven takes less time than the best CVODE setting "
        "of the same FMU takes to place it to 1e-7 m: " + "; ".join(side for side in sides if side) + ". "
        "Many communication steps make both sides stop at points that neither solver needs, and "
        "event_driven has less to do between them.",
    ]
    if any(row.measured for row in others):
        texts.append(
            "The other simulators solve the same problems with their own settings. scipy's right-hand side "
            "is Python, called for every evaluation: its times are not those of a compiled integrator."
        )
    return texts


def _range_of(count: int, ratios: Sequence[dict]) -> str:
    found = [one["ratio"] for one in ratios if one["communication_steps"] == count and one["ratio"]]
    if not found:
        return ""
    steps = "one communication step for the whole time" if count == 1 else f"{count} communication steps"
    least, most = ratio_text(min(found)), ratio_text(max(found))
    return f"by factors of {least} to {most} with {steps}" if least != most else f"by {least} with {steps}"


def problems() -> Table:
    """P1 to P3b in words"""
    cells = [
        [name, WHAT[name], f"{problem.stop:g} s", f"{problem.penalty_factor:.0e} N/m"]
        for name, problem in benchmarks().items()
    ]
    return Table("The problems", ["problem", "what moves", "for", "p_n"], cells, 2)


def comparison(ratios: Sequence[dict], others: Sequence[Row]) -> Table:
    """A line for each problem: both solvers with one communication step, the ratio for each number of them"""
    counts = sorted({one["communication_steps"] for one in ratios})
    by_key = {(one["problem"], one["communication_steps"]): one for one in ratios}
    cells = []
    for name, problem in benchmarks().items():
        first = by_key.get((name, counts[0])) if counts else None
        pair = [MISSING, MISSING]
        if first and first["ratio"] is not None:
            pair = [seconds(first[side]["time_s"]) for side in ("cvode", "event_driven")]
        found = [by_key.get((name, count), {}).get("ratio") for count in counts]
        cells.append([f"{name}, {problem.title}", *pair, *map(ratio_text, found), _quickest(problem, others)])
    header = ["problem", "best CVODE to 10⁻⁷ m", "event_driven to 10⁻⁹ m"]
    header += [f"ratio, {count} communication step{'s' * (count > 1)}" for count in counts]
    caption = "Least time, and how many times less event_driven takes"
    if counts:
        caption += f"; times with {counts[0]} communication step{'s' * (counts[0] > 1)}"
    return Table(caption, [*header, "fastest other simulator to 10⁻⁹ m"], cells)


def _quickest(problem: Problem, others: Sequence[Row]) -> str:
    good = [
        row for row in others if row.problem == problem.name and row.measured and row.error_m <= PEER_ERROR
    ]
    if not good:
        return MISSING
    best = min(good, key=lambda row: row.time_s)
    return f"{seconds(best.time_s)} ({best.solver})"
