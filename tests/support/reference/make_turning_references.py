"""Makes the positions in scripts/contact_fmus/bench/turning_references.json anew, where the problems with
friction and rotation stand:

    PYTHONPATH=tests:scripts .venv/bin/python -m support.reference.make_turning_references    # some minutes

They come from turning_run.py at a tolerance of 1e-13; their uncertainty is what a run at 1e-12 differs by,
and rounding.
"""

import json
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from contact_fmus.bench.problems import TURNING as FILE
from support.reference.turning_run import TurningRun
from support.scenes.scene_checks import FMU

ROUNDING = 1e-13  # m, of the numbers themselves
SHAPES = {fmu: shape for shape, fmu in FMU.items()}


def follow(problem, relative):
    run = TurningRun(problem["start"], SHAPES[problem["fmu"]], relative=relative).run(problem["stop"])
    return run.figures()["source.position"], len(run.onset_times)


def made(problem):
    (position, onsets), (other, _) = (follow(problem, relative) for relative in (1e-13, 1e-12))
    found = {"onsets": onsets, "position": position.tolist()}
    found["uncertainty"] = float(np.linalg.norm(position - other)) + ROUNDING
    print(problem["name"], found, flush=True)
    return problem | found


def main():
    with ProcessPoolExecutor(2) as pool:
        lines = ",\n".join(map(json.dumps, pool.map(made, json.loads(FILE.read_text(encoding="utf-8")))))
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
