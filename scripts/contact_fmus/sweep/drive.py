"""Batches go to the workers, rows come back and are written: a few in flight, whatever the number of runs"""

import contextlib
import logging
import signal
import threading
import time
import tomllib
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import dask
import numpy as np
from distributed import CancelledError, Client, Future, LocalCluster, wait
from distributed.client import ClosedClientError
from distributed.comm import parse_address
from distributed.scheduler import KilledWorker

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.variables import is_fmi3

from .native import AT, MAX, MEAN, MIN, Batch, Plan, Rows, Setting
from .store import CRASH, Store, make_table
from .study import Samples, Study, point_of
from .worker import Work, run_batch, work

# How the runs that are left are cut into batches: long enough to cost little, short enough to lose little

SECONDS = 1.0  # of a batch: dask and the file of a batch cost ten milliseconds, an interrupt loses so much
MOST = 25_000  # runs of a batch: some MB of rows, in flight a few times for each worker
SHORTEST = 0.1  # s of the last batches
FIRST = 16  # runs of the first ones, before it is known how long a run takes
GROWTH = 16  # at most so many times the runs of the longest batch measured


class Cutter:
    """Hands out stretches of runs, and takes back those that are to be done again"""

    def __init__(self, gaps: list[tuple[int, int]]):
        self._left = deque(gaps)
        self._most = FIRST
        self.rate = 0.0  # runs/s of one worker

    @property
    def left(self) -> int:
        return sum(end - first for first, end in self._left)

    def next(self, workers: int) -> tuple[int, int] | None:
        """First run and run after the last, None when none is left"""
        if not self._left:
            return None
        first, end = self._left.popleft()
        # The last batches are short, so that all workers end together.
        fair = (self.left + end - first) // (2 * max(workers, 1))
        stop = min(end, first + max(1, min(self._most, max(fair, int(SHORTEST * self.rate)))))
        if stop < end:
            self._left.appendleft((stop, end))
        return first, stop

    def measured(self, runs: int, seconds: float) -> None:
        self.rate = runs / max(seconds, 1e-9)
        self._most = int(min(MOST, GROWTH * max(self._most, 1), max(1.0, self.rate * SECONDS)))

    def again(self, first: int, end: int) -> None:
        """A batch of which nothing came"""
        self._left.appendleft((first, end))


# The plan of a study, and the start values of its batches

CODES = {"last": AT, "at": AT, "max": MAX, "min": MIN, "mean": MEAN}
REAL, INTEGER, BOOLEAN = range(3)
TYPES = {"Real": REAL, "Integer": INTEGER, "Enumeration": INTEGER, "Boolean": BOOLEAN}


def make_plan(study: Study) -> Plan:
    read: list[dict[int, int]] = [{}, {}, {}]
    for one in study.outputs:
        kind = read[TYPES[one.variable.type]]
        kind.setdefault(one.variable.references[0], len(kind))
    offsets = np.cumsum([0, *map(len, read)])
    rows, last = [], len(study.points)
    reads = np.zeros(last + 1, np.uint8)
    for one in study.outputs:
        kind = TYPES[one.variable.type]
        time = study.points[-1] if one.time is None else one.time
        point = point_of(time, study.start_time, study.points)
        assert point is not None
        rows.append((offsets[kind] + read[kind][one.variable.references[0]], CODES[one.reduction], point))
        reads[point if CODES[one.reduction] == AT else slice(None)] = 1
    strings = [(name, value) for name, value in study.constants.items() if isinstance(value, str)]
    about, references = study.interface.about, study.interface.variables
    return Plan(
        about.coSimulation.modelIdentifier,
        about.guid,
        is_fmi3(about),
        study.start_time,
        study.tolerance,
        np.array(study.points),
        reads,
        tuple(_setting(study, kind) for kind in (REAL, INTEGER, BOOLEAN)),  # type: ignore[arg-type]
        tuple((references[name].references[0], value) for name, value in strings),
        tuple(np.array(list(kind), np.uint32) for kind in read),  # type: ignore[arg-type]
        np.array(rows, np.int64).reshape(-1, 3),
    )


def make_work(study: Study) -> Work:
    single = study.interface.about.coSimulation.canBeInstantiatedOnlyOncePerProcess
    return Work(study.fmu.read_bytes(), make_plan(study), bool(single))


def _setting(study: Study, kind: int) -> Setting:
    variables = study.interface.variables
    varied = [
        reference
        for one in study.parameters
        if TYPES[one.variable.type] == kind
        for reference in one.variable.references
    ]
    references, constants = list(varied), []
    for name, value in study.constants.items():
        if TYPES.get(variables[name].type) == kind:
            references += variables[name].references
            constants += value if isinstance(value, tuple) else [value]
    number = float if kind == REAL else np.int32
    return Setting(np.array(references, np.uint32), len(varied), np.array(constants, number))


def make_batch(study: Study, first: int, values: dict[str, np.ndarray]) -> Batch:
    """`values` are those of Samples.values"""
    count = len(next(iter(values.values())))

    def stacked(kind: int) -> np.ndarray:
        number = float if kind == REAL else np.int32
        rows = [values[one.name].T for one in study.parameters if TYPES[one.variable.type] == kind]
        return np.ascontiguousarray(np.concatenate(rows), number) if rows else np.zeros((0, count), number)

    return Batch(first, tuple(stacked(kind) for kind in (REAL, INTEGER, BOOLEAN)))


# Ctrl-C and SIGTERM alike ask for an end

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """An exception is lost where a signal happens to meet a finalizer (dask's futures have one). While
    somebody looks often, the first signal is only noted."""

    def __init__(self) -> None:
        self._asked = 0
        self._looked_for = False

    def _answer(self, *_) -> None:
        self._asked += 1
        if self._asked > 1 or not self._looked_for:
            raise KeyboardInterrupt

    def look(self) -> None:
        """Ends what goes on if that has been asked for"""
        if self._asked:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def answered(self) -> Iterator[None]:
        """Signals come here; they are the main thread's"""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.signal(number, self._answer) for number in SIGNALS}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    @contextlib.contextmanager
    def looked_for(self) -> Iterator[None]:
        """Within, somebody calls look() at least every second"""
        self._looked_for = True
        try:
            yield
        finally:
            self._looked_for = False
        self.look()


# The workers: an embedded cluster of dask.distributed, or one that is already there

ARRIVE = 60.0  # s that a scheduler's first worker has to appear
SETTINGS = tomllib.loads(Path(__file__).with_name("dask.toml").read_text(encoding="utf-8"))
CONNECT = SETTINGS["distributed.comm.timeouts.connect"]


@contextlib.contextmanager
def connected(address: str | None, workers: int, dashboard: str | None = None) -> Iterator[Client]:
    """A client with at least one worker"""
    logging.disable(logging.CRITICAL)  # dask tells of each broken connection; what matters is said in words
    try:
        with (
            dask.config.set(SETTINGS),
            _embedded(workers, dashboard) if address is None else _elsewhere(address) as client,
        ):
            yield client
    finally:
        logging.disable(logging.NOTSET)


@contextlib.contextmanager
def _embedded(workers: int, dashboard: str | None) -> Iterator[Client]:
    """Processes of this machine that nobody else can reach"""
    cluster = LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        # dask serves its state in any case; a port of the loopback that is free
        dashboard_address=dashboard or "127.0.0.1:0",
        worker_dashboard_address="127.0.0.1:0",
        memory_limit=None,
        preload="contact_fmus.sweep.worker",
        silence_logs=logging.CRITICAL,
    )
    with cluster, Client(cluster) as client:
        yield client
        # A worker that an FMU has ended comes back: while its cluster closes it would complain on stderr.
        with contextlib.suppress(TimeoutError):
            client.wait_for_workers(workers, timeout=ARRIVE)


@contextlib.contextmanager
def _elsewhere(address: str) -> Iterator[Client]:
    try:
        parse_address(address, strict=True)
        client = Client(address, timeout=CONNECT)
    except (OSError, TimeoutError):
        said = f"within {CONNECT:g} s; is it running, and is the address that of its start message?"
        raise RunFailure(f"--scheduler {address}: no scheduler answers {said}") from None
    except (ValueError, TypeError) as error:
        reason = str(error).splitlines()[0]
        raise UserError(f"--scheduler {address}: an address like tcp://host:8786 is wanted ({reason})") from None
    try:
        with contextlib.suppress(TimeoutError):
            client.wait_for_workers(1, timeout=ARRIVE)
        if not client.ncores():
            raise RunFailure(f"--scheduler {address}: no worker there within {ARRIVE:g} s")
        yield client
    finally:
        with contextlib.suppress(Exception):  # the scheduler may be gone
            client.close(timeout=2)


IN_FLIGHT = 3  # batches for each thread of a worker: one at work, one that waits, one under way
LOST = 60.0  # s without a scheduler or a worker after which it is given up
TICK = 0.5  # s between looks at the scheduler


@dataclass
class _Flight:
    first: int
    end: int
    values: dict[str, np.ndarray]
    alone: bool


class Drive:
    """All runs that the store does not have yet"""

    def __init__(self, client: Client, study: Study, samples: Samples, store: Store, given: Work):
        self.client, self.study, self.samples, self.store = client, study, samples, store
        self.cutter = Cutter(store.gaps())
        self.flights: dict[Future, _Flight] = {}
        self.suspects: list[tuple[int, int]] = []  # stretches that may end a worker's process
        self.work = client.submit(work, given, pure=False)
        self._missing_since: float | None = None

    def run(self, progress: Callable[[int], None], look: Callable[[], None]) -> None:
        """`progress` is told of runs that were written; `look` may end it with an exception"""
        try:
            while self._fill() or self.flights:
                look()
                for future in self._finished():
                    look()
                    progress(self._take(future))
        except (OSError, ClosedClientError):  # of a connection: the store tells its own in words
            raise RunFailure(f"the scheduler is gone; {self._kept()}") from None
        finally:
            # A scheduler that lives on shall keep nothing of this study.
            with contextlib.suppress(OSError, CancelledError, ClosedClientError):
                if self.client.status == "running" and self.flights:
                    self.client.cancel(list(self.flights), force=True)

    def _fill(self) -> bool:
        """True while batches are left"""
        if self.client.status != "running":
            return True
        if self.suspects:
            # With others in flight dask could not tell whose fault the end of a process is.
            if not self.flights:
                self._submit(*self.suspects.pop(), alone=True)
            return True
        threads = sum(self.client.ncores().values())
        while len(self.flights) < IN_FLIGHT * max(threads, 1):
            stretch = self.cutter.next(threads)
            if stretch is None:
                return False
            self._submit(*stretch)
        return True

    def _submit(self, first: int, end: int, alone: bool = False) -> None:
        values = self.samples.values(first, end - first)
        batch = make_batch(self.study, first, values)
        # Runs go out in their order, so that the runs done are one stretch, or nearly.
        future = self.client.submit(run_batch, self.work, batch, pure=False, priority=-first)
        self.flights[future] = _Flight(first, end, values, alone)

    def _finished(self) -> list[Future]:
        self._watch()
        if not self.flights:
            time.sleep(TICK)
            return []
        try:
            done = wait(list(self.flights), timeout=TICK, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            return []
        except CancelledError:  # the scheduler forgot some
            done = {future for future in self.flights if future.done()}
        return sorted(done, key=lambda future: self.flights[future].first)

    def _watch(self) -> None:
        """A scheduler, or the last worker, that is away for long is gone"""
        alive = self.client.status == "running"
        if alive and self.client.ncores():
            self._missing_since = None
            return
        self._missing_since = self._missing_since or time.monotonic()
        if self.client.status == "closed" or time.monotonic() - self._missing_since > LOST:
            raise RunFailure(f"the {'last worker' if alive else 'scheduler'} is gone; {self._kept()}")

    def _kept(self) -> str:
        store = self.store
        return f"{store.done():,} of {store.runs:,} runs are kept in {store.folder}, --resume goes on"

    def _take(self, future: Future) -> int:
        """Writes what a batch gave; the number of its runs"""
        flight = self.flights.pop(future)
        self._missing_since = None
        error = future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            return self._crashed(flight)
        if error is not None:
            said = f"a worker failed: {type(error).__name__}: {next(iter(str(error).splitlines()), '')}"
            if isinstance(error, ModuleNotFoundError):
                said = f"the workers have no Python module {error.name}: install 'contact-fmus[sweep]' there"
            raise RunFailure(f"{said}; {self._kept()}")
        try:
            rows = None if future.status in ("cancelled", "lost") else future.result()
        except CancelledError:  # the scheduler ended while it was asked
            rows = None
        if rows is None:  # the scheduler forgot it
            self.cutter.again(flight.first, flight.end)
            return 0
        self.cutter.measured(flight.end - flight.first, rows.seconds)
        return self._write(flight, rows)

    def _write(self, flight: _Flight, rows: Rows) -> int:
        self.store.write(make_table(self.study, self.store.schema, flight.values, rows), flight.first)
        return flight.end - flight.first

    def _crashed(self, flight: _Flight) -> int:
        """A batch was at work each time when two processes ended. It is run alone; where it ends processes
        then too, its halves are, until the run that does it is found and has a row that says so."""
        first, end = flight.first, flight.end
        if not flight.alone:
            self.suspects.append((first, end))
            return 0
        if end - first > 1:
            middle = (first + end) // 2
            self.suspects += [(middle, end), (first, middle)]
            return 0
        values = np.full((len(self.study.outputs), 1), np.nan)
        said = {0: "the FMU ended the worker's process"}
        return self._write(flight, Rows(first, values, np.array([CRASH], np.uint8), said, 0.0, np.zeros(1, np.int32)))
