"""The command animate of contact-fmus"""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_fmus.errors import UserError, similar
from contact_fmus.plot.command import add_run_options, output_file
from contact_fmus.plot.source import Run, open_runs
from contact_fmus.scenarios.target import ANY, find, words

from .page import write_page


def main(arguments: list[str] | None = None) -> int:
    """0: written"""
    parser = argparse.ArgumentParser(
        prog="contact-fmus animate",
        description="Writes a page that plays a run in three dimensions. It needs no network.",
    )
    parser.add_argument(
        "source", metavar="FMU|SCENARIO|RESULT", help=f"{words(ANY)}; of shipped ones the name"
    )
    add_run_options(parser)
    parser.add_argument("--variant", metavar="LABEL", help="which run of a scenario; default the last")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="default NAME.html here")
    options = parser.parse_args(arguments)
    output = output_file(options.output, find(options.source, ANY).stem + ".html", (".html",))
    runs = open_runs(options.source, options.set, options.stop, options.fmu)
    write_page(_chosen(runs, options.variant), output)
    print(output)
    return 0


def _chosen(runs: list[Run], label: str | None) -> Run:
    if label is None:
        return runs[-1]
    found = [run for run in runs if run.label == label]
    if not found:
        labels = [run.label for run in runs if run.label]
        known = f"there are {', '.join(labels)}" if labels else "there is one run, without a label"
        raise UserError(f"--variant: no run '{label}'{similar(label, labels)}; {known}")
    return found[0]
