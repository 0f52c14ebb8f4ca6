"""The benchmark's tables on the terminal"""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from .ratios import Row

# Builds that differ by less are the same: where code and data happen to lie makes as much of a difference.
NOTICED = 0.05


WIDTH = 130  # where no terminal says otherwise


def print_rows(title: str, rows: Sequence[Row], console: Console | None = None) -> None:
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
    if console is None:
        console = Console()
        console = console if console.is_terminal else Console(width=WIDTH)
    console.print(table)


def side(row: Row, which: int) -> str:
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


def spread(row: Row) -> str:
    return f"{number(row.ratio.low)} … {number(row.ratio.high)}" if row.ratio else "–"


def verdict(row: Row) -> str:
    """Against what is asked for; between builds, which one is quicker, where the pairs are sure of that"""
    if row.ratio is None:
        return f"[red]{row.note.splitlines()[-1]}[/]"
    if row.good is not None:
        asked = f"≥ {row.at_least:g}" if row.at_least is not None else f"≤ {row.at_most:g}"
        return f"[green]{asked} holds[/]" if row.good else f"[red]{asked} does not hold[/]"
    if row.ratio.bounds is None:
        return "too few pairs"
    if row.ratio.bounds[0] > 1.0 + NOTICED:
        return "[red]slower[/]"
    return "[green]quicker[/]" if row.ratio.bounds[1] < 1.0 - NOTICED else "same"
