"""python -m contact_scenarios run [FILE ...] --output FOLDER | picture FILE --output PNG | leave-out"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import plots, runner, tables
from .fmu import FmuError, fmus_folder, repository
from .leave_out import measure_all
from .recording import RunError, record
from .report import write_report
from .scenario import ScenarioError, read_scenario


def main(arguments: list[str] | None = None) -> int:
    """0: all claims hold; 1: one does not, or an FMU refused; 2: the request makes no sense"""
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except ScenarioError as error:
        print(error, file=sys.stderr)
        return 2
    except (RunError, FmuError, FileNotFoundError) as error:
        print(error, file=sys.stderr)
        return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m contact_scenarios", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    run = commands.add_parser("run", help="run scenarios, check their claims, write plots and index.html")
    run.add_argument("files", nargs="*", type=Path, help="scenario files; default all of scripts/scenarios")
    run.add_argument("--output", type=Path, default=repository() / "build" / "scenarios", metavar="FOLDER")
    run.add_argument("--no-plots", action="store_true", help="check the claims only")
    run.set_defaults(command=_run)
    picture = commands.add_parser("picture", help="draw one scenario")
    picture.add_argument("file", type=Path)
    picture.add_argument("--output", type=Path, required=True, metavar="PNG")
    picture.set_defaults(command=_picture)
    leave_out = commands.add_parser("leave-out", help="compare the sizes and speeds of the FMUs")
    leave_out.set_defaults(command=_leave_out)
    return parser


def _run(options: argparse.Namespace) -> int:
    files = options.files or sorted((repository() / "scripts" / "scenarios").glob("*.toml"))
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
    scenario = read_scenario(options.file)
    plots.draw([record(scenario, variant) for variant in scenario.plotted()], options.output)
    print(options.output)
    return 0


def _leave_out(_options: argparse.Namespace) -> int:
    sizes = measure_all()
    if not sizes:
        raise FileNotFoundError(f"no FMU in {fmus_folder()}: build first")
    tables.make_console().print(tables.leave_out_table(sizes))
    print("time per step: least of 5 averages over 1000 communication steps of 1 ms, fmpy's call included")
    return 0


if __name__ == "__main__":
    sys.exit(main())
