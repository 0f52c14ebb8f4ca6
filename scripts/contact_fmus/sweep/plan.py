"""A study as a loop over runs needs it: value references and numbers, no names. It travels to the workers."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

AT, MAX, MIN, MEAN = range(4)  # enum batch_reduction of scripts/tools/batch/batch.h


@dataclass(frozen=True)
class Setting:
    """Start values of one type; those that vary come first"""

    references: np.ndarray  # uint32
    varied: int
    constants: np.ndarray  # of the others: float64, or int32


@dataclass(frozen=True)
class Plan:
    """One run: what is set, where steps end, what is read and reduced"""

    identifier: str
    guid: str
    fmi3: bool
    start_time: float
    tolerance: float | None
    points: np.ndarray  # float64, s
    reads: np.ndarray  # uint8: whether values are read at the start and at each point
    settings: tuple[Setting, Setting, Setting]  # Real, Integer, Boolean
    strings: tuple[tuple[int, str], ...]
    read: tuple[np.ndarray, np.ndarray, np.ndarray]  # uint32, references of each type
    outputs: np.ndarray  # int64, rows: place among values read, reduction, point


@dataclass(frozen=True)
class Batch:
    """Varied start values of a stretch of runs: for each type an array of (variables, runs)"""

    first: int
    real: np.ndarray
    integer: np.ndarray
    boolean: np.ndarray

    @property
    def runs(self) -> int:
        return self.real.shape[1]


@dataclass(frozen=True)
class Rows:
    """What a batch gave"""

    first: int
    values: np.ndarray  # (outputs, runs), not a number where a run failed
    status: np.ndarray  # uint8, fmi2Status
    messages: dict[int, str]  # of runs that failed, by their place in the batch
    seconds: float  # that it took, see Clock
    warnings: np.ndarray  # int32: how many messages of status warning a run logged


class Clock:
    """How long a batch takes: the time of the processor, which a busy machine does not stretch, but an eighth
    of the wall's time at least, since an FMU may wait for something"""

    def __init__(self) -> None:
        self._wall, self._processor = time.perf_counter(), time.thread_time()

    def seconds(self) -> float:
        return max(time.thread_time() - self._processor, (time.perf_counter() - self._wall) / 8)
