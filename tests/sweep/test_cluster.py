"""Sweeps as commands on a scheduler of their own: workers killed, clients interrupted, no room on the disk"""

import json
import os
import resource
import signal
import socket
import subprocess

import duckdb
import numpy as np
import pandas
import polars
import pyarrow.parquet as pq
import pytest

from contact_fmus.sweep.drive import Interrupts
from support.programs import PATIENCE, environment
from support.sweeps import Cluster, command, read, run_here, study_text, sweep, wait_for, write_study

COUNT = 8_000
# Short steps, so that all runs take some seconds and there is a middle to interrupt.
EXPERIMENT = "stop_time = 2.0\nsteps = 100"


@pytest.fixture
def cluster(tmp_path):
    (tmp_path / "dask").mkdir()
    made = Cluster(tmp_path / "dask")
    yield made
    made.close()


@pytest.fixture
def study(tmp_path):
    return write_study(tmp_path, count=COUNT, experiment=EXPERIMENT)


def begin(file, *options):
    """In a group of processes of its own, as a terminal starts it"""
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command(file, *options), **pipe, env=environment(), start_new_session=True)


def done(folder):
    """Runs of the batches on disk"""
    stretches = [file.stem.split("-") for file in (folder / "batches").glob("*.parquet")]
    return sum(int(end) - int(first) for first, end in stretches)


def check_all_rows(results, study):
    """Every run once, in order, with the bits of a loop in this process"""
    rows = pq.read_table(results)
    assert rows["run"].to_pylist() == list(range(COUNT))
    values, expected = run_here(study)
    for name, column in values.items():
        if name != "contact.dashpot":
            assert np.array_equal(rows[name].to_numpy(), column[:, 0]), name
    for place, output in enumerate(study.outputs):
        if output.name != "dashpot":
            assert np.array_equal(rows[output.name].to_numpy().astype(float), expected.values[place])
    assert rows["dashpot"].to_pylist() == rows["contact.dashpot"].to_pylist()


def test_a_killed_worker_and_an_interrupted_client_lose_nothing(tmp_path, cluster, study):
    folder = tmp_path / "out"
    cluster.add_worker()
    cluster.add_worker()
    client = begin(study, "-o", folder, "--scheduler", cluster.address)
    wait_for(lambda: done(folder) > 0)
    cluster.workers[0].kill()
    before = done(folder)
    wait_for(lambda: done(folder) > before or client.poll() is not None)
    client.send_signal(signal.SIGINT)
    _, said = client.communicate(timeout=PATIENCE)
    assert client.returncode == 130, said
    assert "--resume goes on" in said
    assert "Traceback" not in said
    kept = {file.name: file.stat().st_mtime_ns for file in (folder / "batches").glob("*.parquet")}
    assert 0 < done(folder) < COUNT
    again = begin(study, "-o", folder, "--scheduler", cluster.address, "--resume")
    rows = sum(int(name[14:27]) - int(name[:13]) for name in kept)
    wait_for(lambda: done(folder) > rows or again.poll() == 0)
    if (folder / "batches").exists():
        now = {file.name: file.stat().st_mtime_ns for file in (folder / "batches").glob("*.parquet")}
        assert not now or {name: now.get(name) for name in kept} == kept  # none is run again
    _, said = again.communicate(timeout=PATIENCE)
    assert (again.returncode, said) == (0, "")
    check_all_rows(folder / "results.parquet", read(study))


def test_a_full_disk_keeps_what_is_there(tmp_path, cluster, study):
    folder = tmp_path / "out"
    cluster.add_worker()
    client = begin(study, "-o", folder, "--scheduler", cluster.address)
    wait_for(lambda: done(folder) > 0)
    # No file of this process may grow beyond a kilobyte any more.
    resource.prlimit(client.pid, resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
    _, said = client.communicate(timeout=PATIENCE)
    assert client.returncode == 3, said
    assert said.count("\n") == 1
    assert "File too large" in said
    assert "--resume goes on" in said
    assert not list(folder.rglob("*.part"))
    assert 0 < len(pq.ParquetDataset(folder / "batches").read()) == done(folder) < COUNT
    sweep(study, "-o", folder, "--scheduler", cluster.address, "--resume")
    check_all_rows(folder / "results.parquet", read(study))


def test_a_scheduler_that_ends_is_said_in_one_sentence(tmp_path, cluster, study):
    cluster.add_worker()
    client = begin(study, "-o", tmp_path / "out", "--scheduler", cluster.address)
    wait_for(lambda: done(tmp_path / "out") > 0)
    cluster.processes[0].kill()
    _, said = client.communicate(timeout=PATIENCE)
    assert (client.returncode, said.count("\n")) == (3, 1), said
    assert f"{done(tmp_path / 'out'):,} of {COUNT:,} runs are kept" in said


def test_an_embedded_cluster_gives_the_same_rows_and_files_that_others_read(tmp_path):
    study = write_study(tmp_path, study_text(count=60))
    folder = tmp_path / "out"
    said = sweep(study, "-o", folder, "--workers", "1", "--csv", "--plot", "--x", "source.mass")
    assert said.stdout.startswith("60 runs (60 ok)")
    file = folder / "results.parquet"
    rows = pq.read_table(file)
    _, expected = run_here(read(study))
    assert np.array_equal(rows["height"].to_numpy(), expected.values[0])
    assert (folder / "plot.png").read_bytes().startswith(b"\x89PNG")
    height = rows["height"].to_numpy()
    assert np.array_equal(pandas.read_parquet(file)["height"], height)
    assert np.array_equal(polars.read_parquet(file)["height"].to_numpy(), height)
    counted = duckdb.sql(f"select count(*), min(height) from '{file}' where status = 'ok'").fetchall()[0]
    assert counted == (60, height.min())
    # all digits are in the CSV file, and the notes beside it say the units
    assert np.array_equal(pandas.read_csv(folder / "results.csv")["height"], height)
    assert json.loads((folder / "results.csv.json").read_text())["units"]["height"] == "m"
    units = {field.name: (field.metadata or {}).get(b"unit") for field in rows.schema}
    assert (units["height"], units["source.mass"], units["peak_force"]) == (b"m", b"kg", b"N")
    assert rows.schema.metadata[b"contact_fmus.study_digest"].decode() == read(study).digest()
    # done is done; another study has no business in this folder
    assert "0 of them now" in sweep(study, "-o", folder, "--resume").stdout
    assert "--resume" in sweep(study, "-o", folder, status=2).stderr
    study.write_text(study.read_text().replace("seed = 3", "seed = 4"))
    assert "another study" in sweep(study, "-o", folder, "--resume", status=2).stderr


def test_ctrl_c_ends_an_embedded_cluster_in_one_sentence(tmp_path, study):
    folder = tmp_path / "out"
    client = begin(study, "-o", folder, "--workers", "1")
    wait_for(lambda: done(folder) > 0)
    os.killpg(client.pid, signal.SIGINT)
    _, said = client.communicate(timeout=PATIENCE)
    assert client.returncode == 130
    assert said.count("\n") == 1, said
    assert f"{done(folder):,} of {COUNT:,} runs are kept" in said


def test_ctrl_c_that_meets_a_finalizer_is_not_lost():
    class Interrupted:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)

    interrupts, before = Interrupts(), signal.getsignal(signal.SIGINT)
    with interrupts.answered():
        with pytest.raises(KeyboardInterrupt), interrupts.looked_for():
            Interrupted()
        with pytest.raises(KeyboardInterrupt):
            interrupts.look()
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)  # the second ends at once
    assert signal.getsignal(signal.SIGINT) is before


def test_an_unreachable_scheduler_is_said_in_one_sentence(tmp_path):
    study = write_study(tmp_path, count=10)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    said = sweep(study, "-o", tmp_path / "out", "--scheduler", f"tcp://127.0.0.1:{port}", status=3).stderr
    assert said.count("\n") == 1
    assert str(port) in said
    said = sweep(study, "-o", tmp_path / "out", "--resume", "--scheduler", "nonsense://x", status=2).stderr
    assert said.count("\n") == 1
