"""The tests in order of speed: C programs one by one, Python tests in a process that stays"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from .program import Program

LEAST = 4.0  # s of the processor that any test may take
FACTOR = 20.0  # times what it takes without a change
NO_TIME = 0.1  # s
LONGEST = 20.0  # s that a test may take without a change
AT_ONCE = 500  # tests between two times that their seconds are written down


class Caught(NamedTuple):
    kind: str  # "C unit test" | "Python test"
    test: str
    how: str  # "failed" | "crashed" | "time"


def limit(seconds: float) -> float:
    return max(LEAST, FACTOR * seconds)


def _cause(status: int) -> str:
    """Of a return value as subprocess gives it"""
    if status in (-24, -9, -14):  # SIGXCPU, SIGKILL after it, SIGALRM
        return "time"
    return "crashed" if status < 0 else "failed"


class UnitTests:
    """The C programs, linked to the libraries in a folder"""

    def __init__(self, program: Program):
        self.program = program
        self.seconds: dict[str, float] = {}

    def measure(self) -> list[str]:
        """Makes and times them; those that fail without a change are left out and returned"""
        for test in self.program.unit_tests:
            if wrong := self.program.make_test(test, "base", self.program.base):
                raise RuntimeError(wrong)
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            if self.run(self.program.base, test, self.program.base / "libraries", 120.0) == 0:
                self.seconds[test] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        return sorted(set(self.program.unit_tests) - set(self.seconds))

    def run(self, folder: Path, test: str, libraries: Path, seconds: float) -> int:
        def limited() -> None:
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 1))
            resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))

        try:
            done = subprocess.run(
                [str(folder / "unit" / test)],
                env={**os.environ, "LD_LIBRARY_PATH": str(libraries)},
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=30 * seconds,
                preexec_fn=limited,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return -9
        return done.returncode

    def near(self, file: str) -> list[str]:
        """Those that call the file themselves and those that take no time; the others need more patience"""
        return [
            test for test, spent in self.seconds.items() if spent < NO_TIME or self.program.needs(test, file)
        ]

    def first_that_fails(self, file: str, folder: Path, tests: Iterable[str]) -> Caught | None:
        """With the libraries of the folder, and its programs where it has some"""
        libraries = folder / "libraries"
        made = {path.stem for path in libraries.glob("*.so")}
        for test in sorted(tests, key=lambda test: (not self.program.needs(test, file), self.seconds[test])):
            if self.program.scene_of_test(test) in made:
                own = (folder / "unit" / test).is_file()
                status = self.run(
                    folder if own else self.program.base, test, libraries, limit(self.seconds[test])
                )
                if status != 0:
                    return Caught("C unit test", test, _cause(status))
        return None


class PythonTests:
    """A pytest that has collected its tests and waits for FMUs; some hundred take a second"""

    def __init__(self, root: Path, paths: list[str], log: Path, references: Path):
        here, there = os.pipe(), os.pipe()
        environment = {
            **os.environ,
            "CONTACT_MUTATION_IN": str(here[0]),
            "CONTACT_MUTATION_OUT": str(there[1]),
            "CONTACT_REFERENCES": str(references),
        }
        options = [
            "-q",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
            "-p",
            "contact_fmus.mutation.server",
            "--capture=sys",
        ]
        with log.open("w") as output:
            self.process = subprocess.Popen(
                [sys.executable, "-B", "-m", "pytest", *options, *paths],
                cwd=root,
                env=environment,
                pass_fds=(here[0], there[1]),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
            )
        os.close(here[0])
        os.close(there[1])
        self.requests = os.fdopen(here[1], "w", buffering=1)
        self.answers = os.fdopen(there[0])
        told = self.answers.readline()
        if not told:
            raise RuntimeError(f"the Python tests cannot be collected: see {log}")
        self.names: list[str] = json.loads(told)["tests"]
        self.seconds: dict[int, float] = {}

    def run(self, fmus: Path, tests: list[int] | None, seconds: float, first: bool) -> tuple[list[dict], int]:
        """What was said of each test, and how the process ended"""
        request = {"fmus": str(fmus), "tests": tests, "seconds": seconds, "first": first}
        self.requests.write(json.dumps(request) + "\n")
        said = []
        while "status" not in (one := json.loads(self.answers.readline())):
            said.append(one)
        return said, os.waitstatus_to_exitcode(one["status"])

    def measure(self, fmus: Path, times: Path) -> list[str]:
        """Times all; those that fail or last too long without a change are left out and returned"""
        left = list(range(len(self.names)))
        seconds = json.loads(times.read_text()) if times.is_file() else {}
        left = [index for index in left if self.names[index] not in seconds]
        while left:
            said, _ = self.run(fmus, left[:AT_ONCE], LONGEST, first=False)
            for one in said:
                if "end" in one:
                    good = one["outcome"] == "passed"
                    seconds[self.names[one["end"]]] = one["seconds"] if good else None
            if said and "begin" in said[-1]:  # it ended the process
                seconds[self.names[said[-1]["begin"]]] = None
            left = [index for index in left if self.names[index] not in seconds]
            times.write_text(json.dumps(seconds, indent=0))
        told = {index: seconds[name] for index, name in enumerate(self.names)}
        self.seconds = {index: spent for index, spent in told.items() if spent is not None}
        return [self.names[index] for index, spent in told.items() if spent is None]

    def first_that_fails(self, fmus: Path, tests: list[int]) -> Caught | None:
        if not tests:
            return None
        slowest = max(self.seconds[index] for index in tests)
        said, status = self.run(fmus, tests, limit(slowest), first=True)
        for one in said:
            if one.get("outcome") == "failed":
                return Caught("Python test", self.names[one["end"]], "failed")
        if said and "begin" in said[-1]:
            return Caught("Python test", self.names[said[-1]["begin"]], _cause(status))
        return None

    def close(self) -> None:
        self.requests.close()
        self.process.wait()
