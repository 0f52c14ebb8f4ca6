"""The command bench of contact_fmus: instruction counts with their bounds, and ratios of run times"""

from __future__ import annotations

import argparse
from pathlib import Path

from contact_fmus.errors import UserError

from . import best, instructions, ratios
from .baseline import built
from .tables import print_counts, print_rows


def main(arguments: list[str] | None = None) -> int:
    """0: done; 1: with --check, a count is above its bound; 2: something is not built; 3: a run failed"""
    options = _parser().parse_args(arguments)
    if options.baseline and options.instructions:
        raise UserError("--baseline is about run times: leave out --instructions, or use --against DIR")
    counts = instructions.measure(options.against)
    print_counts(counts, options.against)
    if not options.instructions:
        _print_ratios(options)
    return 1 if options.check and any(count.good is not True for count in counts) else 0


def _parser() -> argparse.ArgumentParser:
    text = "How many instructions the FMUs execute, and ratios of run times."
    parser = argparse.ArgumentParser(prog="contact-fmus bench", description=text)
    parser.add_argument("--quick", action="store_true", help="few runs, to see that it works")
    parser.add_argument("--instructions", action="store_true", help="the instruction counts only")
    parser.add_argument(
        "--against", type=Path, metavar="DIR", help="also count those of the FMUs in another build's folder"
    )
    parser.add_argument(
        "--check", action="store_true", help="the status is 1 where a count is above its bound"
    )
    parser.add_argument(
        "--baseline", metavar="COMMIT", help="run times beside those of another commit's FMUs"
    )
    return parser


def _print_ratios(options: argparse.Namespace) -> None:
    effort = ratios.QUICK if options.quick else ratios.FULL
    for title, measure in (
        ("Flight: time of this FMU / time of one that does nothing", ratios.flights),
        ("Time of CVODE / time of event_driven", best.against_cvode),
        ("Stiffness: time at the stiff contact / time at the soft one", ratios.stiffness),
    ):
        print_rows(title, measure(effort))
    if options.baseline:
        with built(options.baseline) as folder:
            rows = ratios.against_baseline(folder, options.baseline, effort)
            print_rows(f"This build / {options.baseline}", rows)
