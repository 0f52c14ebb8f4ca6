"""What a worker does: the FMU is unpacked once in a process, then batch after batch is run"""

import atexit
import contextlib
import hashlib
import io
import shutil
import signal
import tempfile
import threading
import zipfile
from dataclasses import dataclass
from pathlib import Path

from .native import Batch, Plan, Rows, library_file, run

_unpacking = threading.Lock()
_unpacked: dict[str, Path] = {}


def dask_setup(_worker) -> None:
    """Workers of an embedded cluster call it when they start (dask's preload): Ctrl-C goes to all processes of a
    terminal, but the sweep itself ends its workers, and they wait for that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@dataclass(frozen=True)
class Work:
    """Travels to the workers once"""

    fmu: bytes
    plan: Plan
    single: bool  # canBeInstantiatedOnlyOncePerProcess
    compiled: bool = True  # use the compiled loop where there is one


def work(made: Work) -> Work:
    """A task that gives its argument: a worker that needs it and has lost it gets it again"""
    return made


_one_instance = threading.Lock()


def run_batch(given: Work, batch: Batch) -> Rows:
    folder, plan = unpacked(given.fmu), given.plan
    loop = library_file() if given.compiled and not plan.fmi3 else None
    with _one_instance if given.single else contextlib.nullcontext():
        if loop is None:
            from . import python_loop  # brings fmpy

            return python_loop.run(plan, batch, folder)
        library = folder / "binaries" / "linux64" / f"{plan.identifier}.so"
        return run(plan, batch, library, (folder / "resources").as_uri(), loop)


def unpacked(fmu: bytes) -> Path:
    digest = hashlib.sha256(fmu).hexdigest()
    with _unpacking:
        if digest not in _unpacked:
            folder = Path(tempfile.mkdtemp(prefix="contact-sweep-", dir=_scratch()))
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
            with zipfile.ZipFile(io.BytesIO(fmu)) as archive:
                names = [name for name in archive.namelist() if not name.startswith(("sources/", "documentation/"))]
                archive.extractall(folder, names)
            _unpacked[digest] = folder
        return _unpacked[digest]


def _scratch() -> str | None:
    """The worker's own folder, which dask removes, even of a worker that was killed"""
    from distributed import get_worker

    try:
        return str(get_worker().local_directory)
    except ValueError:  # not called by a worker
        return None
