"""Balls that touch each other and two planes, in rows, rings, trees and heaps, against a reference.

CONTACT_SCENES=1000 runs a thousand of them.
"""

import numpy as np
import pytest

from support.checks import check_close, start
from support.reference.islands import Islands
from support.scenes.agreement import pick, seeds

END = 0.15  # s
AWAY = 1e4  # m, where balls are that a scene does not need
TOLERANCE = 1e-11


def places_of(random, kind, radii):
    """Centres of balls that touch or nearly do"""
    count = len(radii)
    if kind == "ring" and count > 2:
        radii[:] = radii[0]
        around = 2.0 * np.pi * np.arange(count) / count
        reach = radii[0] / np.sin(np.pi / count) * random.uniform(0.999, 1.01)
        return reach * np.array([np.cos(around), np.sin(around), np.zeros(count)]).T
    centres = [np.zeros(3)]
    while len(centres) < count:
        k = len(centres)
        on = k - 1 if kind == "row" else int(random.integers(k))
        way = random.normal(size=3) * (0.3 if kind == "row" else 1.0) + (kind == "row") * np.eye(3)[0]
        gap = pick(random, 0.1, 0.02) if kind == "heap" else pick(random, 0.0, -1e-4, 1e-3, 1e-2)
        new = centres[on] + way / np.linalg.norm(way) * (radii[on] + radii[k] + gap)
        apart = [np.linalg.norm(new - one) - r - radii[k] for one, r in zip(centres, radii, strict=False)]
        if all(far > 1e-3 for j, far in enumerate(apart) if j != on):
            centres.append(new)
    return np.array(centres)


def ball(random, radius, centre, turning, moves):
    turns = turning and random.random() < 0.8
    force = random.normal(size=3) if moves and random.random() < 0.2 else np.zeros(3)
    velocity = random.normal(size=3) * pick(random, 0.0, 0.3, 1.0) - 1.5 * centre * pick(random, 0.0, 1.0)
    return {
        "radius": radius,
        "mass": random.uniform(0.2, 3.0),
        "motion": "free" if moves else "fixed",
        "rotation": "free" if turns else "none",
        "center": centre,
        "velocity": velocity if moves else np.zeros(3),
        "spin": random.normal(size=3) * pick(random, 0.0, 5.0) if turns else np.zeros(3),
        "force": force,
    }


def contact(random, source, destination, turning):
    law = pick(random, "linear", "linear", "hertz")
    stiffness = 10.0 ** random.uniform(4.0, 7.0) * (20.0 if law == "hertz" else 0.3)
    damping = random.uniform(0.02, 0.5) if law == "hertz" else random.uniform(0.01, 0.6) * np.sqrt(stiffness)
    mu = random.uniform(0.05, 0.6)
    return {
        "source": source,
        "destination": destination,
        "law": law,
        "k": stiffness,
        "c": pick(random, 0.0, damping),
        "dashpot": pick(random, "non_adhesive", "unclamped", "approach_only"),
        "friction": pick(random, "none", "regularized", "elastic") if turning else "none",
        "mu": mu,
        "mu_static": mu * pick(random, 1.0, 1.3),
        "v_0": 10.0 ** random.uniform(-3.0, -1.0),
        "k_t": 10.0 ** random.uniform(3.0, 5.5),
        "c_t": 10.0 ** random.uniform(0.0, 2.0),
    }


def scene_of(seed):
    """Balls, planes, contacts, gravity"""
    random = np.random.default_rng(seed)
    count, turning = int(random.integers(2, 7)), random.random() < 0.6
    kind = pick(random, "row", "ring", "tree", "heap")
    radii = random.uniform(0.05, 0.15, count)
    centres = places_of(random, kind, radii)
    balls = [
        ball(random, radius, centre, turning, k == 0 or random.random() < 0.85)
        for k, (radius, centre) in enumerate(zip(radii, centres, strict=True))
    ]
    below, beside = (centres - radii[:, None]).min(axis=0)[[2, 0]]
    has_floor, has_wall = kind == "heap" or random.random() < 0.4, random.random() < 0.2
    tilted = np.array([1.0, 0.2, 0.1]) / np.linalg.norm([1.0, 0.2, 0.1])
    planes = [
        ((0.0, 0.0, 1.0), (0.0, 0.0, below - pick(random, 0.0, 1e-3, 0.05) if has_floor else -50.0)),
        (tuple(tilted), (beside - 0.1 if has_wall else -50.0, 0.0, 0.0)),
    ]
    pairs = [(i, j) for i in range(count) for j in (*range(i + 1, count), -1, -2)]
    gravity = (0.0, 0.0, -9.81 if has_floor else pick(random, 0.0, -1.0))
    return balls, planes, [contact(random, i, j, turning) for i, j in pairs], gravity


def values_of(balls, planes, contacts, gravity):
    """Start values of Islands.fmu"""
    values = {"gravity": list(gravity)}
    for plane, (normal, place) in zip(("floor", "wall"), planes, strict=True):
        values |= {f"{plane}.axis": list(normal), f"{plane}.center": list(place)}
    names = {"velocity": "initial_velocity", "force": "external_force", "spin": "initial_angular_velocity"}
    for k in range(1, 7):
        one = balls[k - 1] if k <= len(balls) else {"motion": "fixed", "center": (AWAY * k, AWAY, AWAY)}
        unused = {"velocity", "force"} if one["motion"] == "fixed" else set()
        unused |= {"spin"} if one.get("rotation") != "free" else set()
        for name, value in one.items():
            if name not in unused:
                plain = value.tolist() if isinstance(value, np.ndarray) else value
                values[f"ball[{k}].{names.get(name, name)}"] = plain
    for one in contacts:
        i, j = one["source"] + 1, one["destination"] + 1
        name = {0: f"land[{i}]", -1: f"side[{i}]"}.get(j, f"touch[{i},{j}]")
        hertz = one["law"] == "hertz"
        values |= {f"{name}.{key}": one[key] for key in ("law", "dashpot", "friction")}
        values |= {
            f"{name}.method": "penalty_dynamic" if one["c"] else "penalty",
            f"{name}.{'hertz_stiffness' if hertz else 'penalty_factor'}": one["k"],
            f"{name}.{'hunt_crossley_factor' if hertz else 'viscous_penalty_factor'}": one["c"],
            f"{name}.friction_coefficient": one["mu"],
            f"{name}.static_friction_coefficient": one["mu_static"],
            f"{name}.slip_velocity_control": "user_defined",
            f"{name}.characteristic_slip_velocity": one["v_0"],
            f"{name}.tangential_stiffness": one["k_t"],
            f"{name}.tangential_damping": one["c_t"],
        }
    return values


# In the last three a ball is far from the others: the rounding of its gaps must not loosen theirs.
@pytest.mark.parametrize("seed", [*seeds(8), 74, 386, 396])
def test_islands_move_as_in_the_reference(opened_several, seed):
    scene = scene_of(seed)
    fine, onsets = Islands(*scene).run(END, 1e-13)
    coarse, _ = Islands(*scene).run(END, 1e-12)
    fmu = opened_several("Islands")
    values = values_of(*scene)
    start(fmu, values, TOLERANCE)
    balls = range(1, len(scene[0]) + 1)
    energy = fmu["energy.total"]
    fmu.step(END)
    found = [
        [*fmu[f"ball[{k}].position"], *fmu[f"ball[{k}].velocity"], *fmu[f"ball[{k}].angular_velocity"]]
        for k in balls
    ]
    known = 10.0 * np.abs(coarse - fine).max()  # where motion multiplies errors, the reference does too
    check_close("motion", found, fine, max(1e-7, known))
    check_close("energy", fmu["energy.total"], energy, 1e-9 * max(1.0, abs(energy)))
    touched = [name for name in values if name.endswith(".law")]
    assert sum(fmu[name.replace(".law", ".onsets")] for name in touched) >= onsets
