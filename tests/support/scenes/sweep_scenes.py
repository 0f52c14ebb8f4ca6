"""python -m support.scenes.sweep_scenes [FAMILY ...] [--first SEED] [--count N] [--method M ...] [--brief]

Runs N scenes of each family of scene_families.py (all families without one named) and prints a line for
each failure, with all values of the scene, and at the end how many failed in which figure. The status is 1
where something failed. From the repository:

    PYTHONPATH=scripts:tests .venv/bin/python -m support.scenes.sweep_scenes "from zero" --count 400
"""

import argparse
import collections
import sys

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.checks import METHODS
from support.scenes.scene_checks import FMU, failures
from support.scenes.scene_families import FAMILIES, TooLong, drawn, expected


def main():
    parser = argparse.ArgumentParser(prog="python -m support.scenes.sweep_scenes", description=__doc__)
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=f"of: {', '.join(FAMILIES)}")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--count", type=int, default=100, metavar="N")
    parser.add_argument("--method", action="append", choices=METHODS)
    parser.add_argument("--brief", action="store_true", help="the failures without the scenes' values")
    options = parser.parse_args()
    for family in options.families:
        if family not in FAMILIES:
            parser.error(f"unknown family {family!r} (allowed: {', '.join(FAMILIES)})")
    opened = {shape: ContactFmu(fmu_file(name)) for shape, name in FMU.items()}
    failed = 0
    for family in options.families or FAMILIES:
        tally = collections.Counter()
        for seed in range(options.first, options.first + options.count):
            for method, lines in run_seed(family, seed, options.method or METHODS[:1], opened, options.brief):
                tally[f"{method} scenes"] += 1
                tally.update({line.partition(":")[0].split(" at ")[0] for line in lines})
        failed += sum(count for name, count in tally.items() if name.endswith("scenes"))
        print(f"{family}: {options.count} scenes, failed: {dict(tally) or 'none'}", flush=True)
    for fmu in opened.values():
        fmu.close()
    return 1 if failed else 0


def run_seed(family, seed, methods, opened, brief):
    scene = drawn(family, seed)
    try:
        right = expected(scene)
    except TooLong:
        print(f"{family} {seed}: the reference takes too long")
        return
    for method in methods:
        lines = failures(opened[scene.shape], scene.values, scene.stops, method, right, scene.leaves_open)
        if lines:
            print(f"{family} {seed} {method}: {'; '.join(lines)}")
            if not brief:
                print(f"    {FMU[scene.shape]} {scene.values} stops {scene.stops}", flush=True)
            yield method, lines


if __name__ == "__main__":
    sys.exit(main())
