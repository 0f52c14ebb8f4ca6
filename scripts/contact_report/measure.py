"""The FMU's solvers, measured: error against time, the ratio of the best ones, time against stiffness."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from contact_scenarios.fmu_files import fmu_file

from .host import Case, HostError, HostTimeout, Result, run_host
from .problems import Problem, benchmarks, stiff_families
from .rows import RELATIVE_TOLERANCE, SAME, THIS_FMU, Row

EVENT_DRIVEN, CVODE = "event_driven", ("cvode_bdf", "cvode_adams")
METHODS = (EVENT_DRIVEN, *CVODE)
ABSOLUTE = 1e-4  # absolute tolerance / relative tolerance, as in the start values
CVODE_ERROR, EVENT_DRIVEN_ERROR = 1e-7, 1e-9  # m, what the compared runs have to reach
STIFF_TOLERANCE = 1e-9  # of the runs that the stiffness tables show

Say = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How much is run"""

    tolerances: Sequence[float]
    communication_steps: Sequence[int]
    repeat: int  # turns of a case
    burst: int  # runs in a turn
    budget: float  # s; a case that ran so long is not run again
    limit: float  # s; a case that is not done by then is given up
    ratio_repeat: int
    stiff_tolerances: Sequence[float]
    stiff_every: int  # each such penalty factor of the sweep


FULL = Plan([10.0**-k for k in range(4, 14)], (1, 997), 5, 3, 0.4, 5.0, 15, (1e-6, 1e-9, 1e-12), 1)
QUICK = Plan((1e-6, 1e-10), (1, 7), 2, 1, 0.05, 2.0, 2, (1e-9,), 5)


class Setting(NamedTuple):
    """One way to solve a problem"""

    problem: Problem
    method: str
    tolerance: float
    steps: int

    def case(self) -> Case:
        start = {
            **self.problem.start,
            "solver.method": self.method,
            "solver.relative_tolerance": self.tolerance,
            "solver.absolute_tolerance": ABSOLUTE * self.tolerance,
        }
        name = f"{self.problem.title}, {self.method}, {self.tolerance:g}, {self.steps} steps"
        outputs = ("source.position", "contact.onsets")
        return Case(name, fmu_file(self.problem.fmu), self.problem.stop, self.steps, start, outputs=outputs)


def run_settings(settings: Sequence[Setting], plan: Plan) -> list[Result]:
    """All in one process, taking turns; should that hang, each in one of its own with plan.limit"""
    cases = [setting.case() for setting in settings]
    options = {"repeat": plan.repeat, "burst": plan.burst, "budget": plan.budget, "keep_going": True}
    if len(cases) > 1:
        together = plan.limit + len(cases) * (plan.budget + 0.5)
        try:
            return run_host(cases, **options, timeout=together)
        except HostTimeout:
            pass
    return [_run_alone(case, options, plan) for case in cases]


def _run_alone(case: Case, options: dict, plan: Plan) -> Result:
    try:
        return run_host([case], **options, timeout=plan.limit + plan.budget)[0]
    except HostTimeout:
        return Result(case.name, [], [], {}, f"not done after {plan.limit:g} s")
    except HostError as error:
        return Result(case.name, [], [], {}, str(error))


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


def work_precision(plan: Plan, say: Say) -> list[Row]:
    """P1 to P3b: methods x tolerances x communication steps; those of one problem and step take turns"""
    rows = []
    for problem in benchmarks().values():
        for steps in plan.communication_steps:
            say(f"{problem.name}, {steps} communication steps")
            settings = [
                Setting(problem, method, tolerance, steps)
                for method in METHODS
                for tolerance in plan.tolerances
            ]
            rows += [row_of(*pair) for pair in zip(settings, run_settings(settings, plan), strict=True)]
    return rows


def fastest(
    rows: Sequence[Row], problem: str, solvers: Sequence[str], steps: int, error: float
) -> Row | None:
    """The quickest row of these solvers that is no further off"""
    fit = [
        row
        for row in rows
        if (row.problem, row.communication_steps) == (problem, steps)
        and row.solver in solvers
        and row.measured
        and row.error_m <= error
    ]
    return min(fit, key=lambda row: row.time_s, default=None)


def compare_best(rows: Sequence[Row], plan: Plan, say: Say) -> list[dict]:
    """The best CVODE setting that reaches 1e-7 against event_driven that reaches 1e-9, in one run each"""
    found = []
    for problem in benchmarks().values():
        for steps in plan.communication_steps:
            say(f"{problem.name}, {steps} communication steps: the best of each")
            ours = fastest(rows, problem.name, [EVENT_DRIVEN], steps, EVENT_DRIVEN_ERROR)
            theirs = fastest(rows, problem.name, CVODE, steps, CVODE_ERROR)
            entry = {"problem": problem.name, "communication_steps": steps, "ratio": None}
            if ours and theirs:
                entry |= _compare(problem, steps, ours, theirs, plan)
            found.append(entry)
    return found


def _compare(problem: Problem, steps: int, ours: Row, theirs: Row, plan: Plan) -> dict:
    settings = [Setting(problem, row.solver, row.parameter, steps) for row in (ours, theirs)]
    cases = [setting.case() for setting in settings]
    results = run_host(cases, repeat=plan.ratio_repeat, burst=plan.burst, budget=8 * plan.budget)
    sides = [
        {
            "solver": setting.method,
            "tolerance": setting.tolerance,
            "time_s": result.median,
            "time_min_s": result.least,
            "error_m": problem.error(result.outputs["source.position"]),
            "runs": len(result.times),
        }
        for setting, result in zip(settings, results, strict=True)
    ]
    ratio = sides[1]["time_s"] / sides[0]["time_s"]
    least = sides[1]["time_min_s"] / sides[0]["time_min_s"]
    return {"event_driven": sides[0], "cvode": sides[1], "ratio": ratio, "ratio_of_least": least}


def stiffness(plan: Plan, say: Say) -> list[Row]:
    """Time and error against p_n. A solver that takes too long is not tried at higher ones. CVODE runs with
    one tolerance and one communication step; event_driven's runs are repeated together, taking turns.
    """
    rows = []
    for name, family in stiff_families().items():
        problems = family[:: plan.stiff_every]
        for method in METHODS:
            say(f"{name}, {method}")
            rows += _stiff_runs(problems, method, plan)
    return rows


def _stiff_runs(problems: Sequence[Problem], method: str, plan: Plan) -> list[Row]:
    ours = method == EVENT_DRIVEN
    rows: list[Row] = []
    again: list[Setting] = []
    for tolerance in plan.stiff_tolerances if ours else (STIFF_TOLERANCE,):
        for steps in plan.communication_steps if ours else (1,):
            tried, fit = _climb(problems, method, tolerance, steps, plan)
            rows += tried
            again += fit
    if again:
        rows += [row_of(*pair, stiff=True) for pair in zip(again, run_settings(again, plan), strict=True)]
    return sorted(rows, key=lambda row: (row.setting, row.communication_steps, row.parameter))


def _climb(
    problems: Sequence[Problem], method: str, tolerance: float, steps: int, plan: Plan
) -> tuple[list[Row], list[Setting]]:
    """(rows, settings of event_driven that are left to be repeated together)"""
    rows: list[Row] = []
    left: list[Setting] = []
    given_up = ""
    for problem in problems:
        setting = Setting(problem, method, tolerance, steps)
        if given_up:
            result = Result(setting.case().name, [], [], {}, given_up)
        else:
            result = _run_alone(
                setting.case(), {"budget": plan.budget, "repeat": 2, "keep_going": True}, plan
            )
        if result.error.startswith("not done"):
            given_up = f"not run: {result.error} at p_n = {problem.penalty_factor:g} N/m"
        if method == EVENT_DRIVEN and not result.error and result.least < plan.budget:
            left.append(setting)
        else:
            rows.append(row_of(setting, result, stiff=True))
    return rows, left
