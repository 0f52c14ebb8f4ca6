"""The command run"""

import argparse
import dataclasses
import functools
import json
import math
import sys
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from contact_fmus.errors import UserError
from contact_fmus.options import parse
from contact_fmus.results import PICTURES, Result, output_file
from contact_fmus.scenarios.experiment import Experiment
from contact_fmus.scenarios.recording import StoppedEarly, simulate
from contact_fmus.scenarios.scenario import changed, find, first_run

from .exchange import by_fmpy


def main(arguments: list[str] | None = None) -> int:
    """0: run to its end; 2: the request makes no sense; 3: the FMU refused on the way"""
    options = parse("run", arguments)
    experiment = _experiment(options)
    picture = None if options.plot is None else Path(options.plot or f"{experiment.name}.png")
    # Before the run, where a file could not be written after it
    if options.csv is not None and options.csv.is_dir():
        raise UserError(f"{options.csv}: this is a folder")
    if options.csv is not None and not options.csv.parent.is_dir():
        raise UserError(f"{options.csv}: there is no folder {options.csv.parent}")
    if picture is not None:
        output_file(picture, "", (*PICTURES, ".html"))
    # A table has a row a communication step; a picture alone shows contacts that are shorter.
    within = picture is not None and options.csv is None
    runs = by_fmpy if options.model_exchange else functools.partial(simulate, within=within)
    console = Console(stderr=True)
    try:
        with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
            begin = experiment.start_time
            task = progress.add_task(experiment.name, total=experiment.stop_time - begin)
            told = options.output_interval, lambda time: progress.update(task, completed=time - begin)
            result = runs(experiment, *told)
    except StoppedEarly as stopped:
        _write(stopped.result, experiment, options, picture)  # what there is until then
        raise
    _write(result, experiment, options, picture)
    return 0


def _experiment(options: argparse.Namespace) -> Experiment:
    """The target's own experiment, and what the options change of it"""
    experiment, note = first_run(find(options.target))
    experiment = changed(experiment, options.set, options.stop)
    if note:
        print(note, file=sys.stderr)
    return dataclasses.replace(
        experiment, step=options.step or experiment.step, tolerance=options.tolerance or experiment.tolerance
    )


def _write(result: Result, experiment: Experiment, options: argparse.Namespace, picture: Path | None) -> None:
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
    if picture is not None:
        from contact_fmus.plot.command import draw

        draw(result, picture)
        print(picture, file=sys.stderr if options.json else sys.stdout)


def _json(value: Any) -> Any:
    """A number that is not finite has no place in JSON."""
    plain = value.item() if hasattr(value, "item") else value
    return None if isinstance(plain, float) and not math.isfinite(plain) else plain


def end_values(result: Result) -> list[str]:
    """A line for each scalar and each vector: name, value, unit"""
    groups: dict[str, list[str]] = {}
    for name, column in result.columns.items():
        value = column[-1]
        text = f"{value:.9g}" if isinstance(value, float) else str(value)
        groups.setdefault(name.partition("[")[0], []).append(text)
    width = max((len(name) for name in groups), default=0)
    lines = []
    for name, texts in groups.items():
        value = texts[0] if len(texts) == 1 else f"({', '.join(texts)})"
        unit = result.units.get(name) or result.units.get(f"{name}[1]", "")
        lines.append(f"{name:{width}}  {value} {unit}".rstrip())
    return lines
