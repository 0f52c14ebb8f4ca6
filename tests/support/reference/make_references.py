"""Makes the ends in wide_, overdamped_, variant_ and oblique_references.json anew, or in those named, by the
Taylor integrator in 40 digits, and how much they depend on the last digits of what is given. The scenes stand
there too. Wide are 200 random scenes: stiffness from 1e2 to 1e9 N/m, damping from none to twice the critical
one, far from the origin, growing forces, free destinations, bounce trains that settle, balls that slide along
a wall. In overdamped ones a ball creeps out of a stiff wall. Variants are ten of each of P1, P2, P3 and P3b.

    PYTHONPATH=tests:scripts python -m support.reference.make_references [FILE ...]       # some minutes
"""

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal
from pathlib import Path

import numpy as np

from contact_fmus.stability.motions import FILE as OBLIQUE
from support.reference.integrator import Reference

FOLDER = Path(__file__).parent
FILES = [FOLDER / f"{name}_references.json" for name in ("wide", "overdamped", "variant")] + [OBLIQUE]
ORDER = 30
NUDGE = 2.0**-30  # relative change of what is given, for the condition numbers
TRIES = 3
NUDGED = ["source.radius", "destination.radius", "source.mass", "destination.mass", "contact.penalty_factor"]
NUDGED += ["contact.viscous_penalty_factor", "contact.penalty_multiplier", "contact.characteristic_time"]
NUDGED += ["destination.length", "gravity", "destination.axis", "source.initial_velocity"]
NUDGED += ["destination.initial_velocity", "source.prescribed_velocity", "destination.prescribed_velocity"]
NUDGED += ["source.external_force", "destination.external_force"]


def outcome(reference):
    """Returns the compared numbers as floats: displacement and velocity of one body, then of the other."""
    lasting = reference.touching and reference.within
    ended = reference.durations[-1] if reference.durations else 0
    duration = reference.time - reference.onset_times[-1] if lasting else ended
    moved = [
        float(x - reference.number(start))
        for body, row in reference.position.items()
        for x, start in zip(row, reference.values[f"{body}.center"], strict=True)
    ]
    return {
        "displacement": moved, "velocity": [float(x) for row in reference.velocity.values() for x in row],
        "energy.contact": float(reference.stored_energy()), "energy.dissipated": float(reference.dissipated),
        "energy.external_work": float(reference.external_work),
        "contact.last_onset_time": float(reference.onset_times[-1]) if reference.onsets else 0.0,
        "contact.last_duration": float(duration), "impulse": [float(x) for x in reference.impulse],
    }  # fmt: skip


def nudged(values, random):
    """Moves every number a little, and the source by as much of the distance between the bodies."""
    result = dict(values)
    for name in NUDGED:
        if name in values:
            given = np.asarray(values[name], float)
            result[name] = (given * (1 + NUDGE * random.uniform(-1, 1, size=given.shape))).tolist()
    apart = np.subtract(values["source.center"], values.get("destination.center", [0.0] * 3))
    shift = NUDGE * np.linalg.norm(apart) * random.uniform(-1, 1, size=3)
    for row in ("initial", "prescribed"):
        name = f"source.{row}_displacement"
        result[name] = (np.array(values.get(name, [0.0] * 3)) + shift).tolist()
    return result


def distance(first, second):
    return float(np.max(np.abs(np.subtract(first, second))))


def made(row):
    """Returns the row, which has all or some of them, with the figures that follow from its scene."""
    values, shape, end = row["values"], row["shape"], row["end"]
    exact = Reference(values, shape, number=Decimal, order=ORDER).run(end)
    result = outcome(exact)
    plain = outcome(Reference(values, shape).run(end))
    condition, steady = dict.fromkeys(result, 0.0), True
    for attempt in range(TRIES):
        moved = Reference(nudged(values, np.random.default_rng(attempt)), shape).run(end)
        steady = steady and moved.onsets == exact.onsets
        changed = outcome(moved)
        for name in result:
            condition[name] = max(condition[name], distance(changed[name], plain[name]) / NUDGE)
    condition = {name: float(f"{c:.3g}") for name, c in condition.items()}
    counts = {"onsets": exact.onsets, "steady": steady, "steps": exact.steps}
    print(row["name"], counts, condition, flush=True)
    found = {**counts, **result, "condition": condition}
    return {key: found.get(key, value) for key, value in row.items()}


def main():
    with ProcessPoolExecutor() as pool:
        for file in [Path(name) for name in sys.argv[1:]] or FILES:
            rows = pool.map(made, json.loads(file.read_text(encoding="utf-8")))
            lines = ",\n".join(map(json.dumps, rows))
            file.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
