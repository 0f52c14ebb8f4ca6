"""The workers: an embedded cluster of dask.distributed, or one that is already there"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator

import dask
from distributed import Client, LocalCluster
from distributed.comm import parse_address

from contact_fmus.errors import RunFailure, UserError

from .processes import METHOD, end, keep_dask_from_importing

CONNECT = 5.0  # s that a scheduler has to answer
ARRIVE = 60.0  # s that its first worker has to appear
SETTINGS = {
    # A task that was on two workers when they died is taken as what killed them, and its batch is halved.
    "distributed.scheduler.allowed-failures": 1,
    "distributed.comm.timeouts.connect": CONNECT,
    # Batches hold the processor without Python's lock, so that a silent worker is a dead one.
    "distributed.admin.tick.limit": "60s",
    "distributed.worker.memory.terminate": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.multiprocessing-method": METHOD,
    # What an embedded cluster can do without: it would take a tenth of the processors.
    "distributed.worker.profile.enabled": False,
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.scheduler.work-stealing": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.system-monitor.gil.enabled": False,
}


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
    keep_dask_from_importing()
    cluster = LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        # dask serves its state in any case; a port of the loopback that is free
        dashboard_address=dashboard or "127.0.0.1:0",
        worker_dashboard_address="127.0.0.1:0",
        memory_limit=None,
        preload="contact_fmus.sweep.quiet",
        silence_logs=logging.CRITICAL,
    )
    try:
        with cluster, Client(cluster) as client:
            yield client
    finally:
        end()


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
        raise UserError(
            f"--scheduler {address}: an address like tcp://host:8786 is wanted ({reason})"
        ) from None
    try:
        with contextlib.suppress(TimeoutError):
            client.wait_for_workers(1, timeout=ARRIVE)
        if not client.ncores():
            raise RunFailure(f"--scheduler {address}: no worker there within {ARRIVE:g} s")
        yield client
    finally:
        with contextlib.suppress(Exception):  # the scheduler may be gone
            client.close(timeout=2)
