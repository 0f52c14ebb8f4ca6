"""One peer in a process of its own, so that it may hang, crash or print without harm to the report.

Times are taken inside that process: of stepping alone, in several repeats, each of a model made anew.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
import statistics
import time
from typing import Any, NamedTuple

from .case import BallAndWall, Case


class Plan(NamedTuple):
    """How much is asked of one case"""

    repeats: int
    enough: float  # s of stepping, after which it is not repeated any more
    patience: float  # s for all of it, the making of models included


FULL = Plan(7, 0.6, 30.0)
QUICK = Plan(3, 0.1, 10.0)
START = 90.0  # s more for a process's first case, which loads the peer
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class Measured(NamedTuple):
    times: list[float]
    position: list[float]
    onsets: int | None
    error: str = ""  # why there is nothing


def failed(text: str) -> Measured:
    return Measured([], [], None, text)


def measure(module: Any, problem: BallAndWall, case: Case, plan: Plan) -> Measured:
    times: list[float] = []
    try:
        while len(times) < plan.repeats and sum(times) < plan.enough:
            run = module.prepare(problem, case)
            begin = time.perf_counter()
            run.advance()
            times.append(time.perf_counter() - begin)
            position, onsets = [float(x) for x in run.position()], run.onsets()
    except Exception as error:  # whatever a peer raises is a line of the report
        text = " ".join(str(error).split())
        return failed(f"{type(error).__name__}: {text}"[:200])
    return Measured(times, position, onsets)


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

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, self.module_name), daemon=True)
        self.process.start()
        theirs.close()

    def stop(self) -> None:
        if self.process is not None:
            self.connection.close()
            self.process.kill()
            self.process.join()
            self.process = None

    def ask(self, problem: BallAndWall, case: Case, plan: Plan) -> tuple[Measured, bool]:
        """What was measured, and whether it took too long"""
        fresh = self.process is None
        if fresh:
            self.start()
        try:
            self.connection.send((problem, case, plan))
            if self.connection.poll(plan.patience + (START if fresh else 0.0)):
                return self.connection.recv(), False
        except (EOFError, OSError):
            self.process.join()
            status = self.process.exitcode
            self.stop()
            return failed(f"its process ended with status {status}"), False
        self.stop()
        return failed(f"not done after {plan.patience:g} s"), True


def median(times: list[float]) -> float:
    return statistics.median(times)
