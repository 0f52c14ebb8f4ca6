"""Runs the peers and yields the rows of peers.csv; requirements-peers.txt lists the packages, none of which
must be there. A peer that is missing, cannot express a problem, fails or takes too long gives rows that say
so.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import math
from collections.abc import Iterable, Iterator
from types import ModuleType

from contact_fmus.bench.problems import benchmarks
from contact_fmus.report.rows import PEER, Row

from .case import BallAndWall, CannotExpress, Case
from .problems import error_of, problem_of
from .worker import FULL, QUICK, Measured, Worker, median

NAMES = ("scipy", "exudyn", "mujoco", "lammps", "drake")


def module_of(name: str) -> ModuleType:
    return importlib.import_module(f"contact_fmus.peers.{name}_peer")


def versions() -> dict[str, str]:
    """Of the peers that are installed, and what they need"""
    found = {}
    for name in NAMES:
        for package in module_of(name).PACKAGES:
            try:
                found[package] = importlib.metadata.version(package)
            except importlib.metadata.PackageNotFoundError:
                continue
    return found


def run(
    problems: Iterable[str] | None = None, quick: bool = False, names: Iterable[str] = NAMES
) -> Iterator[Row]:
    """Rows of each peer on each problem, as they come"""
    chosen = [problem_of(name) for name in (benchmarks() if problems is None else problems)]
    for name in names:
        module = module_of(name)
        if importlib.util.find_spec(module.IMPORT) is None:
            for problem in chosen:
                yield unmeasured(module, problem, f"not installed: {' and '.join(module.PACKAGES)}")
            continue
        with Worker(module.__name__) as worker:
            for problem in chosen:
                yield from run_problem(module, worker, problem, quick)


def run_problem(module: ModuleType, worker: Worker, problem: BallAndWall, quick: bool) -> Iterator[Row]:
    too_long: set[tuple[str, str]] = set()
    try:
        cases = list(module.cases(problem, quick))
    except CannotExpress as reason:
        yield unmeasured(module, problem, f"cannot be expressed: {reason}")
        return
    for case in cases:
        key = case.integrator, case.setting
        if key in too_long:
            yield row_of(module, problem, case, note="left out: a coarser run already took too long")
            continue
        measured, late = worker.ask(problem, case, QUICK if quick else FULL)
        if late:
            too_long.add(key)
        yield measured_row(module, problem, case, measured)


def measured_row(module: ModuleType, problem: BallAndWall, case: Case, measured: Measured) -> Row:
    if measured.error:
        return row_of(module, problem, case, note=measured.error)
    error = error_of(problem.name, measured.position)
    if not math.isfinite(error):
        return row_of(module, problem, case, note="the position at the end is not finite")
    times = measured.times
    return row_of(module, problem, case, median(times), min(times), error, measured.onsets, case.note)


def row_of(
    module: ModuleType,
    problem: BallAndWall,
    case: Case,
    time: float | None = None,
    least: float | None = None,
    error: float | None = None,
    onsets: int | None = None,
    note: str = "",
) -> Row:
    solver = f"{module.NAME} {case.integrator}"
    where = (problem.name, PEER, solver, case.law, case.setting, case.parameter)
    return Row(*where, None, time, least, error, onsets, note)


def unmeasured(module: ModuleType, problem: BallAndWall, note: str) -> Row:
    return Row(problem.name, PEER, module.NAME, "", "", None, None, None, None, None, None, note)
