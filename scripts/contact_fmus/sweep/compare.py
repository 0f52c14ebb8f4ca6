"""A study's time beside that of a bare loop in C over the same runs, on as many processors, side by side

The bare loop (scripts/tools/batch/bare_loop.c) has the FMU loaded and all start values in memory; it keeps
nothing. The sweep is the whole command: its workers start, rows are written, read again and merged. On a
machine that others use, the ratio of processor times says more.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.files import unpack

from .drive import make_plan
from .native import Plan, built_file
from .study import Study

MOST = 10_000_000  # runs: the bare loop has all start values in memory
PIECE = 50_000  # runs whose start values are made at a time


@dataclass
class Spent:
    wall: float  # s
    processor: float  # s, of all processes
    memory: float  # MB, most of one process


def compare(study: Study, folder: Path, options: argparse.Namespace) -> int:
    program, samples = built_file("bare_loop"), study.samples()
    if program is None:
        raise UserError("--compare needs the program bare_loop: cmake --build --preset default")
    if samples.runs > MOST:
        raise UserError(f"--compare: at most {MOST:,} runs, the study has {samples.runs:,}")
    workers = options.workers or len(os.sched_getaffinity(0))
    bare = _bare(program, study, workers)
    command = [sys.executable, "-m", "contact_fmus", "sweep", str(study.file), "-o", str(folder), "--json"]
    sweep, _ = _measured([[*command, "--workers", str(workers)]], [b""])
    about = {
        "runs": samples.runs,
        "processors": workers,
        "bare_loop_s": bare.wall,
        "sweep_s": sweep.wall,
        "ratio": sweep.wall / bare.wall,
        "bare_loop_processor_s": bare.processor,
        "sweep_processor_s": sweep.processor,
        "processor_ratio": sweep.processor / bare.processor,
        "sweep_memory_mb": sweep.memory,
    }
    if options.json:
        print(json.dumps(about))
        return 0
    print(f"{samples.runs:,} runs on {workers} processors")
    print(f"bare loop: {bare.wall:.3g} s, {bare.processor:.3g} s of processors")
    print(f"sweep:     {sweep.wall:.3g} s, {sweep.processor:.3g} s of processors, {sweep.memory:.0f} MB at most")
    print(f"ratio:     {sweep.wall / bare.wall:.3g}, of processors {sweep.processor / bare.processor:.3g}")
    return 0


def _bare(program: Path, study: Study, workers: int) -> Spent:
    """Equal shares of the runs in as many processes at once; the loops alone are timed"""
    samples, plan = study.samples(), make_plan(study)
    cuts = np.linspace(0, samples.runs, workers + 1).astype(int)
    with tempfile.TemporaryDirectory(prefix="contact-bare-") as folder:
        commands, inputs = [], []
        # Run by run: what varies of Real, then of Integer and Enumeration, then of Boolean
        order = (("Real",), ("Integer", "Enumeration"), ("Boolean",))
        names = [one.name for kinds in order for one in study.parameters if one.variable.type in kinds]
        for place, (first, end) in enumerate(pairwise(cuts)):
            file = Path(folder) / f"values-{place}"
            with open(file, "wb") as target:
                for start in range(first, end, PIECE):
                    values = samples.values(start, min(PIECE, end - start))
                    rows = np.concatenate([values[name] for name in names], axis=1)
                    target.write(np.ascontiguousarray(rows, float).tobytes())
            commands.append([str(program), str(file)])
            inputs.append(describe(study, plan, end - first).encode())
        spent, printed = _measured(commands, inputs)
    loops = [float(text.split()[0]) for text in printed]
    return Spent(max(loops), sum(float(text.split()[1]) for text in printed), spent.memory)


def describe(study: Study, plan: Plan, runs: int) -> str:
    """What bare_loop reads"""
    folder, _ = unpack(study.fmu)
    library = folder / "binaries" / "linux64" / f"{plan.identifier}.so"
    words: list[str] = [str(-1.0 if plan.tolerance is None else plan.tolerance), repr(plan.start_time)]
    words += [str(len(plan.points)), *(repr(one) for one in plan.points.tolist())]
    for setting in plan.settings:
        words += [str(len(setting.references)), str(setting.varied), *map(str, setting.references.tolist())]
        words += [repr(one) for one in setting.constants.tolist()]
    for references in plan.read:
        words += [str(len(references)), *map(str, references.tolist())]
    return "\n".join([str(library), plan.guid, (folder / "resources").as_uri(), *words, str(runs), ""])


def _measured(commands: list[list[str]], inputs: list[bytes]) -> tuple[Spent, list[str]]:
    """All at once; what they printed"""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    pipe = subprocess.PIPE
    running = [subprocess.Popen(one, stdin=pipe, stdout=pipe, stderr=pipe) for one in commands]
    for process, given in zip(running, inputs, strict=True):
        assert process.stdin is not None
        process.stdin.write(given)
        process.stdin.close()
        process.stdin = None
    printed = [process.communicate() for process in running]
    for process, (_, said) in zip(running, printed, strict=True):
        if process.returncode != 0:
            raise RunFailure(f"--compare: {said.decode(errors='replace').strip().splitlines()[-1]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    # Linux counts ru_maxrss in kB.
    return Spent(time.perf_counter() - begin, used, after.ru_maxrss / 1000), [one.decode() for one, _ in printed]
