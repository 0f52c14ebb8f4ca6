"""Writes scripts/contact_fmus/bench/turning_references.json, the problems with friction and rotation:

    PYTHONPATH=tests:scripts .venv/bin/python -m support.reference.make_turning_references    # some minutes

The positions come from turning_run.py at a tolerance of 1e-13; their uncertainty is what a run at 1e-12
differs by, and rounding.
"""

import json
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from contact_fmus.bench.problems import TURNING as FILE
from support.reference.turning_run import TurningRun
from support.scenes.scene_checks import FMU
from support.scenes.turning_cases import ball, golfers_tube, rubbing

ROUNDING = 1e-13  # m, of the numbers themselves
PROBLEMS = {  # name -> title, shape, values, end
    "F1": (
        "impact with back-spin",
        "plane",
        ball(
            1e6,
            **{
                "source.center": [0.0, 0.0, 0.6],
                "source.initial_velocity": [1.0, 0.0, 0.0],
                "source.initial_angular_velocity": [0.0, -60.0, 10.0],
                **rubbing(1e-3, 0.3),
                "contact.method": "penalty_dynamic",
                "contact.viscous_penalty_factor": 60.0,
                "contact.dashpot": "unclamped",
            },
        ),
        2.0,
    ),
    "F2": (
        "rolling in a bowl",
        "sphere",
        ball(
            1e5,
            **{
                "destination.radius": 0.5,
                "source.center": [0.3, 0.1, -0.2449],
                "source.initial_angular_velocity": [3.0, 5.0, -8.0],
                **rubbing(1e-2, 0.5),
                "contact.location": "inside",
                "contact.method": "penalty_dynamic",
                "contact.viscous_penalty_factor": 100.0,
                "contact.dashpot": "unclamped",
            },
        ),
        10.0,
    ),
    "F3": ("golfer's tube", "cylinder", golfers_tube(1e-2).values, 1.5),
    "F4": (
        "tumbling cylinder hit by a ball",
        "cylinder",
        ball(
            1e6,
            **{
                "source.center": [0.25, -0.6, 0.1],
                "source.initial_velocity": [0.0, 2.0, 0.0],
                "destination.motion": "free",
                "destination.rotation": "free",
                "destination.radius": 0.15,
                "destination.mass": 2.0,
                "destination.finite_length": True,
                "destination.length": 1.2,
                "destination.axis": [1.0, 0.0, 0.3],
                "destination.initial_angular_velocity": [1.0, 0.5, -2.0],
                "gravity": [0.0, 0.0, 0.0],
                **rubbing(1e-3, 0.3),
                "contact.location": "outside",
            },
        ),
        1.0,
    ),
}


def follow(name, relative):
    _, shape, values, end = PROBLEMS[name]
    run = TurningRun(values, shape, relative=relative).run(end)
    return run.figures()["source.position"], len(run.onset_times)


def main():
    rows = []
    with ProcessPoolExecutor(2) as pool:
        jobs = {
            name: [pool.submit(follow, name, relative) for relative in (1e-13, 1e-12)] for name in PROBLEMS
        }
        for name, (title, shape, values, end) in PROBLEMS.items():
            (position, onsets), (other, _) = (job.result() for job in jobs[name])
            rows.append(
                {
                    "name": name,
                    "title": title,
                    "fmu": FMU[shape],
                    "stop": end,
                    "start": values,
                    "onsets": onsets,
                    "position": position.tolist(),
                    "uncertainty": float(np.linalg.norm(position - other)) + ROUNDING,
                    "method": "Dormand and Prince of order 8, at 1e-13",
                }
            )
            print(name, rows[-1]["position"], rows[-1]["uncertainty"], onsets, flush=True)
    FILE.write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
