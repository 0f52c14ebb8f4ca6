"""The command report: all that docs/report is made of, one part after the other"""

from .coupling import study
from .options import parse
from .peers import command, energy
from .report import measure, page


def main(arguments: list[str] | None = None) -> int:
    """0: the page is drawn; 3: an FMU refused"""
    options = parse("report", arguments)
    folder, quick = ["--output", str(options.output)], ["--quick"] if options.quick else []
    parts = [
        ("The FMU's solvers", measure.main, [*quick, *folder]),
        ("The FMU as a force element", study.main, [*quick, *folder]),
        *([("Other simulators", command.main, [*quick, *folder])] if options.peers else []),
        ("Energy", energy.main, [*quick, *folder, *["--peers"] * options.peers]),
        ("Page", page.main, folder),
    ]
    for title, part, given in parts:
        print(f"\n== {title}", flush=True)
        status = part(given)
        if status != 0:
            return status
    return 0
