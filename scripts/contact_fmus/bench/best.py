"""The quickest CVODE setting that reaches 1e-7 m against the quickest of event_driven that reaches 1e-9 m"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from contact_fmus.fmu.host import run_host

from .problems import Problem, benchmarks, law_benchmarks
from .ratios import Comparison, Effort, compare
from .settings import CVODE, CVODE_ERROR, EVENT_DRIVEN, EVENT_DRIVEN_ERROR, Setting

SIDES = {CVODE: CVODE_ERROR, (EVENT_DRIVEN,): EVENT_DRIVEN_ERROR}  # methods: m, what they have to reach

# A setting that has been run, its time in s and its error in m
Tried = tuple[Setting, float, float]


def best(tried: Iterable[Tried], methods: Sequence[str]) -> Setting | None:
    """The setting of these methods with the least time among those that come as close as they have to"""
    fit = [
        (time, setting)
        for setting, time, error in tried
        if setting.method in methods and error <= SIDES[methods]
    ]
    return min(fit, key=lambda one: one[0], default=(0.0, None))[1]


def try_all(problem: Problem, effort: Effort) -> list[Tried]:
    """Both sides with one communication step over the effort's tolerances; what is refused is left out"""
    found = []
    for methods in SIDES:
        settings = [
            Setting(problem, method, tolerance, 1) for method in methods for tolerance in effort.tolerances
        ]
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
