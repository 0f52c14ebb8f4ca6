"""The commands scenarios and leave-out"""

import contextlib
import datetime
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus import pages
from contact_fmus.errors import UserError
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmus_folder, repository
from contact_fmus.options import parse
from contact_fmus.pages import plain, write_pages
from contact_fmus.scenarios import claims
from contact_fmus.scenarios.experiment import Claim, Scenario, Variant
from contact_fmus.scenarios.recording import record
from contact_fmus.scenarios.scenario import SCENARIOS, find, read_scenario

# Runs scenarios: every variant with its claims, then the runs that are drawn


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
    warnings: dict[str, None] = field(default_factory=dict)  # of the FMU, each once
    plot: Path | None = None

    @property
    def holds(self) -> bool:
        return not self.failures and all(result.holds for result in self.results)

    def worst(self, claim: Claim) -> ClaimResult | None:
        """The run in which the claim is furthest from holding; a NaN error counts as furthest"""
        own = [result for result in self.results if result.claim is claim]
        return max(own, key=lambda result: (math.isnan(result.error), result.error), default=None)


def run_scenario(file: Path, plot_folder: Path | None = None) -> ScenarioResult:
    result = ScenarioResult(scenario := read_scenario(file))
    for variant in scenario.variants:
        with _failures_kept(result):
            recording = record(scenario, variant)
            result.warnings |= dict.fromkeys(recording.warnings)
            for claim in scenario.claims:
                if all(variant.choice[name] == value for name, value in claim.when.items()):
                    outcome = claims.evaluate(claim, recording)
                    result.results.append(ClaimResult(claim, variant, outcome))
    if plot_folder is not None:
        from contact_fmus.plot.command import draw_scenario  # brings matplotlib

        with _failures_kept(result):
            draw_scenario(file, plot := plot_folder / f"{scenario.name}.png")
            result.plot = plot
    return result


@contextlib.contextmanager
def _failures_kept(result: ScenarioResult) -> Iterator[None]:
    try:
        yield
    except UserError as error:
        result.failures.append(str(error))


# Results as tables in the terminal, and the number formats that the HTML page shares


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


def claims_table(results: list[ScenarioResult]) -> pages.Table:
    """A line for each claim, with the run that is furthest from it"""
    cells = []
    for result in results:
        title = result.scenario.title
        for claim in result.scenario.claims:
            if (worst := result.worst(claim)) is not None:
                runs, unit = sum(one.claim is claim for one in result.results), worst.outcome.unit
                values = (format_value(value, unit) for value in (worst.outcome.measured, worst.outcome.expected))
                holds = "[green]yes[/]" if worst.holds else "[red]NO[/]"
                errors = format_error(worst), format_allowed(worst)
                cells.append([title, plain(claim.text), str(runs), *values, *errors, holds])
                title = ""
    caption = "Claims (of several runs of a scenario, the one with the largest error)"
    header = ["scenario", "claim", "runs", "measured", "expected", "error", "allowed", "holds"]
    return pages.Table(caption, header, cells, 2)


# The HTML page of all scenarios


def write_report(results: list[ScenarioResult], folder: Path) -> Path:
    """index.html in `folder`, next to the plots it shows"""
    context = {
        "results": results,
        "summary": summary(results),
        "contents": [("claims", "All claims")] + [(one.scenario.name, one.scenario.title) for one in results],
        "labels": plotted_labels,
        "value": format_value,
        "error": format_error,
        "allowed": format_allowed,
        "plot": lambda result: result.plot.relative_to(folder).as_posix() if result.plot else None,
        "made": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
    }
    (file,) = write_pages(Path(__file__).parent, folder, context, {"page.html": "index.html"})
    return file


def summary(results: list[ScenarioResult]) -> str:
    """How many comparisons there are, and how many of them do not hold"""
    every = [one for result in results for one in result.results]
    failures = sum(len(result.failures) for result in results)
    text = f"{len(results)} scenario{'s' * (len(results) != 1)}, {len(every)} comparisons, "
    return f"{text}{sum(not one.holds for one in every)} do not hold, {failures} runs failed."


def plotted_labels(result: ScenarioResult) -> str:
    """What the colours of the picture stand for; nothing where there is one run"""
    labels = [variant.label for variant in result.scenario.plotted()]
    return ", ".join(labels) if len(labels) > 1 else ""


def run(arguments: list[str] | None = None) -> int:
    """0: all claims hold; 1: one does not, or an FMU refused in one; 2: the request makes no sense"""
    options = parse("scenarios", arguments)
    files = [find(one, SCENARIOS) for one in options.files] or sorted(
        (repository() / "scripts" / "scenarios").glob("*.toml")
    )
    for file in files:
        read_scenario(file)  # a wrong file is refused before anything runs
    console = pages.make_console()
    options.output.mkdir(parents=True, exist_ok=True)
    plot_folder = None if options.no_plots else options.output / "plots"
    with console.status("") as status:
        results = []
        for file in files:
            status.update(file.stem)
            results.append(run_scenario(file, plot_folder))
    pages.show(claims_table(results), console)
    for result in results:
        for text in result.warnings:
            print(f"warning: {result.scenario.name}: {text}", file=sys.stderr)
        for failure in result.failures:
            console.print(f"FAILED {failure}", style="red", markup=False)
    console.print(summary(results))
    if plot_folder is not None:
        print(f"plots: {plot_folder}")
    print(f"page:  {write_report(results, options.output)}")
    return 0 if all(result.holds for result in results) else 1


def leave_out(arguments: list[str] | None = None) -> int:
    """0: compared; 2: none is built; 3: an FMU refused"""
    parse("leave-out", arguments)
    cells = []
    scenes = {scene.stem for scene in (repository() / "modelDescription" / "scenes").glob("*.toml")}
    for file in sorted(file for file in fmus_folder().glob("*.fmu") if file.stem in scenes):
        with ContactFmu(file) as fmu:
            library = sum(file.stat().st_size for file in Path(fmu.folder, "binaries").rglob("*.so"))
            fmu.start()
            numbers = len(fmu.description.modelVariables), library, len(fmu.save())
        cells.append([file.stem, *(f"{number:,}" for number in numbers)])
    if not cells:
        raise FileNotFoundError(f"no FMU in {fmus_folder()}: build first")
    header = ["FMU", "variables", "library [bytes]", "state [bytes]"]
    pages.show(pages.Table("Leave out: what a scene that pins choices is spared", header, cells))
    return 0
