"""A batch of runs by the compiled loop, scripts/tools/batch, and what travels to it

A study as a loop over runs needs it: value references and numbers, no names.
"""

import ctypes
import os
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from contact_fmus.errors import RunFailure

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
    """Varied start values of a stretch of runs: for each type (Real, Integer, Boolean) an array of (variables, runs)"""

    first: int
    columns: tuple[np.ndarray, ...]

    @property
    def runs(self) -> int:
        return self.columns[0].shape[1]


@dataclass(frozen=True)
class Rows:
    """The results of a batch"""

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


# contact_fmus.fmu.files knows the folder too, and brings fmpy, which a worker can do without.
PACKAGE = Path(__file__).resolve().parents[1]
MESSAGE_SIZE = 160  # BATCH_MESSAGE_SIZE
FILE = "contact_batch.so"
OK = 0


# The structures of scripts/tools/batch/batch.h
INT, ADDRESS = ctypes.c_int64, ctypes.c_void_p


class _Set(ctypes.Structure):
    _fields_ = (("count", INT), ("varied", INT), ("references", ADDRESS), ("columns", ADDRESS), ("constants", ADDRESS))


class _Read(ctypes.Structure):
    _fields_ = (("count", INT), ("references", ADDRESS))


class _Batch(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_char_p) for name in ("library", "name", "guid", "resources")),
        *((name, ctypes.c_double) for name in ("start_time", "tolerance")),
        *((name, INT) for name in ("tolerance_defined", "point_count")),
        *((name, ADDRESS) for name in ("points", "reads")),
        *((name, _Set) for name in ("real", "integer", "boolean")),
        *(("string_count", INT), ("string_references", ADDRESS), ("strings", ADDRESS)),
        *((name, _Read) for name in ("read_real", "read_integer", "read_boolean")),
        *(("output_count", INT), ("outputs", ADDRESS), ("runs", INT)),
        *((name, ADDRESS) for name in ("values", "status", "messages", "warnings")),
    )


def library_file() -> Path | None:
    """The compiled loop, where CONTACT_BUILD says, in an installed package (ContactPackage.cmake) or a clone's build"""
    folders = [PACKAGE / "share" / "build", PACKAGE.parents[1] / "build"]
    if os.environ.get("CONTACT_BUILD"):
        folders.insert(0, Path(os.environ["CONTACT_BUILD"]))
    return next((folder / FILE for folder in folders if (folder / FILE).is_file()), None)


@cache
def _function(file: Path) -> ctypes._CFuncPtr:
    function = ctypes.CDLL(str(file)).contact_batch_run
    function.argtypes = (ctypes.POINTER(_Batch),)
    function.restype = ctypes.c_int
    return function


def run(plan: Plan, batch: Batch, library: Path, resources: str, loop: Path) -> Rows:
    """`library` and `resources` are the FMU's. Other threads may go on meanwhile."""
    clock = Clock()
    values = np.empty((len(plan.outputs), batch.runs))
    status, warnings = np.zeros(batch.runs, np.uint8), np.zeros(batch.runs, np.int32)
    messages = np.zeros(batch.runs, f"S{MESSAGE_SIZE}")  # memory that nothing is written to costs nothing
    sets = [
        _Set(len(one.references), one.varied, _at(one.references), _at(column), _at(one.constants))
        for one, column in zip(plan.settings, batch.columns, strict=True)
    ]
    reads = [_Read(len(references), _at(references)) for references in plan.read]
    string_references = np.array([reference for reference, _ in plan.strings], np.uint32)
    strings = (ctypes.c_char_p * len(plan.strings))(*(value.encode() for _, value in plan.strings))
    described = _Batch(
        os.fsencode(library),
        *(text.encode() for text in (plan.identifier, plan.guid, resources)),
        plan.start_time,
        plan.tolerance or 0.0,
        plan.tolerance is not None,
        len(plan.points),
        *map(_at, (plan.points, plan.reads)),
        *sets,
        len(plan.strings),
        _at(string_references),
        ctypes.cast(strings, ctypes.c_void_p),
        *reads,
        len(plan.outputs),
        _at(plan.outputs),
        batch.runs,
        *map(_at, (values, status, messages, warnings)),
    )
    if _function(loop)(ctypes.byref(described)) != 0:
        raise RunFailure(f"the FMU's library cannot be used: {_text(messages[0])}")
    said = {int(place): _text(messages[place]) for place in np.flatnonzero(status != OK)}
    return Rows(batch.first, values, status, said, clock.seconds(), warnings)


def _at(array: np.ndarray) -> int:
    return array.ctypes.data


def _text(message: bytes) -> str:
    return message.decode("utf-8", "replace").replace("\N{REPLACEMENT CHARACTER}", "").replace("%%", "%")
