"""Results as tables in the terminal, and the number formats that the HTML page shares"""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from contact_fmus.pages.formula import plain

from .leave_out import FmuSize
from .runner import ClaimResult, ScenarioResult

WIDTH = 170  # of tables that do not go to a terminal


def make_console() -> Console:
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=WIDTH)


def format_value(value: Any, unit: str) -> str:
    values = np.atleast_1d(np.asarray(value, dtype=float))
    text = ", ".join(f"{entry:.8g}" for entry in values)
    return (f"({text})" if len(values) > 1 else text) + (f" {unit}" if unit != "1" else "")


def format_error(result: ClaimResult) -> str:
    return f"{result.error:.1e}" + _error_unit(result)


def format_allowed(result: ClaimResult) -> str:
    return f"{result.claim.allowed:.0e}" + _error_unit(result)


def _error_unit(result: ClaimResult) -> str:
    if result.claim.relative:
        return " rel."
    return "" if result.outcome.unit == "1" else f" {result.outcome.unit}"


def claims_table(results: list[ScenarioResult]) -> Table:
    """A line for each claim, with the run that is furthest from it"""
    table = Table(
        title="Claims (of several runs of a scenario, the one with the largest error)", title_justify="left"
    )
    for name in ("scenario", "claim"):
        table.add_column(name, overflow="fold")
    table.add_column("runs", justify="right")
    for name in ("measured", "expected"):
        table.add_column(name, overflow="fold", justify="right")
    for name in ("error", "allowed"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("holds", no_wrap=True)
    for result in results:
        title = result.scenario.title
        for claim in result.scenario.claims:
            worst = result.worst(claim)
            if worst is not None:
                runs = sum(one.claim is claim for one in result.results)
                unit = worst.outcome.unit
                table.add_row(
                    title, plain(claim.text), str(runs), format_value(worst.outcome.measured, unit),
                    format_value(worst.outcome.expected, unit), format_error(worst), format_allowed(worst),
                    "[green]yes[/]" if worst.holds else "[red]NO[/]",
                )  # fmt: skip
                title = ""
        table.add_section()
    return table


def leave_out_table(sizes: list[FmuSize]) -> Table:
    table = Table(title="Leave out: what a scene that pins choices is spared", title_justify="left")
    table.add_column("FMU")
    for name in ("variables", "library [bytes]", "state [bytes]", "time per step [µs]"):
        table.add_column(name, justify="right")
    table.add_column("same problem on the universal FMU [µs]", justify="right")
    for size in sizes:
        other = f"{size.universal_time * 1e6:.2f} ({size.universal})" if size.universal else ""
        table.add_row(
            size.name, str(size.variables), f"{size.library:,}", f"{size.state:,}",
            f"{size.time * 1e6:.2f}", other,
        )  # fmt: skip
    return table
