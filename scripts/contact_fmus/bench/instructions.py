"""The command bench: how many instructions the FMUs execute in fmi2DoStep, counted by callgrind, and what this
project promises.

A count says the same on every processor, busy or idle, where seconds do not. Two things could still make it
differ, and are dealt with: the C library picks its functions by the processor (sin, cos and memcpy have
several versions), so it is told to use those that every x86-64 processor has; and another compiler gives
other code, so instruction_bounds.toml allows it more."""

import os
import re
import shutil
import subprocess
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact_fmus.errors import RunFailure
from contact_fmus.fmu.files import fmu_file, unpack
from contact_fmus.fmu.host import Case, case_arguments, host_file
from contact_fmus.options import parse
from contact_fmus.pages import Table, show

from .problems import (
    EVENT_DRIVEN,
    ISLANDS,
    PAIRS,
    STIFF_TOLERANCE,
    Setting,
    benchmarks,
    law_benchmarks,
    stiff_families,
    stored_problems,
    turning_problems,
)

BOUNDS = Path(__file__).with_name("instruction_bounds.toml")
STEPS = (1, 997)  # communication steps of the benchmark problems
FLIGHT_STEP, FLIGHT_STEPS = 1e-3, 1_000  # s
FAR_AWAY = {"source.center": [0.0, 0.0, 1e6], "solver.method": EVENT_DRIVEN}  # 451 s of fall
SOFT, STIFF = 1e7, 1e15  # N/m, of the damped problems of the stiffness sweep
# No version of a function that needs more than the x86-64 baseline; names of glibc 2.33 on, then older ones.
PLAIN = ("AVX", "AVX2", "FMA", "FMA4", "AVX512F", "AVX512VL", "ERMS", "FSRM")
EARLIER = ("AVX_Usable", "AVX2_Usable", "FMA_Usable")
TUNABLES = "glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in PLAIN + EARLIER)


class CountError(RunFailure):
    """valgrind is missing, or the FMU refused"""


@dataclass(frozen=True)
class Count:
    """Instructions of one case; `bound` where something is promised, `other` of another build"""

    what: str
    instructions: int
    bound: int | None = None
    other: int | None = None

    @property
    def good(self) -> bool | None:
        return None if self.bound is None else self.instructions <= self.bound


def flight_case(fmu: str) -> Case:
    name = f"{fmu}, {FLIGHT_STEPS} steps of {FLIGHT_STEP:g} s in flight"
    get = [["source.position"], ["source.velocity"]]
    return Case(name, fmu_file(fmu), FLIGHT_STEPS * FLIGHT_STEP, FLIGHT_STEPS, FAR_AWAY, get=get)


def cases() -> list[Case]:
    """Flight, the benchmark problems, some with friction, by Hertz's law, on a plane or a rim, Newton's
    cradle, new pairs, and both ends of the stiffness sweep, all by event_driven"""
    stiff = [one for name, family in stiff_families().items() if "undamped" not in name for one in family]
    many = [*benchmarks().values(), *turning_problems().values()]
    named = [(f"{one.name}, {n} step{'s' * (n > 1)}", one, n) for one in many for n in STEPS]
    cradles = {name: one for name, one in stored_problems(ISLANDS).items() if "cradle" in name}  # a bearing takes long
    once = law_benchmarks() | cradles | stored_problems(PAIRS)
    named += [(f"{one.name}, 1 step", one, 1) for one in once.values()]
    named += [
        (f"{one.name}, p_n = {one.penalty_factor:.0e} N/m", one, 1)
        for one in stiff
        if one.penalty_factor in (SOFT, STIFF)
    ]
    return [flight_case("SphereSphere"), flight_case("SphereCylinder")] + [
        replace(Setting(one, EVENT_DRIVEN, STIFF_TOLERANCE, steps).case(), name=name) for name, one, steps in named
    ]


def scene_cases() -> list[Case]:
    """Every shipped scene as it starts, in steps of 1 ms, with places, velocities and forces read after each"""
    found = []
    for fmu in sorted(fmu_file("SphereSphere").parent.glob("*.fmu")):
        description = unpack(fmu)[1]
        names = {one.name.partition("[")[0] for one in description.modelVariables if one.causality == "output"}
        get = [[name] for name in sorted(names) if name.endswith((".position", ".velocity", ".normal_force"))]
        found.append(Case(f"{fmu.stem}, steps of 1 ms, read", fmu, FLIGHT_STEP * FLIGHT_STEPS, FLIGHT_STEPS, get=get))
    return found


def instructions(case: Case, functions: Sequence[str] = ("fmi2DoStep",)) -> int:
    """The number of instructions in all calls of some functions in one run, with those of the C library"""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise CountError("valgrind is missing: scripts/setup.sh installs it")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "counts")
        toggles = [f"--toggle-collect={name}" for name in functions]
        options = ["--tool=callgrind", *toggles, f"--callgrind-out-file={out}"]
        run = subprocess.run(
            [valgrind, "--quiet", *options, str(host_file()), *case_arguments(case)],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "GLIBC_TUNABLES": TUNABLES},
        )
        if run.returncode != 0:
            raise CountError(f"{case.name}: {run.stderr.strip()}")
        total = re.search(r"^(?:summary|totals): (\d+)", out.read_text(encoding="utf-8"), re.MULTILINE)
    if total is None or int(total[1]) == 0:
        raise CountError(f"{case.name}: callgrind saw no fmi2DoStep")
    return int(total[1])


def compiler_of(fmu: Path) -> str:
    """gcc 12, say: what made the library in the FMU, from its section .comment"""
    folder, description = unpack(fmu)
    library = folder / "binaries" / "linux64" / f"{description.coSimulation.modelIdentifier}.so"
    text = library.read_bytes()
    for name, pattern in (("clang", rb"clang version (\d+)"), ("gcc", rb"GCC: \([^)]*\) (\d+)")):
        match = re.search(pattern, text)
        if match:
            return f"{name} {match[1].decode()}"
    return "another"


def read_bounds() -> dict[str, Any]:
    return tomllib.loads(BOUNDS.read_text(encoding="utf-8"))


def bound_of(case: Case, bounds: dict[str, Any]) -> int | None:
    """The count promised and the margin that the compiler gets"""
    promised = bounds["counts"].get(case.name)
    if promised is None:
        return None
    known = compiler_of(case.fmu) == bounds["compiler"]
    return int(promised * (1.0 + (bounds["margin"] if known else bounds["other_compiler_margin"])))


def measure(against: Path | None = None, scenes: bool = False) -> list[Count]:
    """Every case, beside the FMU of the same name in the folder `against`; with `scenes` the shipped scenes, where
    readings count too"""
    bounds, found = read_bounds(), []
    functions = ("fmi2DoStep", "fmi2GetReal") if scenes else ("fmi2DoStep",)
    for case in scene_cases() if scenes else cases():
        there = replace(case, fmu=against / case.fmu.name) if against is not None else None
        other = instructions(there, functions) if there is not None else None
        found.append(Count(case.name, instructions(case, functions), bound_of(case, bounds), other))
    return found


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: with --check, a count is above its bound; 2: something is not built; 3: a run failed"""
    options = parse("bench", arguments)
    counts = measure(options.against, options.scenes)
    words = {True: "[green]holds[/]", False: "[red]does not hold[/]", None: "[red]no bound[/]"}
    cells = []
    for one in counts:
        other = [f"{one.other:,}", f"{one.instructions / one.other:.4f}"] if one.other else []
        bound = f"{one.bound:,}" if one.bound is not None else "–"
        cells.append([one.what, f"{one.instructions:,}", *other, bound, words[one.good]])
    title = "Instructions in fmi2DoStep" + (" and fmi2GetReal" if options.scenes else "")
    title += f", beside the FMUs of {options.against}" if options.against else ""
    beside = ["there", "here / there"] if options.against else []
    show(Table(title, ["", "instructions", *beside, "bound", "verdict"], cells))
    return 1 if options.check and any(count.good is not True for count in counts) else 0
