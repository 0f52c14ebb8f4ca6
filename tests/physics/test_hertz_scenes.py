"""Random scenes of Hertz's law: event_driven and CVODE at its best tolerance, which share the law and nothing
of the integration, end in the same motion, and the energy balance closes.
"""

import random

import numpy as np
import pytest

from support.checks import check_close, run, start

COUNT = 80
MOTIONS = [("free", "fixed"), ("free", "free"), ("fixed", "free"), ("free", "prescribed")]


def vector(choose):
    return np.array([choose.gauss(0, 1) for _ in range(3)])


def law(choose):
    return {
        "contact.law": "hertz",
        "contact.hertz_stiffness": 10 ** choose.uniform(4, 9),
        "contact.method": choose.choice(["penalty", "penalty_dynamic", "penalty_dynamic"]),
        "contact.viscous_control": choose.choice(["user_defined", "restitution"]),
        "contact.restitution": choose.choice([0.02, choose.uniform(0.05, 1), 1.0]),
        "contact.hunt_crossley_factor": 10 ** choose.uniform(-3, 2),
        "contact.dashpot": choose.choice(["non_adhesive", "unclamped", "approach_only"]),
    }


def scene(seed):
    """The FMU, its values and the end: bodies that are near, touch or overlap a little."""
    choose = random.Random(seed)
    fmu, inside = choose.choice(["SphereSphere", "SphereCylinder"]), choose.random() < 0.5
    values = law(choose) | {
        "contact.location": "inside" if inside else "outside",
        "source.mass": 10 ** choose.uniform(-1, 1),
        "destination.mass": 10 ** choose.uniform(-1, 1),
        "gravity": [choose.uniform(-5, 5), choose.uniform(-5, 5), -9.81],
        "source.initial_velocity": (0.8 * vector(choose)).tolist(),
        "solver.absolute_tolerance": 1e-13,
    }
    values["source.motion"], values["destination.motion"] = choose.choice(MOTIONS)
    away, along = vector(choose), np.zeros(3)
    if fmu == "SphereCylinder":
        axis = vector(choose)
        axis /= np.linalg.norm(axis)
        away -= (away @ axis) * axis
        along = choose.uniform(-0.3, 0.3) * axis
        values |= {"destination.axis": axis.tolist(), "destination.finite_length": choose.random() < 0.3}
    gap = choose.choice([choose.uniform(0, 0.1), 0.0, -choose.uniform(0, 1e-3)])
    distance = 0.4 - gap if inside else 0.6 + gap
    values["source.center"] = (distance * away / np.linalg.norm(away) + along).tolist()
    if values["destination.motion"] == "prescribed":
        rate = (0.2 * vector(choose)).tolist()
        values["destination.prescribed_velocity"] = rate
        values["destination.prescribed_displacement.derivatives"] = [rate, [0.0, 0.0, 0.0]]
    return fmu, values, choose.uniform(0.05, 0.6)


def state(fmu):
    rows = [f"{body}.{row}" for body in ("source", "destination") for row in ("position", "velocity")]
    return np.concatenate([fmu[row] for row in rows] + [[fmu["energy.dissipated"]]])


@pytest.mark.parametrize("first", range(0, COUNT, 20))
def test_event_driven_and_cvode_end_in_the_same_motion(opened, first):
    for seed in range(first, first + 20):
        name, values, end = scene(seed)
        fmu = opened(name)
        expected = state(run(fmu, values, end, 3, 1e-12, "cvode_bdf"))
        total = start(fmu, values, 1e-10, "event_driven")["energy.total"]
        run(fmu, values, end, 3, 1e-10)
        check_close(f"scene {seed}", state(fmu), expected, 1e-8)
        scale = fmu["energy.kinetic"] + abs(total) + fmu["energy.dissipated"] + 1.0
        check_close(f"energy of scene {seed}", fmu["energy.total"], total, 1e-10 * scale)
