"""The command importers"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import platformdirs
from rich.console import Console

from contact_fmus.errors import UserError

from .page import page, table
from .trying import AGREE, IMPORTERS, Given, Trial, installed, prepared_java, tried, version_of


def setting(text: str) -> tuple[str, int]:
    name, _, value = text.partition("=")
    try:
        return name, int(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} (allowed: NAME=N, N a whole number)") from None


def main(arguments: list[str] | None = None) -> int:
    """0: every importer that ran an FMU agrees with fmpy; 1: one does not, or refuses one; 2: no such FMU"""
    parser = argparse.ArgumentParser(
        prog="contact-fmus importers",
        description="Runs FMUs in every importer that is installed and compares end values with fmpy's.",
    )
    parser.add_argument("fmus", type=Path, nargs="+", metavar="FMU")
    parser.add_argument("--steps", type=int, default=1000, metavar="N", help="communication steps (1000)")
    parser.add_argument("--step", type=float, default=1e-3, metavar="S", help="of so many seconds (0.001)")
    parser.add_argument(
        "--set", type=setting, action="append", default=[], metavar="NAME=N", help="a choice, by its number"
    )
    parser.add_argument("--python", type=Path, default=Path(sys.executable), help="that has the importers")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="the page, as docs/importers.md")
    options = parser.parse_args(arguments)
    for fmu in options.fmus:
        if not fmu.is_file():
            raise UserError(f"{fmu}: there is no such file")
    if not (options.steps > 0 and 0.0 < options.step < 1e6):
        raise UserError("--steps and --step: (allowed: at least 1 step of more than 0 and less than 1e6 s)")
    java = prepared_java(Path(platformdirs.user_cache_path("contact-fmus")) / "importers")
    present = [importer for importer in IMPORTERS if installed(importer, options.python, java)]
    given = Given(options.step, options.steps, options.python, java, dict(options.set))
    console, good, tables = Console(stderr=True), True, {}
    for version in (2, 3):
        fmus = [fmu for fmu in options.fmus if version_of(fmu) == version]
        taking = [importer for importer in IMPORTERS if version == 2 or importer.script3]
        trials = []
        for fmu in fmus:
            with console.status(fmu.stem):
                trials += [tried(importer, fmu, given) for importer in taking if importer in present]
        good = told(trials) and good
        if fmus:
            tables[version] = table(trials, present, taking)
    if options.output:
        options.output.write_text(page(tables, options.step, options.steps), encoding="utf-8")
    return 0 if good else 1


def told(trials: list[Trial]) -> bool:
    """Prints a line each; whether all agree"""
    references = {trial.fmu: trial for trial in trials if trial.importer.name == "fmpy"}
    good = True
    for trial in trials:
        off = None if trial.problem else trial.difference(references[trial.fmu])
        good = good and off is not None and off <= AGREE
        print(f"{trial.fmu}: {trial.importer.name}: {trial.problem or f'differs by {off:.1e}'}")
    return good
