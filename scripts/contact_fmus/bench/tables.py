"""The benchmark's tables on the terminal"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from .instructions import Count
from .ratios import Comparison

# Builds that differ by less are the same: where code and data happen to lie makes as much of a difference.
NOTICED = 0.05


WIDTH = 130  # where no terminal says otherwise


def print_rows(title: str, rows: Sequence[Comparison], console: Console | None = None) -> None:
    table = Table(title=title, title_justify="left", title_style="bold", header_style="bold")
    for head in ("", "time of", "divided by"):
        table.add_column(head)
    table.add_column("ratio", justify="right")
    table.add_column("middle half", justify="right")
    table.add_column("verdict")
    for row in rows:
        sides = (side(row, 0), side(row, 1))
        table.add_row(
            row.what, *sides, number(row.ratio.median) if row.ratio else "–", spread(row), verdict(row)
        )
    (console or own_console()).print(table)


def own_console() -> Console:
    console = Console()
    return console if console.is_terminal else Console(width=WIDTH)


def print_counts(
    counts: Sequence[Count], against: Path | None = None, console: Console | None = None
) -> None:
    """A line for each case; with another build's counts, this build's share of them"""
    title = "Instructions in fmi2DoStep" + (f", beside the FMUs of {against}" if against else "")
    table = Table(title=title, title_justify="left", title_style="bold", header_style="bold")
    table.add_column("")
    for head in ("instructions", *(["there", "here / there"] if against else []), "bound"):
        table.add_column(head, justify="right")
    table.add_column("verdict")
    for one in counts:
        other = [f"{one.other:,}", f"{one.instructions / one.other:.4f}"] if one.other else []
        bound = f"{one.bound:,}" if one.bound is not None else "–"
        verdict = {True: "[green]holds[/]", False: "[red]does not hold[/]", None: "[red]no bound[/]"}[
            one.good
        ]
        table.add_row(one.what, f"{one.instructions:,}", *other, bound, verdict)
    (console or own_console()).print(table)


def side(row: Comparison, which: int) -> str:
    """One of the two cases: its name, time and error"""
    name, time = ((row.first, row.first_time), (row.second, row.second_time))[which]
    error = row.errors[which]
    parts = [name, *([seconds(time)] if time is not None else []), *([f"{error:.1e} m"] if error else [])]
    return ", ".join(parts)


def seconds(time: float) -> str:
    unit, size = next(
        ((unit, size) for unit, size in (("s", 1.0), ("ms", 1e-3)) if time >= size), ("µs", 1e-6)
    )
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
