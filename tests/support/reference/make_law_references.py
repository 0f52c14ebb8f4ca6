"""Writes bench/law_references.json: where the source of each problem of bench/problems.py's law_starts is at
the end, by the reference of hertz.py.

PYTHONPATH=tests:scripts python -m support.reference.make_law_references
"""

import json

import numpy as np

from contact_fmus.bench.problems import LAW_REFERENCES, law_starts
from support.reference import hertz

STILL = [0.0, 0.0, 0.0]


def pair_of(fmu, start):
    """The pair and its state at the start; the destination is fixed"""
    ball, other = np.longdouble(start["source.radius"]), np.longdouble(start.get("destination.radius", 0.0))
    inside = start.get("contact.location") == "inside"
    linear = start.get("contact.law") != "hertz"
    stiffness = start["contact.penalty_factor" if linear else "contact.hertz_stiffness"]
    damping = start.get("contact.viscous_penalty_factor" if linear else "contact.hunt_crossley_factor", 0.0)
    axis = start.get("destination.axis")
    pair = hertz.HertzPair(
        stiffness,
        0.0 if start["contact.method"] == "penalty" else damping,
        start.get("contact.dashpot", "non_adhesive"),
        other - ball if inside else other + ball,
        -1 if inside else 1,
        (start["source.mass"], np.inf),
        (0.0, 0.0, -9.81),
        axis if fmu == "SphereCylinder" else None,
        axis if fmu == "SpherePlane" else None,
        linear=linear,
    )
    centers = [*start["source.center"], *start.get("destination.center", STILL)]
    return pair, [*centers, *start.get("source.initial_velocity", STILL), *STILL]


def main():
    made = {}
    for name, (_, fmu, stop, start) in law_starts().items():
        state, events = hertz.run(*pair_of(fmu, start), stop)
        made[name] = [float(x) for x in state[:3]]
        print(name, len(events), made[name], flush=True)
    LAW_REFERENCES.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
