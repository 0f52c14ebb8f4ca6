"""Runs scenarios: every variant with its claims, then the runs that are drawn"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from . import claims, plots
from .experiment import Claim, RunError, Scenario, Variant
from .recording import DRAWN, record


@dataclass(frozen=True)
class ClaimResult:
    claim: Claim
    variant: Variant
    outcome: claims.Outcome

    @property
    def error(self) -> float:
        return self.outcome.error_of(self.claim)

    @property
    def holds(self) -> bool:
        return self.outcome.holds(self.claim)


@dataclass
class ScenarioResult:
    scenario: Scenario
    results: list[ClaimResult] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)  # runs that the FMU refused
    plot: Path | None = None

    @property
    def holds(self) -> bool:
        return not self.failures and all(result.holds for result in self.results)

    def worst(self, claim: Claim) -> ClaimResult | None:
        """The run in which the claim is furthest from holding; a NaN error counts as furthest"""
        own = [result for result in self.results if result.claim is claim]
        return max(own, key=lambda result: (math.isnan(result.error), result.error), default=None)


def run_scenario(
    scenario: Scenario, plot_folder: Path | None, advance: Callable[[int], None]
) -> ScenarioResult:
    result = ScenarioResult(scenario)
    for variant in scenario.variants:
        with _failures_kept(result):
            recording = record(scenario, variant, advance)
            for claim in scenario.claims:
                if all(variant.choice[name] == value for name, value in claim.when.items()):
                    outcome = claims.evaluate(claim, recording)
                    result.results.append(ClaimResult(claim, variant, outcome))
    if plot_folder is not None:
        with _failures_kept(result):
            recordings = [record(scenario, variant, advance, DRAWN) for variant in scenario.plotted()]
            result.plot = plots.draw(recordings, plot_folder / f"{scenario.name}.png")
    return result


@contextlib.contextmanager
def _failures_kept(result: ScenarioResult) -> Iterator[None]:
    try:
        yield
    except RunError as error:
        result.failures.append(str(error))


def run_scenarios(
    scenarios: list[Scenario], plot_folder: Path | None, console: Console
) -> list[ScenarioResult]:
    """A progress bar counts communication steps; on something that is not a terminal it stays silent."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=sum(_steps(scenario, plot_folder) for scenario in scenarios))
        results = []
        for scenario in scenarios:
            progress.update(task, description=scenario.title)
            results.append(run_scenario(scenario, plot_folder, lambda steps: progress.advance(task, steps)))
    return results


def _steps(scenario: Scenario, plot_folder: Path | None) -> int:
    drawn = scenario.plotted() if plot_folder is not None else []
    return sum(variant.steps for variant in [*scenario.variants, *drawn])
