"""The FMU's solvers, measured: error against time, the ratio of the best ones, time against stiffness."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from contact_fmus.bench import best
from contact_fmus.bench.problems import Problem, stiff_families
from contact_fmus.bench.ratios import Effort
from contact_fmus.bench.settings import (
    EVENT_DRIVEN,
    METHODS,
    STIFF_TOLERANCE,
    Setting,
)
from contact_fmus.fmu.host import HostError, HostTimeout, Result, run_host

from .rows import RELATIVE_TOLERANCE, SAME, THIS_FMU, Row

TOO_LONG = "not done after"

Say = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How much is run"""

    tolerances: Sequence[float]
    communication_steps: Sequence[int]
    repeat: int  # turns of a case
    burst: int  # runs in a turn
    budget: float  # s; a setting that ran so long is not run again
    limit: float  # s; a run that is not done by then is ended
    ratio_repeat: int
    stiff_tolerances: Sequence[float]
    penalty_factors: Sequence[float]  # N/m; of the sweep, as far as there are references


FULL = Plan(
    [10.0**-k for k in range(4, 14)],
    (1, 997),
    5,
    3,
    0.3,
    3.0,
    15,
    (1e-6, 1e-9, 1e-12),
    [10.0**k for k in range(5, 16)],
)
QUICK = Plan((1e-6, 1e-10), (1, 7), 2, 1, 0.05, 30.0, 2, (1e-9,), (1e5, 1e6))


def run_ladders(ladders: Sequence[Sequence[Setting]], plan: Plan) -> dict[Setting, Result]:
    """Each ladder is climbed alone, one run a setting, up to the first that takes too long. The settings that
    turn out quick are then run together, taking turns; of the slow ones that first run is all there is.
    """
    results: dict[Setting, Result] = {}
    for ladder in ladders:
        given_up = ""
        for setting in ladder:
            results[setting] = (
                Result(setting.name, [], [], {}, given_up) if given_up else _run_alone(setting, plan)
            )
            if results[setting].error.startswith(TOO_LONG):
                given_up = f"not run: {results[setting].error}{setting.where}"
    quick = [
        setting for setting, result in results.items() if not result.error and result.least < plan.budget
    ]
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
    if result.error:
        return Row(*known, None, None, None, None, result.error)
    error = setting.problem.error(result.outputs["source.position"])
    note = ""
    if error < setting.problem.uncertainty and setting.problem.uncertainty > 1e-13:
        note = f"the reference is good to {setting.problem.uncertainty:.0e} m"
    return Row(*known, result.median, result.least, error, result.outputs["contact.onsets"], note)


def stiff_setting(tolerance: float) -> str:
    return f"p_n in N/m at relative tolerance {tolerance:g}"


def work_precision(problems: Iterable[Problem], plan: Plan, say: Say) -> list[Row]:
    """Methods x tolerances x communication steps; those of one problem and step take turns"""
    rows = []
    for problem in problems:
        for steps in plan.communication_steps:
            say(f"{problem.name}, {steps} communication steps")
            ladders = [
                [Setting(problem, method, tolerance, steps) for tolerance in plan.tolerances]
                for method in METHODS
            ]
            rows += [row_of(*pair) for pair in run_ladders(ladders, plan).items()]
    return rows


def compare_best(problems: Iterable[Problem], rows: Sequence[Row], plan: Plan, say: Say) -> list[dict]:
    """The best of CVODE against the best of event_driven, in one run each"""
    effort = Effort(plan.ratio_repeat, 0, plan.tolerances, 8 * plan.budget, 20 * plan.limit)
    found = []
    for problem in problems:
        for steps in plan.communication_steps:
            say(f"{problem.name}, {steps} communication steps: the best of each")
            tried = [
                (Setting(problem, row.solver, row.parameter, steps), row.time_s, row.error_m)
                for row in rows
                if (row.problem, row.communication_steps) == (problem.name, steps) and row.measured
            ]
            row, (theirs, ours) = best.race(problem.name, tried, effort)
            entry = {"problem": problem.name, "communication_steps": steps, "ratio": None}
            if row.ratio:
                entry |= {"cvode": _side(theirs, row, 0), "event_driven": _side(ours, row, 1)}
                entry |= {
                    "ratio": row.first_time / row.second_time,
                    "ratio_of_least": row.least[0] / row.least[1],
                }
            found.append(entry)
    return found


def _side(setting: Setting, row: best.Comparison, which: int) -> dict:
    return {
        "solver": setting.method,
        "tolerance": setting.tolerance,
        "time_s": (row.first_time, row.second_time)[which],
        "time_min_s": row.least[which],
        "error_m": row.errors[which],
    }


def stiffness(plan: Plan, say: Say) -> list[Row]:
    """Time and error against p_n; CVODE runs with one tolerance and one communication step"""
    rows: list[Row] = []
    for name, family in stiff_families().items():
        say(name)
        problems = [problem for problem in family if problem.penalty_factor in plan.penalty_factors]
        ladders = []
        for method in METHODS:
            ours = method == EVENT_DRIVEN
            for tolerance in plan.stiff_tolerances if ours else (STIFF_TOLERANCE,):
                for steps in plan.communication_steps if ours else (1,):
                    ladders.append([Setting(problem, method, tolerance, steps) for problem in problems])
        rows += [row_of(*pair, stiff=True) for pair in run_ladders(ladders, plan).items()]
    return rows
