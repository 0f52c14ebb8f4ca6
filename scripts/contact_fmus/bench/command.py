"""The command bench of contact_fmus: ratios for developers"""

from __future__ import annotations

import argparse

from . import ratios
from .baseline import built
from .tables import print_rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="contact_fmus bench", description=ratios.__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few runs, to see that it works")
    parser.add_argument(
        "--check", action="store_true", help="end with status 1 where a ratio is not as asked"
    )
    parser.add_argument("--baseline", metavar="COMMIT", help="compare with the FMUs of another commit")
    options = parser.parse_args(arguments)
    effort = ratios.QUICK if options.quick else ratios.FULL
    rows = []
    for title, measure in (
        ("Flight: time of this FMU / time of one that does nothing", ratios.flights),
        ("Time of CVODE / time of event_driven", ratios.against_cvode),
        ("Stiffness: time at the stiff contact / time at the soft one", ratios.stiffness),
    ):
        measured = measure(effort)
        print_rows(title, measured)
        rows += measured
    if options.baseline:
        with built(options.baseline) as folder:
            print_rows(
                f"This build / {options.baseline}", ratios.against_baseline(folder, options.baseline, effort)
            )
    return 1 if options.check and any(row.good is False for row in rows) else 0
