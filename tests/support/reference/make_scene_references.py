"""Makes the positions in scripts/contact_fmus/bench/{turning,island,pair}_references.json anew:

    PYTHONPATH=tests:scripts .venv/bin/python -m support.reference.make_scene_references [NAME ...]

Without names all of them; some minutes. Those with friction and those of many contacts come from independent
code, those of the later pairs from event_driven. The uncertainty is what another run differs by, at ten
times the tolerance and for the pairs by CVODE, and rounding."""

import json
import sys
import tomllib

import numpy as np
from scipy.integrate import solve_ivp

from contact_fmus.bench.problems import ISLANDS, PAIRS, TURNING, Setting, stored_problems
from contact_fmus.fmu.host import run_host
from support.reference.chain import POWER, motion
from support.reference.turning import TurningRun
from support.scenes.scene_checks import FMU
from support.sources import ROOT

ROUNDING = 1e-13  # m, of the numbers themselves
SHAPES = {fmu: shape for shape, fmu in FMU.items()}
TIGHT = 1e-13
HUNT_CROSSLEY = 0.1  # s/m, the start value


def turning(problem, relative):
    run = TurningRun(problem.start, SHAPES[problem.fmu], relative=relative).run(problem.stop)
    return run.figures()["source.position"]


def cradle(problem, relative):
    """chain.py has the units of the mass, the stiffness and the speed"""
    balls, start, law = len(problem.bodies), problem.start, problem.start["touch[1].law"]
    speed, mass = start["ball[1].initial_velocity"][0], start["ball[1].mass"]
    stiffness = start["touch[1].hertz_stiffness" if law == "hertz" else "touch[1].penalty_factor"]
    length = (mass * speed**2 / stiffness) ** (1.0 / (1.0 + POWER[law]))
    came = length * motion(balls, law, problem.stop * speed / length, relative)[:balls]
    return np.column_stack([2.0 * start["ball[1].radius"] * np.arange(balls) + came, np.zeros((balls, 2))])


def bearing(problem, relative):
    """Nine balls and the inner race in their plane; the control of the error meets each corner of a force"""
    scene = tomllib.loads((ROOT / "modelDescription/scenes/BallBearing.toml").read_text())["start"]
    stiffness, damping = scene["on_inner[{i}].penalty_factor"], scene["on_inner[{i}].viscous_penalty_factor"]
    hertz = scene["on_inner[{i}].hertz_stiffness"] * (problem.start["on_inner[1].law"] == "hertz")
    begin = [[*scene[f"ball[{{i}}].{one}"], [0.0] * 3] for one in ("center", "initial_velocity")]
    mass = np.array([[scene["ball[{i}].mass"]]] * 9 + [[scene["inner.mass"]]])
    load = mass * [0.0, -9.81]
    load[9] += scene["inner.external_force"][::2]
    ball = scene["ball[{i}].radius"]
    races = ((True, 1.0, scene["inner.radius"] + ball), (False, -1.0, scene["outer.radius"] - ball))

    def rates(_, y):
        (place, velocity), force = y.reshape(2, 10, 2), load.copy()
        for free, side, reach in races:
            away, speed = place[:9] - free * place[9], velocity[:9] - free * velocity[9]
            distance = np.hypot(*away.T)
            n = side * away / distance[:, None]
            depth, closing = side * (reach - distance), -(speed * n).sum(1)
            normal = stiffness * depth + damping * closing
            if hertz:
                normal = hertz * np.maximum(depth, 0.0) ** 1.5 * (1.0 + HUNT_CROSSLEY * closing)
            push = np.where(depth > 0.0, np.maximum(normal, 0.0), 0.0)[:, None] * n
            force[:9] += push
            force[9] -= free * push.sum(0)
        return np.concatenate([velocity, force / mass]).ravel()

    tolerances = {"rtol": 10.0 * relative, "atol": 1e-2 * relative}
    run = solve_ivp(rates, (0.0, problem.stop), np.array(begin)[..., ::2].ravel(), "DOP853", **tolerances)
    x, z = run.y[:20, -1].reshape(10, 2).T
    return np.column_stack([x, np.zeros(10), z])


def by_fmu(problem, relative):
    """By event_driven, then by CVODE"""
    method = "event_driven" if relative == TIGHT else "cvode_bdf"
    (result,) = run_host([Setting(problem, method, relative, 1).case()])
    return result.outputs["source.position"]


DOP853 = "Dormand and Prince of order 8, at 1e-13"
BOTH = (by_fmu, "event_driven, and CVODE")
WAYS = dict.fromkeys(("CylinderCylinder", "CrossedRollers", "SphereTorus"), BOTH)
WAYS |= {"NewtonsCradle": (cradle, DOP853), "BallBearing": (bearing, DOP853.replace("13", "12"))}


def made(row, problem):
    way, method = WAYS.get(problem.fmu, (turning, DOP853))
    end, other = (np.ravel(way(problem, relative)) for relative in (TIGHT, 1e-12))
    uncertainty = float(np.linalg.norm(end - other)) + ROUNDING
    print(problem.name, uncertainty, flush=True)
    return row | {"position": end.tolist(), "uncertainty": uncertainty, "method": method}


def main(names):
    for file in (TURNING, ISLANDS, PAIRS):
        rows, problems = json.loads(file.read_text(encoding="utf-8")), stored_problems(file)
        wanted = names or problems
        rows = [made(row, problems[row["name"]]) if row["name"] in wanted else row for row in rows]
        file.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
