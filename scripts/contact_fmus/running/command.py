"""The command run"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from contact_fmus.errors import UserError
from contact_fmus.results import Result
from contact_fmus.scenarios.scenario import Experiment, changed, find, first_run

from .simulate import StoppedEarly, exchange, simulate

EPILOG = """examples:
  contact-fmus run SphereSphere --set contact.dashpot=unclamped --stop 1 --csv bounce.csv
  contact-fmus run My.fmu --set source.center=0,0,1.2 --plot
  contact-fmus run fmi3/SphereSphere --model-exchange
  contact-fmus run p1_head_on_bounces --json"""


def main(arguments: list[str] | None = None) -> int:
    """0: run to its end; 2: the request makes no sense; 3: the FMU refused on the way"""
    options = _parser().parse_args(arguments)
    experiment = _experiment(options)
    _check_files(experiment, options)
    try:
        runs = exchange if options.model_exchange else simulate
        result = _with_progress(runs, experiment, options.output_interval)
    except StoppedEarly as stopped:
        _write(stopped.result, experiment, options)  # what there is until then
        raise
    _write(result, experiment, options)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="contact-fmus run",
        description="Runs an FMU or a scenario and shows the values at the end.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "target",
        metavar="FMU|SCENARIO",
        help="file.fmu, a shipped FMU (of FMI 3.0: fmi3/NAME), a scenario or its .toml",
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a start value; vectors as 0,0,1; repeatable"
    )
    parser.add_argument("--stop", type=number, metavar="S", help="end of the run, s")
    parser.add_argument("--step", type=number, metavar="S", help="communication step, s")
    parser.add_argument("--tolerance", type=number, metavar="R", help="relative, given to the FMU or CVODE")
    parser.add_argument("--output-interval", type=number, metavar="S", help="time between rows of the result, s")
    parser.add_argument("--model-exchange", action="store_true", help="fmpy's CVODE integrates the FMU's states")
    parser.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="writes all inputs and outputs over time; units and parameters into FILE.json beside it",
    )
    parser.add_argument("--json", action="store_true", help="the values at the end, as JSON")
    parser.add_argument(
        "--plot", nargs="?", const="", metavar="FILE", help="draws gaps, forces and positions; NAME.png without FILE"
    )
    return parser


def number(text: str) -> float:
    """A finite number greater than 0"""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a finite number greater than 0")
    return value


def _experiment(options: argparse.Namespace) -> Experiment:
    """The target's own experiment, and what the options change of it"""
    experiment, note = first_run(find(options.target))
    experiment = changed(experiment, options.set, options.stop)
    if note:
        print(note, file=sys.stderr)
    return dataclasses.replace(
        experiment, step=options.step or experiment.step, tolerance=options.tolerance or experiment.tolerance
    )


def _check_files(experiment: Experiment, options: argparse.Namespace) -> None:
    """Before the run, where one could not be written after it"""
    if options.csv is not None and options.csv.is_dir():
        raise UserError(f"{options.csv}: this is a folder")
    if options.csv is not None and not options.csv.parent.is_dir():
        raise UserError(f"{options.csv}: there is no folder {options.csv.parent}")
    if options.plot is not None:
        from contact_fmus.plot.command import SUFFIXES, output_file

        output_file(_picture(experiment, options), "", SUFFIXES)


def _picture(experiment: Experiment, options: argparse.Namespace) -> Path:
    return Path(options.plot or f"{experiment.name}.png")


def _with_progress(runs: Callable[..., Result], experiment: Experiment, interval: float | None) -> Result:
    """A bar on a terminal's stderr, nothing where there is none"""
    length = experiment.stop_time - experiment.start_time
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(experiment.name, total=length)
        return runs(experiment, interval, lambda time: progress.update(task, completed=time - experiment.start_time))


def _write(result: Result, experiment: Experiment, options: argparse.Namespace) -> None:
    result.tell_warnings()
    if options.csv is not None:
        result.write_csv(options.csv)
    if options.json:
        values = {name: _json(column[-1]) for name, column in result.columns.items()}
        print(json.dumps({"fmu": str(result.fmu), "time": float(result.time[-1]), "values": values}))
    else:
        print(f"{experiment.name} at {float(result.time[-1])!r} s, {len(result.time)} rows")
        for line in end_values(result):
            print(f"  {line}")
    if options.plot is not None:
        from contact_fmus.plot.command import draw

        file = _picture(experiment, options)
        draw(result, file)
        print(file, file=sys.stderr if options.json else sys.stdout)


def _json(value: Any) -> Any:
    """A number that is not finite has no place in JSON."""
    plain = _unsigned(value.item() if hasattr(value, "item") else value)
    return None if isinstance(plain, float) and not math.isfinite(plain) else plain


def _unsigned(value: Any) -> Any:
    """0 for -0, which says no more"""
    return abs(value) if isinstance(value, float) and value == 0.0 else value


def end_values(result: Result) -> list[str]:
    """A line for each scalar and each vector: name, value, unit"""
    groups: dict[str, list[str]] = {}
    for name, column in result.columns.items():
        value = column[-1]
        text = f"{_unsigned(value):.9g}" if isinstance(value, float) else str(value)
        groups.setdefault(name.partition("[")[0], []).append(text)
    width = max((len(name) for name in groups), default=0)
    lines = []
    for name, texts in groups.items():
        value = texts[0] if len(texts) == 1 else f"({', '.join(texts)})"
        unit = result.units.get(name) or result.units.get(f"{name}[1]", "")
        lines.append(f"{name:{width}}  {value} {unit}".rstrip())
    return lines
