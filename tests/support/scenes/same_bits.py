"""Compares this build with another, bit by bit.

Runs N random scenes with every solver method, in one step and in several, and all scenarios, with the FMUs
of this build and with those in FOLDER, and compares all outputs at every communication point. Prints which
differ and in what, with the values that make each scene again. The status is 1 where any does.

    PYTHONPATH=scripts:tests .venv/bin/python -m support.scenes.same_bits FOLDER --count 2000
"""

import argparse
import os
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, fmu_file, repository
from contact_fmus.scenarios.experiment import RunError
from contact_fmus.scenarios.recording import record
from contact_fmus.scenarios.scenario import read_scenario
from support.checks import METHODS, start
from support.scenes.random_scenes import KINDS, random_scene
from support.scenes.scene_checks import FMU

FIRST = 1000  # seed; those below are the tests' own
STEPS = (1, 10, 37)


def main():
    parser = argparse.ArgumentParser(prog="python -m support.scenes.same_bits", description=__doc__)
    parser.add_argument("folder", type=Path, help="where the other build's FMUs are")
    parser.add_argument("--count", type=int, default=2000, metavar="N", help="random scenes (2000)")
    parser.add_argument("--first", type=int, default=FIRST, metavar="SEED", help=f"first seed ({FIRST})")
    options = parser.parse_args()
    if not list(options.folder.glob("*.fmu")):
        parser.error(f"{options.folder} holds no FMU")
    differ = compare_scenes(options) + compare_scenarios(options)
    return 1 if differ else 0


def compare_scenes(options):
    kinds = [(shape, kind) for shape, kinds in KINDS.items() for kind in kinds]
    differ, runs = Counter(), 0
    for shape, name in FMU.items():
        if not (options.folder / f"{name}.fmu").exists():
            print(f"{name}: not in the other build")
            continue
        with ContactFmu(fmu_file(name)) as ours, ContactFmu(options.folder / f"{name}.fmu") as theirs:
            shared = set(rows_of(ours)) & set(rows_of(theirs))  # a new choice brings outputs of its own
            outputs = sorted(row for row, causality in shared if causality != "parameter")
            for index in range(options.count):
                at, kind = kinds[index % len(kinds)]
                if at != shape:
                    continue
                seed = options.first + index // len(kinds)
                values, end = random_scene(shape, kind, seed)
                for method in METHODS:
                    runs += 1
                    case = (values, end, STEPS[seed % len(STEPS)], method)
                    found = first_difference(*(run(fmu, outputs, *case) for fmu in (ours, theirs)))
                    if found:
                        differ[f"{shape}, {kind}, {method}"] += 1
                        print(f"{name}, {kind}, seed {seed}, {method}: {found}", flush=True)
    print(f"{options.count} random scenes, {runs} runs: {sum(differ.values())} differ {dict(differ) or ''}")
    return sum(differ.values())


def rows_of(fmu):
    return {(one.name.partition("[")[0], one.causality) for one in fmu.description.modelVariables}


def run(fmu, outputs, values, end, steps, method):
    """Returns all outputs after each step. The text of a refusal ends the list."""
    start(fmu, values, 1e-9, method)
    told = []
    for k in range(steps):
        try:
            fmu.step(end * (k + 1) / steps - fmu.time)
        except FmuError as error:
            return [*told, {"refused": str(error)}]
        told.append({name: np.asarray(fmu[name]).tobytes() for name in outputs})
    return told


def first_difference(ours, theirs):
    for k, (a, b) in enumerate(zip(ours, theirs, strict=False)):
        names = [name for name in a.keys() | b.keys() if a.get(name) != b.get(name)]
        if names:
            return f"step {k + 1}: {', '.join(sorted(names))}"
    return None if len(ours) == len(theirs) else "another number of steps"


def compare_scenarios(options):
    files = sorted((repository() / "scripts" / "scenarios").glob("*.toml"))
    own = os.environ.get("CONTACT_FMUS")
    differ = 0
    for file in files:
        scenario = read_scenario(file)
        for variant in scenario.variants:
            try:
                ours = record(scenario, variant)
                os.environ["CONTACT_FMUS"] = str(options.folder)
                theirs = record(scenario, variant)
            except RunError as error:
                differ += 1
                print(f"{scenario.name}: {error}")
                continue
            finally:
                os.environ.pop("CONTACT_FMUS", None)
                os.environ.update({"CONTACT_FMUS": own} if own else {})
            shared = ours.series.keys() & theirs.series.keys()
            names = [n for n in shared if ours.series[n].tobytes() != theirs.series[n].tobytes()]
            shared = ours.final.keys() & theirs.final.keys()
            names += [n for n in shared if np.any(ours.final[n] != theirs.final[n])]
            if names:
                differ += 1
                print(f"scenario {scenario.name} ({variant.label}): {', '.join(sorted(set(names)))}")
    print(f"{len(files)} scenarios: {differ} differ")
    return differ


if __name__ == "__main__":
    sys.exit(main())
