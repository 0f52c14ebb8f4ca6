"""Batches that a scheduler forgets are sent again: every run is written once"""

import pyarrow.parquet as pq
import pytest
from distributed import Future
from distributed.client import FutureCancelledError

from contact_fmus.sweep.drive import Drive, connected, make_work
from contact_fmus.sweep.store import Store
from support.sweeps import read, write_study

COUNT = 300


@pytest.fixture
def drive(tmp_path):
    study = read(write_study(tmp_path, count=COUNT))
    store = Store(tmp_path / "out", study)
    store.open(resume=False)
    with connected(None, workers=1) as client:
        yield Drive(client, study, study.samples(), store, make_work(study))
    store.close()


def check_all_runs(drive):
    drive.store.merge()
    assert pq.read_table(drive.store.results)["run"].to_pylist() == list(range(COUNT))


def test_batches_cancelled_behind_its_back_are_sent_again(drive):
    cancelled = []

    def look():
        if drive.flights and len(cancelled) < 3:
            drive.client.cancel(list(drive.flights), force=True)
            cancelled.append(True)

    drive.run(lambda runs: None, look)
    assert len(cancelled) == 3
    check_all_runs(drive)


def test_a_connection_that_breaks_while_rows_are_fetched(drive, monkeypatch):
    """A future is done when its status is read, and cancelled when its rows are asked for"""
    broken, fetch = [], Future.result

    def result(self, timeout=None):
        if len(broken) < 3:
            broken.append(self.key)
            raise FutureCancelledError(self.key, "scheduler-connection-lost")
        return fetch(self, timeout)

    monkeypatch.setattr(Future, "result", result)
    drive.run(lambda runs: None, lambda: None)
    assert len(broken) == 3
    check_all_runs(drive)
