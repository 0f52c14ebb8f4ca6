"""Ratios of run times, each of two cases that took turns in one process. They are figures, not promises:
how fast CVODE is beside event_driven differs between processors. instructions.py counts what is
promised.

A ratio is the median over pairs of runs that followed each other (A B B A A B B A ...), so that what slows
the machine down for a while slows down both; the spread is that of the middle half of the pairs. Seconds
differ from machine to machine and from minute to minute, ratios hardly do.

flight      a 1 ms fmi2DoStep in flight and two fmi2GetReal of three values, against the same calls on
            Idle.fmu
stiffness   P3 at p_n = 1e15 N/m against 1e7 N/m, p_nv at 10 % of the critical damping
baseline    this build against that of another commit, on all of these: below 1 is quicker now. "slower" and
            "quicker" are said where that is sure to 95 % for the median; many pairs tell more than few
"""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scipy.stats import binom

from contact_fmus.fmu.files import fmu_file
from contact_fmus.fmu.host import Case, HostError, HostTimeout, Result, host_file, run_host

from .problems import (
    CVODE,
    CVODE_ERROR,
    EVENT_DRIVEN,
    EVENT_DRIVEN_ERROR,
    METHODS,
    STIFF_TOLERANCE,
    Problem,
    Setting,
    benchmarks,
    law_benchmarks,
    stiff_families,
)

SOFT, STIFF = 1e7, 1e15  # N/m
FLIGHT_STEP = 1e-3  # s
FAR_AWAY = {"source.center": [0.0, 0.0, 1e6], "solver.method": EVENT_DRIVEN}  # 451 s of fall


@dataclass(frozen=True)
class Effort:
    """The amount of runs"""

    turns: int  # of A B B A
    flight_steps: int  # in a run
    tolerances: Sequence[float]  # among which the quickest is looked for
    budget: float  # s; a case that stepped so long is not run again
    limit: float  # s; two cases that are not done by then are given up


FULL = Effort(20, 1_000, [10.0**-k for k in range(5, 14)], 1.5, 30.0)
QUICK = Effort(4, 1_000, (1e-8, 1e-10), 0.2, 20.0)
DOUBT = 0.05  # that the median is outside its bounds


@dataclass(frozen=True)
class Ratio:
    median: float
    low: float  # quartiles of the pairs
    high: float
    bounds: tuple[float, float] | None = None  # of the median; None where the pairs are too few for any


@dataclass(frozen=True)
class Comparison:
    """A line of a table: times of two cases and their ratio, or why there is none"""

    what: str
    first: str  # what was divided
    second: str  # by what
    first_time: float | None = None  # s, medians
    second_time: float | None = None
    ratio: Ratio | None = None
    errors: tuple[float | None, float | None] = (None, None)  # m
    least: tuple[float, float] | None = None  # s, the least times
    note: str = ""


def ratio_of(first: Sequence[float], second: Sequence[float]) -> Ratio:
    """The ratio of times of runs that took turns, pair by pair.

    The bounds are the sign test's: as many pairs lie beyond each as heads or tails would, of so many throws,
    in half of the doubt.
    """
    pairs = sorted(a / b for a, b in zip(first, second, strict=False))
    if len(pairs) < 2:
        return Ratio(pairs[0], pairs[0], pairs[0])
    low, median, high = statistics.quantiles(pairs, n=4, method="inclusive")
    beyond = int(binom.ppf(0.5 * DOUBT, len(pairs), 0.5))
    bounds = (pairs[beyond - 1], pairs[-beyond]) if beyond > 0 else None
    return Ratio(median, low, high, bounds)


def compare(row: Comparison, first: Case, second: Case, effort: Effort, problems: Sequence[Problem] = ()) -> Comparison:
    """`row` with times, ratio and errors of the two cases"""
    cases = [first, second, second, first]
    try:
        results = run_host(cases, effort.turns, budget=effort.budget, timeout=effort.limit)
    except HostTimeout:
        return replace(row, note=f"not done after {effort.limit:g} s")
    except HostError as error:
        return replace(row, note=str(error))
    ours, theirs = (results[i].times + results[3 - i].times for i in (0, 1))
    errors = [
        problem.error(result.outputs["source.position"]) for problem, result in zip(problems, results, strict=False)
    ]
    errors += [None] * (2 - len(errors))
    times = statistics.median(ours), statistics.median(theirs)
    return replace(
        row,
        first_time=times[0],
        second_time=times[1],
        ratio=_paired(results),
        errors=tuple(errors),
        least=(min(ours), min(theirs)),
    )


def _paired(results: Sequence[Result]) -> Ratio:
    """The pairs of A B B A are the first two and the last two. A case whose budget is spent has fewer runs."""
    first, second, second_again, first_again = (result.times for result in results)
    counts = [min(map(len, pair)) for pair in ((first, second), (first_again, second_again))]
    return ratio_of(first[: counts[0]] + first_again[: counts[1]], second[: counts[0]] + second_again[: counts[1]])


def idle_file() -> Path:
    """build/Idle.fmu, next to fmu_host"""
    return host_file().with_name("Idle.fmu")


def flight_case(fmu: str, effort: Effort) -> Case:
    stop = effort.flight_steps * FLIGHT_STEP
    get = [["source.position"], ["source.velocity"]]
    return Case(f"flight of {fmu}", fmu_file(fmu), stop, effort.flight_steps, FAR_AWAY, get=get)


def flights(effort: Effort) -> list[Comparison]:
    stop, rows = effort.flight_steps * FLIGHT_STEP, []
    idle = Case("Idle", idle_file(), stop, effort.flight_steps, get=[["position"], ["velocity"]])
    for fmu in ("SphereSphere", "SphereCylinder"):
        row = Comparison(f"1 ms in flight, {effort.flight_steps} times", fmu, "Idle")
        rows.append(compare(row, flight_case(fmu, effort), idle, effort))
    return rows


def stiff_problems() -> list[tuple[Problem, Problem]]:
    """(soft, stiff) of each damped family"""
    found = []
    for name, family in stiff_families().items():
        by_factor = {problem.penalty_factor: problem for problem in family}
        if "undamped" not in name and SOFT in by_factor and STIFF in by_factor:
            found.append((by_factor[SOFT], by_factor[STIFF]))
    return found


def stiffness(effort: Effort) -> list[Comparison]:
    rows = []
    for soft, stiff in stiff_problems():
        row = Comparison(soft.name, f"p_n = {STIFF:.0e}", f"p_n = {SOFT:.0e}")
        cases = [Setting(problem, EVENT_DRIVEN, STIFF_TOLERANCE, 1).case() for problem in (stiff, soft)]
        rows.append(compare(row, *cases, effort, (stiff, soft)))
    return rows


def baseline_cases(effort: Effort) -> list[Case]:
    """What this build and another one are compared on"""
    cases = [flight_case(fmu, effort) for fmu in ("SphereSphere", "SphereCylinder")]
    for problem in benchmarks().values():
        cases += [_named(problem, method, 1) for method in METHODS]
        cases.append(_named(problem, EVENT_DRIVEN, 997))
    return cases + [_named(problem, EVENT_DRIVEN, 1) for pair in stiff_problems() for problem in pair]


def _named(problem: Problem, method: str, steps: int) -> Case:
    what = f", p_n = {problem.penalty_factor:.0e}" if problem.name not in benchmarks() else ""
    name = f"{problem.name}{what}, {method}, {steps} step{'s' if steps > 1 else ''}"
    return replace(Setting(problem, method, STIFF_TOLERANCE, steps).case(), name=name)


def against_baseline(folder: Path, name: str, effort: Effort, cases: Sequence[Case] | None = None) -> list[Comparison]:
    """Each case with this build's FMU and with the one of the same name in `folder`"""
    rows = []
    for case in baseline_cases(effort) if cases is None else cases:
        other = replace(case, name=f"{case.name}, {name}", fmu=folder / case.fmu.name)
        rows.append(compare(Comparison(case.name, "this build", name), case, other, effort))
    return rows


# The quickest CVODE setting that reaches 1e-7 m against the quickest of event_driven that reaches 1e-9 m

SIDES = {CVODE: CVODE_ERROR, (EVENT_DRIVEN,): EVENT_DRIVEN_ERROR}  # methods: m, what they have to reach

# A setting that has been run, its time in s and its error in m
Tried = tuple[Setting, float, float]


def best(tried: Iterable[Tried], methods: Sequence[str]) -> Setting | None:
    """The setting of these methods with the least time among those that come as close as they have to"""
    fit = [(time, setting) for setting, time, error in tried if setting.method in methods and error <= SIDES[methods]]
    return min(fit, key=lambda one: one[0], default=(0.0, None))[1]


def try_all(problem: Problem, effort: Effort) -> list[Tried]:
    """Both sides with one communication step over the effort's tolerances; what is refused is left out"""
    found = []
    for methods in SIDES:
        settings = [Setting(problem, method, tolerance, 1) for method in methods for tolerance in effort.tolerances]
        cases = [setting.case() for setting in settings]
        timeout = effort.limit + len(cases) * effort.budget
        results = run_host(cases, 3, budget=effort.budget, timeout=timeout, keep_going=True)
        found += [
            (setting, result.least, problem.error(result.outputs["source.position"]))
            for setting, result in zip(settings, results, strict=True)
            if not result.error
        ]
    return found


def race(name: str, tried: Sequence[Tried], effort: Effort) -> tuple[Comparison, list[Setting | None]]:
    """The best of either side run again in turns, and which they are (CVODE's first)"""
    sides = [best(tried, methods) for methods in SIDES]
    told = [
        f"{side.method} {side.tolerance:.0e}" if side else f"{' or '.join(methods)} to {error:g} m"
        for side, (methods, error) in zip(sides, SIDES.items(), strict=True)
    ]
    row = Comparison(name, *told)
    if None in sides:
        return replace(row, note="no tolerance tried comes as close"), sides
    return compare(row, *(side.case() for side in sides), effort, [side.problem for side in sides]), sides


def against_cvode(effort: Effort, names: Sequence[str] | None = None) -> list[Comparison]:
    """Time of CVODE / time of event_driven"""
    problems = benchmarks() | law_benchmarks()
    return [race(name, try_all(problems[name], effort), effort)[0] for name in names or problems]
