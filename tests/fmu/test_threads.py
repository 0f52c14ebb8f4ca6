"""Instances share nothing: in threads, each gives the bits of a run by itself."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from support.fmi2 import raw
from support.fmi2.raw import DISCARD
from support.fmi2.runs import RUNS, begin, digest, go_on, step

NAMES = list(RUNS)


@pytest.fixture(scope="module")
def alone() -> dict[str, str]:
    """The digest of each run by itself"""
    digests = {}
    for name, run in RUNS.items():
        with begin(run) as instance:
            digests[name] = digest(go_on(instance, run, 0))
    return digests


def test_threads_do_not_notice_each_other(alone):
    """Every run twice, in eight threads at once; ctypes lets go of Python's lock during each call."""
    jobs = NAMES * 2
    together = threading.Barrier(8)

    def work(position: int) -> list[tuple[str, str]]:
        together.wait()
        results = []
        for name in jobs[position::8]:
            with begin(RUNS[name], name=f"{name} {position}".encode()) as instance:
                results.append((name, digest(go_on(instance, RUNS[name], 0))))
        return results

    with ThreadPoolExecutor(8) as pool:
        results = [pair for pairs in pool.map(work, range(8)) for pair in pairs]
    assert len(results) == len(jobs)
    assert [(name, found) for name, found in results if found != alone[name]] == []


def test_an_instance_may_change_its_thread(alone):
    """Created in one thread, stepped by ever new ones, freed in the first, as with an importer's pool."""
    name = "two free bodies"
    run = RUNS[name]
    instance = begin(run)
    rows = []
    for index in range(run.steps):
        with ThreadPoolExecutor(1) as pool:
            rows.append(pool.submit(step, instance, run, index).result())
    instance.free()
    assert digest(rows) == alone[name]


def test_messages_go_to_the_logger_of_their_own_instance():
    instances = [
        raw.Instance(raw.load(scene), name=f"{scene} {index}".encode())
        for scene in raw.KINDS
        for index in range(10)
    ]

    def complain(instance: raw.Instance) -> None:
        for _ in range(50):
            assert instance.set_one(instance.fmu.variables["source.radius"], -1.0) == DISCARD

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(complain, instances))
    names = {(name, index) for index, instance in enumerate(instances) for name in instance.loggers}
    assert len(names) == len(instances)
    assert all(len(instance.messages) == 50 for instance in instances)
    for instance in instances:
        instance.free()
