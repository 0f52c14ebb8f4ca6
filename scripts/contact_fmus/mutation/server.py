"""A pytest plugin that collects the tests once and runs them anew, in a child of its own, for each request.

A request is a line of JSON on the file descriptor CONTACT_MUTATION_IN: {"fmus": folder, "tests": indices or
null, "seconds": time a test may take, "first": stop at the first failure}. The answers, lines of JSON too,
go to CONTACT_MUTATION_OUT: first the tests' names, then for each request {"begin": index}, {"end": index,
"outcome": "passed" or "failed", "seconds": processor time} and at last {"status": how the child ended}.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys

import pytest

_WALL = 30  # a test that waits without working is ended after so many times its time
_out = os.fdopen(int(os.environ["CONTACT_MUTATION_OUT"]), "w", buffering=1)


def _say(**what: object) -> None:
    _out.write(json.dumps(what) + "\n")
    _out.flush()


def _processor_time(whose: int = resource.RUSAGE_SELF) -> float:
    spent = resource.getrusage(whose)
    return spent.ru_utime + spent.ru_stime


def _cost() -> float:
    return _processor_time() + _processor_time(resource.RUSAGE_CHILDREN)


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool:
    _say(tests=[item.nodeid for item in session.items])
    with os.fdopen(int(os.environ["CONTACT_MUTATION_IN"])) as requests:
        for line in requests:
            child = os.fork()
            if child == 0:
                _serve(session, json.loads(line))
            _, status = os.waitpid(child, 0)
            _say(status=status)
    return True


def _serve(session: pytest.Session, request: dict) -> None:
    """The child: never returns"""
    os.environ["CONTACT_FMUS"] = request["fmus"]
    _forget()
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    wanted = request["tests"] if request["tests"] is not None else range(len(session.items))
    watcher = _Watcher({session.items[index].nodeid: index for index in wanted}, request["seconds"])
    session.config.pluginmanager.register(watcher)
    chosen = [session.items[index] for index in wanted]
    try:
        for item, after in zip(chosen, [*chosen[1:], None], strict=True):
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            if watcher.failed and request["first"]:
                break
    finally:
        os._exit(0)


def _forget() -> None:
    """What collecting the tests left in caches belongs to other FMUs"""
    for name, module in list(sys.modules.items()):
        if name.startswith(("support", "tests", "contact_fmus")):
            for one in vars(module).values():
                if callable(clear := getattr(one, "cache_clear", None)):
                    clear()


class _Watcher:
    """Says what runs, and limits the processor's time for each test"""

    def __init__(self, indices: dict[str, int], seconds: float):
        self.indices, self.seconds, self.failed, self.bad = indices, seconds, False, False

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        _say(begin=self.indices[nodeid])
        self.bad, self.before = False, _cost()
        resource.setrlimit(
            resource.RLIMIT_CPU,
            (int(_processor_time() + self.seconds) + 1, resource.getrlimit(resource.RLIMIT_CPU)[1]),
        )
        signal.alarm(int(_WALL * self.seconds))  # ends the process, as SIGXCPU does

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.bad |= report.failed

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        self.failed |= self.bad
        seconds = round(_cost() - self.before, 4)
        _say(end=self.indices[nodeid], outcome="failed" if self.bad else "passed", seconds=seconds)
