"""The command bench of contact_fmus: instruction counts with their bounds, and ratios of run times"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import repository
from contact_fmus.options import parse
from contact_fmus.pages import Table, show

from . import instructions, ratios
from .instructions import Count
from .ratios import Comparison

# The FMUs of another commit, built in a worktree of its own that is taken away afterwards

FMUS = ("SphereSphere", "SphereCylinder")


@contextmanager
def built(commit: str) -> Iterator[Path]:
    """The folder of the FMUs; RuntimeError with what git, CMake or the compiler said where there are none"""
    with tempfile.TemporaryDirectory(prefix="baseline-") as folder:
        tree = Path(folder) / "tree"
        run("git", "-C", repository(), "worktree", "add", "--detach", tree, commit)
        try:
            run("cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja", *options())
            run("cmake", "--build", tree / "build", "--target", *(f"{name}_fmu" for name in FMUS))
            yield tree / "build" / "fmus"
        finally:
            run("git", "-C", repository(), "worktree", "remove", "--force", tree)


def options() -> list[str]:
    """The options of the preset named default"""
    values = {"CMAKE_BUILD_TYPE": "Release", "CMAKE_C_COMPILER": "gcc", "BUILD_TESTING": "OFF"}
    values["Python3_EXECUTABLE"] = sys.executable
    return [f"-D{name}={value}" for name, value in values.items()]


def run(*command: object) -> None:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")


# The benchmark's tables on the terminal

# Builds that differ by less are the same: where code and data happen to lie makes as much of a difference.
NOTICED = 0.05


def print_rows(title: str, rows: Sequence[Comparison], console: Console | None = None) -> None:
    header = ["", "time of", "divided by", "ratio", "middle half", "verdict"]
    cells = [
        [
            row.what,
            side(row, 0),
            side(row, 1),
            number(row.ratio.median) if row.ratio else "–",
            spread(row),
            verdict(row),
        ]
        for row in rows
    ]
    show(Table(title, header, cells, 3), console)


def print_counts(counts: Sequence[Count], against: Path | None = None) -> None:
    """A line for each case; with another build's counts, this build's share of them"""
    title = "Instructions in fmi2DoStep" + (f", beside the FMUs of {against}" if against else "")
    words = {True: "[green]holds[/]", False: "[red]does not hold[/]", None: "[red]no bound[/]"}
    cells = []
    for one in counts:
        other = [f"{one.other:,}", f"{one.instructions / one.other:.4f}"] if one.other else []
        bound = f"{one.bound:,}" if one.bound is not None else "–"
        cells.append([one.what, f"{one.instructions:,}", *other, bound, words[one.good]])
    show(Table(title, ["", "instructions", *(["there", "here / there"] if against else []), "bound", "verdict"], cells))


def side(row: Comparison, which: int) -> str:
    """One of the two cases: its name, time and error"""
    name, time = ((row.first, row.first_time), (row.second, row.second_time))[which]
    error = row.errors[which]
    parts = [name, *([seconds(time)] if time is not None else []), *([f"{error:.1e} m"] if error else [])]
    return ", ".join(parts)


def seconds(time: float) -> str:
    unit, size = next(((unit, size) for unit, size in (("s", 1.0), ("ms", 1e-3)) if time >= size), ("µs", 1e-6))
    return f"{time / size:.3g} {unit}"


def number(value: float) -> str:
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def spread(row: Comparison) -> str:
    return f"{number(row.ratio.low)} … {number(row.ratio.high)}" if row.ratio else "–"


def verdict(row: Comparison) -> str:
    """Which side is quicker, where the pairs are sure of that"""
    if row.ratio is None:
        return f"[red]{row.note.splitlines()[-1]}[/]"
    if row.ratio.bounds is None:
        return "too few pairs"
    if row.ratio.bounds[0] > 1.0 + NOTICED:
        return "[red]slower[/]"
    return "[green]quicker[/]" if row.ratio.bounds[1] < 1.0 - NOTICED else "same"


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: with --check, a count is above its bound; 2: something is not built; 3: a run failed"""
    options = parse("bench", arguments)
    if options.baseline and options.instructions:
        raise UserError("--baseline is about run times: leave out --instructions, or use --against DIR")
    counts = instructions.measure(options.against)
    print_counts(counts, options.against)
    if not options.instructions:
        _print_ratios(options)
    return 1 if options.check and any(count.good is not True for count in counts) else 0


def _print_ratios(options: argparse.Namespace) -> None:
    effort = ratios.QUICK if options.quick else ratios.FULL
    for title, measure in (
        ("Flight: time of this FMU / time of one that does nothing", ratios.flights),
        ("Time of CVODE / time of event_driven", ratios.against_cvode),
        ("Stiffness: time at the stiff contact / time at the soft one", ratios.stiffness),
    ):
        print_rows(title, measure(effort))
    if options.baseline:
        with built(options.baseline) as folder:
            rows = ratios.against_baseline(folder, options.baseline, effort)
            print_rows(f"This build / {options.baseline}", rows)
