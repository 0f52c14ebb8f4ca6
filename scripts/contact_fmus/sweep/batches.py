"""How the runs that are left are cut into batches: long enough to cost little, short enough to lose little"""

from __future__ import annotations

from collections import deque

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
