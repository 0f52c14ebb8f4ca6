"""The report's tables: header and cells of text, the same for HTML and Markdown"""

import itertools
from collections.abc import Sequence

from contact_fmus.bench.problems import METHODS, STIFF_TOLERANCE, Problem, benchmarks
from contact_fmus.pages import Table, read_words

from .measure import PEER, REACHED, TOO_LONG, Row, quickest, stiff_setting

ERRORS = (1e-5, 1e-7, 1e-9, 1e-11)  # m
MISSING = "–"
WORDS = read_words(__file__)


def seconds(value: float | None) -> str:
    """Three digits in the unit that suits"""
    if value is None:
        return MISSING
    for scale, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= 0.9995 * scale:
            value /= scale
            digits = 2 if value < 9.995 else 1 if value < 99.95 else 0
            return f"{value:.{digits}f} {unit}"
    return f"{value * 1e9:.0f} ns"


def metres(value: float | None) -> str:
    return MISSING if value is None else f"{value:.1e}"


def least_times(problem: str, rows: Sequence[Row]) -> Table:
    """Least time to reach each error: our solvers with one and with many communication steps, then peers"""
    measured = [row for row in rows if row.problem == problem and row.measured]
    keys = dict.fromkeys(_solver_key(row) for row in measured)
    cells = []
    for key in keys:
        own = [row for row in measured if _solver_key(row) == key]
        best = [min((row.time_s for row in own if row.error_m <= error), default=None) for error in ERRORS]
        cells.append([*key, *map(seconds, best), metres(min(row.error_m for row in own))])
    header = ["solver", "law", "communication steps", *(f"≤ {error:g} m" for error in ERRORS), "least error, m"]
    return Table(f"{problem}: least time to reach an error", header, cells, 3)


def _solver_key(row: Row) -> tuple[str, str, str]:
    """A peer's settings and integrators count as one solver each."""
    steps = MISSING if row.group == PEER else str(row.communication_steps)
    return row.solver, row.law, steps


def ratios_table(comparison: Sequence[dict], others: Sequence[Row]) -> Table:
    cells = []
    for one in comparison:
        texts = [MISSING] * 6
        if one["ratio"] is not None:
            texts = [*_side(one["cvode"]), *_side(one["event_driven"])]
            texts += [ratio_text(one["ratio"]), ratio_text(one["ratio_of_least"])]
        known = [one["problem"], str(one["communication_steps"]), f"{one['cvode_reaches_m']:.0e}"]
        cells.append([*known, *texts, quickest_peer(one["problem"], others)])
    return Table(WORDS["ratios"]["caption"], WORDS["ratios"]["header"], cells, 7)


def ratio_text(value: float | None) -> str:
    """Two digits, or all before the point"""
    return MISSING if value is None else f"{value:.0f}" if value >= 9.95 else f"{value:.1f}"


def _side(side: dict) -> tuple[str, str]:
    how = f"{side['solver']}, relative tolerance {side['tolerance']:.0e}"
    return how, f"{seconds(side['time_s'])}, {metres(side['error_m'])} m"


def stiffness(name: str, family: Sequence[Problem], rows: Sequence[Row]) -> Table:
    """Time and error against p_n of one family, at one tolerance; peers have no communication steps"""
    chosen = [row for row in rows if (row.problem, row.setting) == (name, stiff_setting(STIFF_TOLERANCE))]
    by_key = {(row.solver, row.parameter, row.communication_steps): row for row in chosen}
    solvers = dict.fromkeys([*METHODS, *(row.solver for row in chosen)])
    counts = sorted({row.communication_steps for row in chosen if row.communication_steps})
    cells = []
    for problem, steps in itertools.product(family, counts):
        stiff = problem.penalty_factor
        found = [by_key.get((solver, stiff, steps)) or by_key.get((solver, stiff, None)) for solver in solvers]
        if any(found):
            pairs = [text for row in found for text in _time_and_error(row)]
            cells.append([f"{stiff:.0e}", str(steps), *pairs, f"{problem.method}, {problem.uncertainty:.0e} m"])
    header = ["p_n, N/m", "communication steps"]
    header += [f"{solver}: {what}" for solver in solvers for what in ("time", "error, m")]
    caption = f"{name}: relative tolerance {STIFF_TOLERANCE:g}"
    return Table(caption, [*header, "reference and how far it is good"], cells, 0)


def _time_and_error(row: Row | None) -> tuple[str, str]:
    if row is None:
        return MISSING, MISSING
    if row.measured:
        return seconds(row.time_s), metres(row.error_m)
    if row.note.startswith(TOO_LONG):
        return f">{row.note.removeprefix(TOO_LONG)}", MISSING
    return "not run" if row.note.startswith("not run") else "failed", MISSING


def curves(rows: Sequence[Row], problem: str) -> dict[tuple[str, int | None], list[Row]]:
    """Measured rows of each (solver, communication steps), by ascending parameter"""
    found: dict[tuple[str, int | None], list[Row]] = {}
    for row in rows:
        if row.problem == problem and row.measured:
            found.setdefault((row.solver, row.communication_steps), []).append(row)
    return {key: sorted(some, key=lambda row: row.parameter) for key, some in found.items()}


def front(rows: Sequence[Row]) -> list[Row]:
    """The rows that no other one beats in both time and error, by ascending time"""
    best: list[Row] = []
    for row in sorted(rows, key=lambda row: (row.time_s, row.error_m)):
        if not best or row.error_m < best[-1].error_m:
            best.append(row)
    return best


# What the page opens with: the problems, and how much less time event_driven takes


def paragraphs(ratios: Sequence[dict], others: Sequence[Row]) -> list[str]:
    """The paragraphs of the summary, with the factors that were measured"""
    factors: dict[str, list[float]] = {}
    for one in (one for one in ratios if one["ratio"]):
        count, reaches = one["communication_steps"], one["cvode_reaches_m"]
        key = f"as long in {steps_of(count)} to place it to {reaches:.0e} m".replace("e-0", "e-")
        factors.setdefault(key, []).append(one["ratio"])
    sides = [f"{ratio_text(min(some))} to {ratio_text(max(some))} times {key}" for key, some in factors.items()]
    texts = [WORDS["summary"]["text"].format(factors="; ".join(sides))]
    if any(row.measured for row in others):
        texts.append(WORDS["summary"]["peers"])
    return texts


def steps_of(count: int) -> str:
    return f"{count} communication step{'s' * (count > 1)}"


def problems() -> Table:
    """P1 to P3b in words"""
    cells = [
        [name, WORDS["problems"][name], f"{problem.stop:g} s", f"{problem.penalty_factor:.0e} N/m"]
        for name, problem in benchmarks().items()
    ]
    return Table("The problems", ["problem", "what moves", "for", "p_n"], cells, 2)


def comparison(ratios: Sequence[dict], others: Sequence[Row]) -> Table:
    """A line for each problem and number of communication steps: event_driven, then CVODE to each error, with ratios"""
    errors = dict.fromkeys(one["cvode_reaches_m"] for one in ratios)
    cells = []
    for (name, count), some in itertools.groupby(ratios, lambda one: (one["problem"], one["communication_steps"])):
        texts, own = [], MISSING
        for one in some:
            texts += [seconds(one["cvode"]["time_s"]), ratio_text(one["ratio"])] if one["ratio"] else [MISSING] * 2
            own = seconds(one["event_driven"]["time_s"]) if one["ratio"] else own
        title = f"{name}, {benchmarks()[name].title}"
        cells.append([title, str(count), own, *texts, quickest_peer(name, others)])
    header = ["problem", "communication steps", "event_driven to 1e-09 m"]
    header += [text for error in errors for text in (f"best CVODE to {error:.0e} m", "ratio")]
    caption = "Least time, and how many times less event_driven takes"
    return Table(caption, [*header, "fastest other to 1e-09 m"], cells, 2)


def quickest_peer(problem: str, others: Sequence[Row]) -> str:
    best = quickest((row for row in others if row.problem == problem), REACHED)
    return f"{seconds(best.time_s)} ({best.solver})" if best else MISSING
