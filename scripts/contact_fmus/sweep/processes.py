"""The process that the workers of an embedded cluster are copies of (multiprocessing's forkserver)

Python's own way would have every worker import all it needs, a second of the processor for each. Here one
process does, while the sweep imports what it needs itself.
"""

from __future__ import annotations

import contextlib
import multiprocessing
from multiprocessing import forkserver

METHOD = "forkserver"  # dask's distributed.worker.multiprocessing-method
NEEDED = ["distributed.nanny", "distributed.http.worker", "contact_fmus.sweep.worker"]


def start_early() -> None:
    """Comes back at once"""
    multiprocessing.get_context(METHOD).set_forkserver_preload(NEEDED)
    forkserver.ensure_running()


def end() -> None:
    """Waits for it and its copies, so that nothing of a sweep outlives it and the system counts their time
    as the sweep's. Python has no public call for that; without one they end by themselves a moment later."""
    with contextlib.suppress(AttributeError, OSError):
        forkserver._forkserver._stop()


def keep_dask_from_importing() -> None:
    """dask would name its own list of modules, too late, and import pandas for that where it is installed"""
    import distributed.utils

    distributed.utils._forkserver_preload_set = True
