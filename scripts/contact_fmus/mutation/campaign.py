"""Tries one change after the other: compile, compare, test; what passes quick tests meets all of them last"""

from __future__ import annotations

import collections
import csv
import hashlib
import random
import shutil
import threading
import time
from collections.abc import Iterable
from pathlib import Path

from .choice import Mutant
from .program import Program
from .tests import Caught, PythonTests, UnitTests

COLUMNS = ["source", "file", "line", "kind", "old", "new", "outcome", "by", "test", "how", "seconds"]
QUICK = 4.0  # s of the processor for all quick tests together
CAUGHT, EQUIVALENT, MISSED, INVALID = "caught", "equivalent", "not caught", "does not compile"
PENDING = "passed the quick tests"


def say(*words: object) -> None:
    print(*words, flush=True)


class Campaign:
    def __init__(self, program: Program, root: Path, results: Path, jobs: int, patience: float):
        self.program, self.root, self.results, self.jobs = program, root, results, jobs
        self.patience = patience  # s for the tests that a change meets last
        self.lock = threading.Lock()
        self.kills: collections.Counter = collections.Counter()
        files = sorted(program.source.rglob("*.[ch]"))
        self.source = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:12]
        self.rows = self._read()

    def _read(self) -> dict[tuple, dict]:
        """What an earlier run of the same code found"""
        if not self.results.is_file():
            return {}
        with self.results.open(encoding="utf-8", newline="") as stream:
            rows = [row for row in csv.DictReader(stream) if row["source"] == self.source]
        return {(row["file"], row["line"], row["old"], row["new"]): row for row in rows}

    def write(self) -> None:
        self.results.parent.mkdir(parents=True, exist_ok=True)
        with self.results.open("w", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.rows.values())

    def prepare(self, paths: list[str]) -> None:
        program = self.program
        for scene in program.main_scenes:
            say(f"building {scene} file by file")
            program.make_scene(scene, self.jobs)
        self.units = UnitTests(program)
        for test in self.units.measure():
            say(f"left out, fails without a change: unit.{test}")
        say(f"{len(self.units.seconds)} C unit tests, {sum(self.units.seconds.values()):.1f} s")
        for scene in program.scenes:
            if scene not in program.main_scenes:
                program.pack(scene, program.build / "libraries" / f"{scene}.so", program.base / "fmus")
        folder = program.folder
        self.python = [
            PythonTests(self.root, paths, folder / f"pytest{job}.log", folder / "references")
            for job in range(self.jobs)
        ]
        for tests in self.python:
            left_out = tests.measure(program.base / "fmus", folder / "times.json")
        (folder / "left_out.txt").write_text("\n".join([*left_out, ""]))
        say(f"{len(left_out)} Python tests fail or last too long without a change: left_out.txt")
        seconds = self.python[0].seconds
        self.quick, self.long = self._within(QUICK), self._within(self.patience)
        say(f"{len(seconds)} Python tests, {sum(seconds.values()):.0f} s")
        say(f"{len(self.quick)} of them at first, {len(self.long)} for what these let pass")

    def _within(self, budget: float) -> set[int]:
        """Tests that take so many seconds together: of each function some, the more the less each costs"""
        python = self.python[0]
        by_function: dict[str, list[int]] = {}
        for index in python.seconds:
            by_function.setdefault(python.names[index].partition("[")[0], []).append(index)
        self.price = {}
        for name, indices in by_function.items():
            random.Random(name).shuffle(indices)
            for rank, index in enumerate(indices, start=1):
                self.price[index] = rank * max(python.seconds[index], 0.003)
        found, spent = set(), 0.0
        for index in sorted(self.price, key=self.price.get):
            spent += python.seconds[index]
            if spent > budget:
                break
            found.add(index)
        return found

    def order(self, file: str, tests: Iterable[int]) -> list[int]:
        """Those that caught most first, most of all in the same file; then the cheapest"""
        seconds = self.python[0].seconds

        def key(index: int) -> tuple[float, float]:
            merit = (self.kills[index] + 10 * self.kills[file, index]) / (seconds[index] + 0.005)
            return (-merit, self.price[index])

        return sorted(tests, key=key)

    def run(self, mutants: list[Mutant], count: int, until: float) -> None:
        """`count` changes that compile; then the long list for those that are left"""
        self._in_parallel(self._quickly, mutants, count, until)
        for attempt in (self._by_all_c_tests, self._at_length):
            left = [one for one in mutants if self.rows.get(one.key, {}).get("outcome") == PENDING]
            say(f"{len(left)} left")
            self._in_parallel(attempt, left, len(left), until)

    def _in_parallel(self, attempt, mutants: list[Mutant], count: int, until: float) -> None:
        queue = iter(mutants)
        done = [0]

        def work(job: int) -> None:
            while True:
                with self.lock:
                    mutant = next(queue, None)
                    if mutant is None or done[0] >= count or time.time() > until:
                        return
                    known = self.rows.get(mutant.key)
                    if known and attempt == self._quickly:
                        done[0] += known["outcome"] != INVALID
                        continue
                begin = time.perf_counter()
                outcome, caught = attempt(job, mutant)
                with self.lock:
                    self._note(mutant, outcome, caught, time.perf_counter() - begin)
                    done[0] += outcome != INVALID

        threads = [threading.Thread(target=work, args=(job,)) for job in range(self.jobs)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def _note(self, mutant: Mutant, outcome: str, caught: Caught | None, seconds: float) -> None:
        by, test, how = caught or ("", "", "")
        row = {
            "source": self.source,
            "file": mutant.file,
            "line": str(mutant.line),
            "kind": mutant.change.kind,
        }
        row |= {"old": mutant.old, "new": mutant.new, "outcome": outcome, "by": by, "test": test, "how": how}
        self.rows[mutant.key] = row | {"seconds": f"{seconds:.1f}"}
        if by == "Python test":
            index = self.python[0].names.index(test)
            self.kills[index] += 1
            self.kills[mutant.file, index] += 1
        self.write()
        found = f"{outcome} {test} {how}".strip()
        say(f"{len(self.rows):4} {mutant.file}:{mutant.line} {mutant.change.kind}: {found}, {seconds:.1f} s")

    def _scenes_for(self, file: str) -> list[str]:
        """The main scenes that the file is part of, or else another one"""
        program = self.program
        if found := [scene for scene in program.main_scenes if program.readers(scene, file)]:
            return found
        other = [scene for scene in program.scenes if file in program.units(scene)][:1]
        self._make(other)
        return other

    def _make(self, scenes: list[str]) -> None:
        for scene in scenes:
            with self.lock:
                if not (self.program.base / "libraries" / f"{scene}.so").is_file():
                    self.program.make_scene(scene)

    def _quickly(self, job: int, mutant: Mutant) -> tuple[str, Caught | None]:
        scenes = self._scenes_for(mutant.file)
        if not scenes:
            return INVALID, None
        outcome, folder = self._build(job, mutant, scenes)
        if outcome:
            return outcome, None
        near = self.units.near(mutant.file)
        caught = self.units.first_that_fails(mutant.file, folder, near)
        if not caught:
            caught = self.python[job].first_that_fails(folder / "fmus", self.order(mutant.file, self.quick))
        return (CAUGHT if caught else PENDING), caught

    def _by_all_c_tests(self, job: int, mutant: Mutant) -> tuple[str, Caught | None]:
        # What an optimizing compiler makes the same is the same, whatever the quick compilation says.
        scenes = self._scenes_for(mutant.file)
        outcome, _ = self._build(job, mutant, scenes, "-O2")
        if outcome:
            return outcome, None
        _, folder = self._build(job, mutant, scenes)
        caught = self.units.first_that_fails(mutant.file, folder, self.units.seconds)
        return (CAUGHT if caught else PENDING), caught

    def _at_length(self, job: int, mutant: Mutant) -> tuple[str, Caught | None]:
        self._make(self.program.scenes)
        _, folder = self._build(job, mutant, self.program.scenes)
        caught = self.python[job].first_that_fails(folder / "fmus", self.order(mutant.file, self.long))
        return (CAUGHT if caught else MISSED), caught

    def _build(
        self, job: int, mutant: Mutant, scenes: list[str], optimization: str = "-O1"
    ) -> tuple[str, Path]:
        """An outcome when that is known already, and the folder with the changed libraries and FMUs"""
        program, slot = self.program, f"slot{job}"
        folder = program.folder / slot
        file = program.copy(slot) / mutant.file
        original = (program.source / mutant.file).read_text(encoding="utf-8")
        changed = {}
        file.write_text(mutant.apply(original), encoding="utf-8")
        try:
            for scene in scenes:
                units = program.readers(scene, mutant.file)
                if program.compile(scene, units, slot, folder, optimization):
                    return INVALID, folder
                changed[scene] = units
            shutil.rmtree(folder / "unit", ignore_errors=True)
            if mutant.file.endswith(".h") and scenes != program.scenes:
                for test in program.tests_that_read(mutant.file):
                    program.make_test(test, slot, folder)
        finally:
            file.write_text(original, encoding="utf-8")
        same = True
        for scene, units in changed.items():
            with self.lock:
                made = [program.object_of(scene, unit, program.base, optimization) for unit in units]
                missing = [unit for unit, out in zip(units, made, strict=True) if not out.is_file()]
                program.compile(scene, missing, "base", program.base, optimization)
            same = same and all(
                program.object_of(scene, unit, folder, optimization).read_bytes()
                == program.object_of(scene, unit, program.base, optimization).read_bytes()
                for unit in units
            )
        if same:
            return EQUIVALENT, folder
        if optimization == "-O1":
            for scene in program.scenes:
                self._link(scene, changed.get(scene, []), folder)
        return "", folder

    def _link(self, scene: str, units: list[str], folder: Path) -> None:
        """The library and FMU of a scene, with those units from the folder and the others from the base"""
        program = self.program
        fmu = folder / "fmus" / f"{scene}.fmu"
        fmu.parent.mkdir(parents=True, exist_ok=True)
        library = folder / "libraries" / f"{scene}.so"
        fmu.unlink(missing_ok=True)
        library.unlink(missing_ok=True)
        if not units:
            fmu.hardlink_to(program.base / "fmus" / f"{scene}.fmu")
            return
        objects = [
            program.object_of(scene, unit, folder if unit in units else program.base)
            for unit in program.units(scene)
        ]
        program.link(scene, objects, library)
        program.pack(scene, library, folder / "fmus")
