"""The commands run, picture and leave-out of contact_fmus"""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import fmus_folder, repository, results_folder

from . import plots, runner, tables
from .leave_out import measure_all
from .page import write_report
from .recording import DRAWN, record
from .scenario import read_scenario
from .target import SCENARIOS, find, words

PICTURES = (".png", ".svg", ".pdf")


def run(arguments: list[str] | None = None) -> int:
    """0: all claims hold; 1: one does not, or an FMU refused in one; 2: the request makes no sense"""
    text = "Runs scenarios, checks their claims, writes plots and index.html."
    parser = argparse.ArgumentParser(prog="contact-fmus scenarios", description=text)
    parser.add_argument(
        "files",
        nargs="*",
        metavar="SCENARIO",
        help=f"{words(SCENARIOS)} or a shipped one's name; default all",
    )
    parser.add_argument("--output", type=Path, default=results_folder("build/scenarios"), metavar="FOLDER")
    parser.add_argument("--no-plots", action="store_true", help="check the claims only")
    return _run(parser.parse_args(arguments))


def picture(arguments: list[str] | None = None) -> int:
    """0: drawn; 2: the request makes no sense; 3: an FMU refused"""
    parser = argparse.ArgumentParser(prog="contact-fmus picture", description="Draws one scenario.")
    parser.add_argument("file", metavar="SCENARIO", help=f"{words(SCENARIOS)} or a shipped one's name")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="default NAME.png here")
    return _picture(parser.parse_args(arguments))


def leave_out(arguments: list[str] | None = None) -> int:
    """0: compared; 2: none is built; 3: an FMU refused"""
    text = "Compares the sizes and speeds of the FMUs."
    parser = argparse.ArgumentParser(prog="contact-fmus leave-out", description=text)
    return _leave_out(parser.parse_args(arguments))


def _run(options: argparse.Namespace) -> int:
    files = [find(one, SCENARIOS) for one in options.files] or sorted(
        (repository() / "scripts" / "scenarios").glob("*.toml")
    )
    scenarios = [read_scenario(file) for file in files]
    console = tables.make_console()
    options.output.mkdir(parents=True, exist_ok=True)
    plot_folder = None if options.no_plots else options.output / "plots"
    results = runner.run_scenarios(scenarios, plot_folder, console)
    console.print(tables.claims_table(results))
    for result in results:
        for failure in result.failures:
            console.print(f"FAILED {failure}", style="red", markup=False)
    count = sum(len(result.results) for result in results)
    broken = sum(not one.holds for result in results for one in result.results)
    failures = sum(len(result.failures) for result in results)
    console.print(
        f"{len(results)} scenarios, {count} claims checked, {broken} do not hold, {failures} runs failed"
    )
    if plot_folder is not None:
        print(f"plots: {plot_folder}")
    print(f"page:  {write_report(results, options.output)}")
    return 0 if all(result.holds for result in results) else 1


def _picture(options: argparse.Namespace) -> int:
    file = find(options.file, SCENARIOS)
    output = options.output or Path(f"{file.stem}.png")
    if output.suffix not in PICTURES:
        known = ", ".join(PICTURES)
        raise UserError(f"{output}: '{output.suffix}' is none of the formats {known}")
    scenario = read_scenario(file)
    plots.draw([record(scenario, variant, inside=DRAWN) for variant in scenario.plotted()], output)
    print(output)
    return 0


def _leave_out(_options: argparse.Namespace) -> int:
    sizes = measure_all()
    if not sizes:
        raise FileNotFoundError(f"no FMU in {fmus_folder()}: build first")
    tables.make_console().print(tables.leave_out_table(sizes))
    print("time per step: least of 5 averages over 1000 communication steps of 1 ms, in turns")
    return 0
