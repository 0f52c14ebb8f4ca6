"""The command measure: the FMU's solvers, error against time, the ratio of the best ones, time against stiffness."""

import csv
import dataclasses
import datetime
import itertools
import json
import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from contact_fmus.bench.problems import CODES, METHODS, SETS, STIFF_TOLERANCE, Problem, Setting, stiff_families
from contact_fmus.fmu.host import HostError, HostTimeout, Result, run_host
from contact_fmus.options import parse
from contact_fmus.pages import read_words, stopwatch, versions, write_json

# The rows of the report; docs/report_parts.md describes the files that its parts leave for the page

THIS_FMU, PEER = "this FMU", "peer"
SAME, SIMILAR = "same", "similar"  # force law of the problem
RELATIVE_TOLERANCE = "relative tolerance"


@dataclass(frozen=True)
class Row:
    """A line of results.csv or peers.csv; numbers that are missing are None"""

    problem: str  # its name in bench/problems.py, or that of a stiffness family
    group: str  # THIS_FMU or PEER
    solver: str  # event_driven, cvode_bdf, cvode_adams; a peer's name and integrator
    law: str = ""  # SAME or SIMILAR
    setting: str = ""  # what `parameter` is: relative tolerance, step size in s, ...
    parameter: float | None = None
    communication_steps: int | None = None  # for the whole time; None where there are none
    time_s: float | None = None  # median of the runs, stepping only
    time_min_s: float | None = None
    error_m: float | None = None  # distance of the positions at the end from the reference
    onsets: int | None = None  # contacts counted, where the solver can tell
    note: str = ""

    @property
    def measured(self) -> bool:
        return self.time_s is not None and self.error_m is not None


COLUMNS = tuple(field.name for field in fields(Row))


def write_rows(file: Path, rows: list[Row], keep: bool = False) -> list[Row]:
    """Numbers with as many digits as they are good for: times 4, errors 3. `keep`: what the file has of other problems
    stays; the rows that it then has are returned."""
    measured = {row.problem for row in rows}
    rows = [row for row in read_rows(file) if row.problem not in measured] + rows if keep and file.is_file() else rows
    digits = {"time_s": "%.4g", "time_min_s": "%.4g", "error_m": "%.3g", "parameter": "%.10g"}
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in rows:
            cells = vars(row).items()
            writer.writerow(
                [digits[name] % cell if name in digits and cell is not None else cell for name, cell in cells]
            )
    return rows


def read_rows(file: Path) -> list[Row]:
    with file.open(newline="", encoding="utf-8") as stream:
        reader = csv.DictReader(stream)
        if tuple(reader.fieldnames or ()) != COLUMNS:
            raise ValueError(f"{file}: the columns are {reader.fieldnames}, not {list(COLUMNS)}")
        rows: list[dict[str, Any]] = list(reader)
    for cells in rows:
        for name in ("parameter", "time_s", "time_min_s", "error_m"):
            value = float(cells[name] or math.nan)
            cells[name] = value if math.isfinite(value) else None
        for name in ("communication_steps", "onsets"):
            cells[name] = int(float(cells[name])) if cells[name] else None
    return [Row(**cells) for cells in rows]


def read_part(file: Path) -> dict[str, Any]:
    """peers.json or force_element.json; empty when it is not there"""
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


TOO_LONG = "not done after"
REACHED, CVODE_REACHES = 1e-9, (1e-7, 1e-9)  # m: the errors that the best of event_driven and those of CVODE have

Say = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """The amount of runs"""

    tolerances: Sequence[float]
    communication_steps: Sequence[int]
    repeat: int  # turns of a case
    burst: int  # runs in a turn
    budget: float  # s; a setting that ran so long is not run again
    limit: float  # s; a run that is not done by then is ended
    ratio_repeat: int
    penalty_factors: Sequence[float]  # N/m; of the sweep, as far as there are references
    without: Sequence[str] = ()  # problems that take too long


FULL = Plan([10.0**-k for k in range(3, 14)], (1, 997), 5, 3, 0.3, 3.0, 15, [10.0**k for k in range(5, 16)])
QUICK = Plan((1e-6, 1e-10), (1, 7), 2, 1, 0.05, 30.0, 2, (1e5, 1e6), ("bearing", "bearing Hertz"))


def run_ladders(ladders: Sequence[Sequence[Setting]], plan: Plan) -> dict[Setting, Result]:
    """Each ladder is climbed alone, one run a setting, up to the first that takes too long. The settings that
    turn out quick are then run together, taking turns; of the slow ones that first run is all there is."""
    results: dict[Setting, Result] = {}
    for ladder in ladders:
        given_up = ""
        for setting in ladder:
            results[setting] = Result(setting.name, [], [], {}, given_up) if given_up else _run_alone(setting, plan)
            if results[setting].error.startswith(TOO_LONG):
                given_up = f"not run: {results[setting].error}{setting.where}"
    quick = [setting for setting, result in results.items() if not result.error and result.least < plan.budget]
    cases = [setting.case() for setting in quick]
    if cases:
        together = run_host(cases, plan.repeat, burst=plan.burst, budget=plan.budget)
        results |= zip(quick, together, strict=True)
    return results


def _run_alone(setting: Setting, plan: Plan) -> Result:
    try:
        return run_host([setting.case()], timeout=plan.limit)[0]
    except HostTimeout:
        return Result(setting.name, [], [], {}, f"{TOO_LONG} {plan.limit:g} s")
    except HostError as error:
        return Result(setting.name, [], [], {}, str(error))


def row_of(setting: Setting, result: Result, stiff: bool = False) -> Row:
    what, parameter = RELATIVE_TOLERANCE, setting.tolerance
    if stiff:
        what, parameter = stiff_setting(setting.tolerance), setting.problem.penalty_factor
    known = (setting.problem.name, THIS_FMU, setting.method, SAME, what, parameter, setting.steps)
    if setting.method in CODES:
        known = (setting.problem.name, PEER, CODES[setting.method], SAME, what, parameter, None)
    if result.error:
        return Row(*known, note=result.error)
    error, onsets = setting.problem.end(result.outputs)
    note = ""
    if error < setting.problem.uncertainty and setting.problem.uncertainty > 1e-13:
        note = f"the reference is good to {setting.problem.uncertainty:.0e} m"
    return Row(*known, result.median, result.least, error, onsets, note)


def stiff_setting(tolerance: float) -> str:
    return f"p_n in N/m at relative tolerance {tolerance:g}"


def work_precision(
    problems: Iterable[Problem], methods: Sequence[str], counts: Sequence[int], plan: Plan, say: Say
) -> list[Row]:
    """Methods x tolerances x communication steps; those of one problem and step take turns"""
    rows = []
    for problem, steps in itertools.product(problems, counts):
        say(f"{problem.name}, {steps} communication steps")
        ladders = [[Setting(problem, method, tolerance, steps) for tolerance in plan.tolerances] for method in methods]
        rows += [row_of(*pair) for pair in run_ladders(ladders, plan).items()]
    return rows


def compare_best(problems: Iterable[Problem], rows: Sequence[Row], plan: Plan, say: Say) -> list[dict]:
    """The quickest setting of CVODE that comes close enough against that of event_driven: they are run again,
    A B B A in one process, so that what slows the machine down for a while slows down both"""
    found = []
    for problem in problems:
        for steps in plan.communication_steps:
            say(f"{problem.name}, {steps} communication steps: the best of each")
            own = [row for row in rows if (row.problem, row.communication_steps) == (problem.name, steps)]
            for reaches in CVODE_REACHES:
                sides = ([row for row in own if (row.solver == METHODS[0]) == ours] for ours in (False, True))
                best = [quickest(*pair) for pair in zip(sides, (reaches, REACHED), strict=True)]
                known = {"problem": problem.name, "communication_steps": steps, "cvode_reaches_m": reaches}
                found.append(known | {"ratio": None})
                if None not in best:
                    found[-1] |= _race([Setting(problem, row.solver, row.parameter, steps) for row in best], plan)
    return found


def quickest(rows: Iterable[Row], error: float) -> Row | None:
    fit = [row for row in rows if row.measured and row.error_m <= error]
    return min(fit, key=lambda row: row.time_s, default=None)


def _race(settings: Sequence[Setting], plan: Plan) -> dict[str, Any]:
    first, second = (setting.case() for setting in settings)
    limits = {"budget": 8 * plan.budget, "timeout": 20 * plan.limit}
    try:
        results = run_host([first, second, second, first], plan.ratio_repeat, **limits)
    except HostError:
        return {}
    sides = []
    for place, setting in enumerate(settings):
        times = results[place].times + results[3 - place].times
        sides.append({"solver": setting.method, "tolerance": setting.tolerance})
        sides[-1] |= {"time_s": statistics.median(times), "time_min_s": min(times)}
        sides[-1] |= {"error_m": setting.problem.end(results[place].outputs)[0]}
    ratios = (sides[0][name] / sides[1][name] for name in ("time_s", "time_min_s"))
    return dict(zip(("cvode", "event_driven", "ratio", "ratio_of_least"), (*sides, *ratios), strict=True))


def stiffness(methods: Sequence[str], counts: Sequence[int], plan: Plan, say: Say) -> list[Row]:
    """Time and error against p_n, with one tolerance"""
    rows: list[Row] = []
    for (name, family), steps in itertools.product(stiff_families().items(), counts):
        say(f"{name}, {steps} communication steps")
        problems = [problem for problem in family if problem.penalty_factor in plan.penalty_factors]
        ladders = [[Setting(problem, method, STIFF_TOLERANCE, steps) for problem in problems] for method in methods]
        rows += [row_of(*pair, stiff=True) for pair in run_ladders(ladders, plan).items()]
    return rows


def of_codes(quick: bool, say: Say) -> list[Row]:
    """Those of CODES that fmu_host can use, on the single spheres; they have no communication steps"""
    plan, first = QUICK if quick else FULL, SETS["work_precision"][1]()["P1"]
    lacks = {code: _run_alone(Setting(first, code, 1e-6, 1), plan).error for code in CODES}
    able = [code for code, error in lacks.items() if not error]
    rows = [Row("all", PEER, CODES[code], note=error) for code, error in lacks.items() if error]
    sets = [some for name, (_, some) in SETS.items() if name not in ("islands", "pairs")]
    rows += [row for some in sets for row in work_precision(some().values(), able, (1,), plan, say)]
    return rows + stiffness(able, (1,), plan, say)


def main(arguments: list[str] | None = None) -> int:
    """0: done; 2: something is not built; 3: an FMU refused"""
    options = parse("measure", arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    plan, file, words = QUICK if options.quick else FULL, options.output / "summary.json", read_words(__file__)["plan"]
    plan = dataclasses.replace(plan, limit=options.limit or plan.limit)
    about = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": words["quick"] * options.quick + words["text"].format(**vars(plan)),
    }
    say, rows, summary = stopwatch(), [], read_part(file) if options.only else {}
    summary = summary or about | {"versions": versions()}
    for name in options.only or SETS:
        problems = [problem for problem in SETS[name][1]().values() if problem.name not in plan.without]
        found = work_precision(problems, METHODS, plan.communication_steps, plan, say)
        summary[SETS[name][0]] = compare_best(problems, found, plan, say)
        rows += found
        if options.only:
            note = f"{options.note.rstrip('.')}. " if options.note else ""
            summary[f"{name}_apart"] = [words["apart"].format(name=name, note=note, **about)]
    rows += [] if options.only else stiffness(METHODS, plan.communication_steps, plan, say)
    write_rows(options.output / "results.csv", rows, bool(options.only))
    write_json(file, summary)
    say("measured")
    return 0
