"""Batches go to the workers, rows come back and are written: a few in flight, whatever the number of runs"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from distributed import CancelledError, Client, Future, wait
from distributed.client import ClosedClientError
from distributed.scheduler import KilledWorker

from contact_fmus.errors import RunFailure

from .batches import Cutter
from .plan import Rows
from .planning import make_batch
from .samples import Samples
from .store import Store
from .study import Study
from .table import CRASH, make_table
from .worker import Work, run_batch, work

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
            self._cancel()

    def _cancel(self) -> None:
        """Nothing of this study is left at a scheduler that lives on"""
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
        # In the order of runs: what is done is one stretch, or nearly.
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
            raise self._explained(error)
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
        return self._write(
            flight, Rows(first, values, np.array([CRASH], np.uint8), said, 0.0, np.zeros(1, np.int32))
        )

    def _explained(self, error: BaseException) -> RunFailure:
        if isinstance(error, ModuleNotFoundError):
            said = f"the workers have no Python module {error.name}: install 'contact-fmus[sweep]' there"
        else:
            said = (
                f"a worker failed: {type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"
            )
        return RunFailure(f"{said}; {self._kept()}")
