"""Onsets of a ball fired at a tumbling cylinder, in one communication step of 10 s, against a reference.

PYTHONPATH=scripts:tests CONTACT_FMUS=build/fmus python scripts/studies/tumbling.py [FIRST [LAST [ENDS]]]

Runs the random scenes FIRST to LAST (0 to 999) of tests/support/reference/tumbling.py, with cylinders
whose ENDS are open or capped; status 1 where one has another number of onsets or another first touch.
docs/conservative_advancement.md says why none is missed.
"""

import argparse
import sys

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.reference.tumbling import failures


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("first", nargs="?", type=int, default=0, help="first scene, 0 by default")
    parser.add_argument("last", nargs="?", type=int, default=999, help="last scene, 999 by default")
    parser.add_argument("ends", nargs="?", choices=("open", "capped"), default="open")
    asked = parser.parse_args()
    if not 0 <= asked.first <= asked.last:
        parser.error(f"scenes {asked.first} to {asked.last} are none (allowed: 0 <= FIRST <= LAST)")
    return asked


def main():
    asked = arguments()
    first, last, ends = asked.first, asked.last, asked.ends
    wrong, worst = 0, 0.0
    with ContactFmu(fmu_file("SphereCylinder")) as fmu:
        for seed in range(first, last + 1):
            lines, off = failures(fmu, seed, ends=ends)
            wrong, worst = wrong + bool(lines), max(worst, off)
            for line in lines:
                print(line, flush=True)
    count = last + 1 - first
    print(f"{count - wrong} of {count} right; first touch off by {worst:.1e} s at most")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
