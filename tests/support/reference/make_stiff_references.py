"""Writes scripts/contact_fmus/bench/stiff_references.json, the references of the report's stiffness sweep:

    PYTHONPATH=tests .venv/bin/python -m support.reference.make_stiff_references    # some minutes

Damped to a tenth of the critical damping: Radau IIA (stiff_motion.py), any stiffness. Undamped: the Taylor
integrator as long as its steps can be counted out (1e9 N/m), beyond that an expansion in 1/p_n, the fast
oscillation included (stiff_motion.py). The uncertainty is a second run's, or a bound of the rest."""

import json
from concurrent.futures import ProcessPoolExecutor
from math import cos, sin, sqrt

import numpy as np

from contact_fmus.bench.problems import REFERENCES as FILE
from support.reference.integrator import Reference
from support.reference.stiff_motion import ANGLE, MASS, RADIUS, SPEED, StiffContact, damped_motion

END, DAMPING, COUNTABLE = 2.0, 0.1, 1e9
ROUNDING = 1e-14  # m, of the numbers themselves


def configuration(shape, penalty, damping):
    values = {"source.radius": 0.05, "source.mass": MASS, "source.motion": "free"}
    values |= {"source.center": [RADIUS * sin(ANGLE), 0.0, -RADIUS * cos(ANGLE)]}
    values |= {"source.initial_velocity": [0.0, SPEED, 0.0], "destination.radius": 0.5}
    values |= {"destination.motion": "fixed", "contact.location": "inside"}
    values |= {"contact.method": "penalty_dynamic" if damping else "penalty"}
    values |= {"contact.penalty_factor": penalty}
    if damping:
        values["contact.viscous_penalty_factor"] = 2 * damping * sqrt(MASS * penalty)
        values["contact.dashpot"] = "unclamped"
    if shape == "cylinder":
        values["destination.axis"] = [0.0, 1.0, 0.0]
    return values


def taylor(shape, penalty, damping, order):
    run = Reference(configuration(shape, penalty, damping), shape, order=order).run(END)
    return np.array([float(x) for x in run.position["source"]])


def expansion(shape, penalty):
    """(position, bound of what is left out), undamped"""
    end = StiffContact(configuration(shape, penalty, 0.0), shape).end(END)
    assert end.least_push > 0  # the contact lasts
    return end.position, end.left_out


def reference(shape, penalty, damping):
    """(position, uncertainty in m, method)"""
    if damping:
        coarse, _ = damped_motion(shape, penalty, damping, END, 1e-11)
        fine, least = damped_motion(shape, penalty, damping, END, 1e-12)
        assert least > 0  # the contact lasts
        return fine, np.linalg.norm(fine - coarse) + ROUNDING, "Radau IIA"
    if penalty <= COUNTABLE:
        coarse, fine = (taylor(shape, penalty, damping, order) for order in (24, 28))
        return fine, np.linalg.norm(fine - coarse) + ROUNDING, "Taylor series"
    return *expansion(shape, penalty), "expansion in 1/p_n"


def row(shape, damping, penalty):
    place, uncertainty, method = reference(shape, penalty, damping)
    values = {"shape": shape, "damping": damping, "penalty_factor": penalty}
    values |= {"position": [float(x) for x in place], "uncertainty": float(f"{uncertainty:.1e}")}
    values |= {"method": method}
    return values


def main():
    wanted = [
        (shape, damping, 10.0**exponent)
        for shape in ("cylinder", "sphere")
        for damping, exponents in ((DAMPING, range(5, 16)), (0.0, range(5, 12)))
        for exponent in exponents
    ]
    with ProcessPoolExecutor() as pool:
        rows = list(pool.map(row, *zip(*wanted, strict=True)))
    lines = ",\n".join("  " + json.dumps(one) for one in rows)
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
