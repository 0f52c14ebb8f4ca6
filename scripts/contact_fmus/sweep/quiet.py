"""Loaded by the workers of an embedded cluster when they start (dask's preload)"""

from __future__ import annotations

import signal


def dask_setup(_worker) -> None:
    """Ctrl-C goes to all processes of a terminal. The sweep itself ends its workers; they wait for that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
