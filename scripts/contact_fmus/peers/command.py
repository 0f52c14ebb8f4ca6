"""The command peers: peers.csv and peers.json for the report's page (docs/report_parts.md)"""

import contextlib
import importlib
import importlib.metadata
import importlib.util
import math
import multiprocessing
import os
import statistics
import time
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from contact_fmus.bench.problems import ISLANDS, benchmarks, stored_problems
from contact_fmus.options import parse
from contact_fmus.pages import matched, read_words, stopwatch, write_json
from contact_fmus.report.measure import PEER, SAME, Row, of_codes, write_rows

from .problems import BallAndWall, Case, Cradle, problem_of

# One peer in a process of its own, so that it may hang, crash or print without harm to the report.
#
# Times are taken inside that process: of stepping alone, in several repeats, each of a model made anew.


class Plan(NamedTuple):
    """How much is asked of one case"""

    repeats: int
    enough: float  # s of stepping, after which it is not repeated any more
    patience: float  # s for all of it, the making of models included


FULL = Plan(7, 0.6, 30.0)
QUICK = Plan(3, 0.1, 10.0)
START = 90.0  # s more for a process's first case, which loads the peer
DESOLVE = Path("/usr/lib/R/site-library/deSolve/DESCRIPTION")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class Measured(NamedTuple):
    times: Sequence[float] = ()
    state: Sequence[float] = ()  # position and velocity
    onsets: int | None = None
    error: str = ""  # why there is nothing


def measure(module: Any, problem: BallAndWall | Cradle, case: Case, plan: Plan) -> Measured:
    times: list[float] = []
    try:
        while len(times) < plan.repeats and sum(times) < plan.enough:
            run = module.prepare(problem, case)
            begin = time.perf_counter()
            run.advance()
            times.append(time.perf_counter() - begin)
            state, onsets = [float(x) for x in run.state()], run.onsets()
    except Exception as error:  # whatever a peer raises is a line of the report
        text = " ".join(str(error).split())
        return Measured(error=f"{type(error).__name__}: {text}"[:200])
    return Measured(times, state, onsets)


def serve(connection: Any, module_name: str) -> None:
    """Answers cases until the other end is closed. What a peer prints goes nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    os.environ.update(dict.fromkeys(THREADS, "1"))
    module = importlib.import_module(module_name)
    while True:
        try:
            question = connection.recv()
        except EOFError:
            return
        connection.send(measure(module, *question))


class Worker:
    """The process, started when it is needed and again after it was ended"""

    def __init__(self, module_name: str) -> None:
        self.module_name = module_name
        self.process: Any = None
        self.connection: Any = None

    def close(self) -> None:
        if self.process is not None:
            self.connection.close()
            self.process.kill()
            self.process.join()
            self.process = None

    def ask(self, problem: BallAndWall | Cradle, case: Case, plan: Plan) -> tuple[Measured, bool]:
        """What was measured, and whether it took too long"""
        fresh = self.process is None
        if fresh:
            context = multiprocessing.get_context("spawn")
            self.connection, theirs = context.Pipe()
            self.process = context.Process(target=serve, args=(theirs, self.module_name), daemon=True)
            self.process.start()
            theirs.close()
        try:
            self.connection.send((problem, case, plan))
            if self.connection.poll(plan.patience + (START if fresh else 0.0)):
                return self.connection.recv(), False
        except (EOFError, OSError):
            self.process.join()
            status = self.process.exitcode
            self.close()
            return Measured(error=f"its process ended with status {status}"), False
        self.close()
        return Measured(error=f"not done after {plan.patience:g} s"), True


# Runs the peers and yields the rows of peers.csv; requirements-peers.txt lists the packages, none of which
# must be there. A peer that is missing, cannot express a problem, fails or takes too long gives rows that say
# so.

CRADLES = ("cradle", "cradle Hertz")
PEERS = tomllib.loads(Path(__file__).with_name("peers.toml").read_text(encoding="utf-8"))


def cases(peer: dict[str, Any], problem: str, quick: bool) -> Iterator[Case]:
    for row in peer["runs"]:
        if problem not in row.get("problems", benchmarks()):
            continue
        law, note = row.get("law", SAME), row.get("note", {}).get(problem, "")
        for setting in row["settings"]:
            for parameter in row.get("quick", ()) if quick else row["parameters"]:
                if parameter >= row.get("finest", {}).get(problem, 0.0):
                    yield Case(row["integrator"], setting, parameter, law, note)


def versions() -> dict[str, str]:
    """The versions of installed peers, and of the packages that they need"""
    found = {}
    for package in (package for peer in PEERS.values() for package in peer["packages"]):
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            found[package] = importlib.metadata.version(package)
    if DESOLVE.is_file():
        found["R package deSolve (RADAU5)"] = matched(r"^Version: (\S+)", DESOLVE, "unknown")
    return found


def run(
    problems: Iterable[str] | None = None, quick: bool = False, names: Iterable[str] = tuple(PEERS)
) -> Iterator[Row]:
    """Rows of each peer on each problem, as they come"""
    wanted = [problem_of(name) for name in (problems or [*benchmarks(), *CRADLES])]
    for name in names:
        peer = PEERS[name]
        known = [*benchmarks(), *(one for row in peer["runs"] for one in row.get("problems", ()))]
        chosen = [problem for problem in wanted if problem.name in known]
        if importlib.util.find_spec(peer["import"]) is None:
            for problem in chosen:
                note = f"not installed: {' and '.join(peer['packages'])}"
                yield Row(problem.name, PEER, peer["name"], note=note)
            continue
        with contextlib.closing(Worker(f"contact_fmus.peers.{name}_peer")) as worker:
            for problem in chosen:
                yield from run_problem(peer, worker, problem, quick)


def run_problem(peer: dict[str, Any], worker: Worker, problem: BallAndWall | Cradle, quick: bool) -> Iterator[Row]:
    too_long: set[tuple[str, str]] = set()
    case = None
    for case in cases(peer, problem.name, quick):
        known = (problem.name, PEER, f"{peer['name']} {case.integrator}", case.law, case.setting, case.parameter)
        key = case.integrator, case.setting
        if key in too_long:
            yield Row(*known, note="left out: a coarser run already took too long")
            continue
        measured, late = worker.ask(problem, case, QUICK if quick else FULL)
        if late:
            too_long.add(key)
        yield measured_row(known, case, measured)
    if case is None:
        yield Row(problem.name, PEER, peer["name"], note=f"cannot be expressed: {peer['cannot']}")


def measured_row(known: tuple, case: Case, measured: Measured) -> Row:
    if measured.error:
        return Row(*known, note=measured.error)
    problem, times = (benchmarks() | stored_problems(ISLANDS))[known[0]], measured.times
    error = problem.error(measured.state[: len(problem.position)])
    if not math.isfinite(error):
        return Row(*known, note="the position at the end is not finite")
    return Row(*known, None, statistics.median(times), min(times), error, measured.onsets, case.note)


def main(arguments: list[str] | None = None) -> int:
    options = parse("peers", arguments)
    file = options.output if options.output.suffix == ".csv" else options.output / "peers.csv"
    file.parent.mkdir(parents=True, exist_ok=True)
    say = stopwatch()
    names = options.only or [*PEERS, "codes"]
    rows = of_codes(options.quick, say) if "codes" in names and not options.problem else []
    for row in run(options.problem, options.quick, [name for name in names if name in PEERS]):
        rows.append(row)
        say(line(row))
    rows = write_rows(file, rows, keep=bool(options.problem))
    part = {"versions": versions(), "sections": [section(rows, [*PEERS, "codes"] if options.problem else names)]}
    write_json(file.with_suffix(".json"), part)
    return 0


def line(row: Row) -> str:
    if not row.measured:
        return f"{row.problem} {row.solver} {row.parameter or ''}: {row.note}"
    result = f"{row.time_s * 1e3:.3g} ms, error {row.error_m:.1e} m"
    return f"{row.problem} {row.solver}, {row.setting} {row.parameter:g}: {result}"


def section(rows: Iterable[Row], names: Iterable[str]) -> dict:
    """The section of the page: each peer's law, and the runs that could not be measured"""
    words = read_words(__file__)
    peers = [[PEERS[name]["name"], PEERS[name]["law"]] for name in names if name in PEERS]
    peers += [[name, law] for name, law in words["codes"].items() if "codes" in names]
    gaps = dict.fromkeys(
        (row.solver, row.problem, row.setting, f"{row.parameter or ''}", row.note) for row in rows if not row.measured
    )
    tables = [{"caption": "What each peer computes", "header": ["peer", "law"], "rows": peers}]
    if gaps:
        header = ["solver", "problem", "setting", "", "why"]
        tables.append({"caption": "Not measured", "header": header, "rows": [list(gap) for gap in gaps]})
    return words["peers"] | {"tables": tables}
