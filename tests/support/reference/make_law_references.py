"""Writes bench/law_references.json: where the source of each problem of bench/problems.py's law_benchmarks is
at the end, by the reference of hertz.py.

PYTHONPATH=tests:scripts python -m support.reference.make_law_references [NAME ...]

Without names all of them; five minutes.
"""

import json
import sys

import numpy as np

from contact_fmus.bench.problems import LAW_REFERENCES, law_benchmarks
from support.reference import hertz

STILL = [0.0, 0.0, 0.0]
# Sliding on the cap and over the rim: finer steps would follow the rounding of positions, and be too many.
COARSER = dict.fromkeys(("P3 rim", "P3b rim"), np.longdouble("1e-14"))


def unit(vector):
    long = np.array(vector, np.longdouble)
    return long / np.sqrt(long @ long)


def pair_of(fmu, start):
    """The pair and its state at the start; the destination is fixed"""
    ball, other = np.longdouble(start["source.radius"]), np.longdouble(start.get("destination.radius", 0.0))
    inside = start.get("contact.location") == "inside"
    linear = start.get("contact.law") != "hertz"
    stiffness = start["contact.penalty_factor" if linear else "contact.hertz_stiffness"]
    damping = start.get("contact.viscous_penalty_factor" if linear else "contact.hunt_crossley_factor", 0.0)
    axis, capped = start.get("destination.axis"), start.get("destination.ends") == "capped"
    reach = ball if capped else other - ball if inside else other + ball
    pair = hertz.HertzPair(
        stiffness,
        0.0 if start["contact.method"] == "penalty" else damping,
        start.get("contact.dashpot", "non_adhesive"),
        reach,
        -1 if inside else 1,
        (start["source.mass"], np.inf),
        (0.0, 0.0, -9.81),
        unit(axis) if fmu == "SphereCylinder" else None,
        unit(axis) if fmu == "SpherePlane" else None,
        (other, start["destination.length"] / 2) if capped else None,
        linear=linear,
    )
    centers = [*start["source.center"], *start.get("destination.center", STILL)]
    return pair, [*centers, *start.get("source.initial_velocity", STILL), *STILL]


def main(names):
    made = json.loads(LAW_REFERENCES.read_text(encoding="utf-8"))
    for name in names or law_benchmarks():
        problem = law_benchmarks()[name]
        pair, start = pair_of(problem.fmu, problem.start)
        state, events = hertz.run(pair, start, problem.stop, tolerance=COARSER.get(name, hertz.TOLERANCE))
        made[name] = [float(x) for x in state[:3]]
        print(name, len(events), made[name], flush=True)
    ordered = {name: made[name] for name in law_benchmarks()}
    LAW_REFERENCES.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
