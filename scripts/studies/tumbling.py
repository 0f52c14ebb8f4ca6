"""Onsets of a ball fired at a tumbling cylinder, in one communication step of 10 s, against a reference.

PYTHONPATH=scripts:tests CONTACT_FMUS=build/fmus python scripts/studies/tumbling.py [FIRST [LAST [ENDS]]]

Runs the random scenes FIRST to LAST (0 to 999) of tests/support/scenes/tumbling_scenes.py, with cylinders
whose ENDS are open or capped; status 1 where one has another number of onsets or another first touch.
docs/tumbling.md says why none is missed.
"""

import sys

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.scenes.tumbling_checks import failures


def main():
    words = sys.argv[1:] + ["0", "999", "open"][len(sys.argv) - 1 :]
    first, last, ends = int(words[0]), int(words[1]), words[2]
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
