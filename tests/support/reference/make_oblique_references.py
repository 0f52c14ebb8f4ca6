"""Writes scripts/contact_fmus/stability/oblique_references.json, the atlas's oblique scenes and their ends
by the Taylor integrator in 40 digits, with how much these depend on the last digits of what is given:

    PYTHONPATH=tests .venv/bin/python -m support.reference.make_oblique_references     # some minutes
"""

import json
from concurrent.futures import ProcessPoolExecutor

from contact_fmus.stability.motions import FILE
from support.reference.make_references import reference_of
from support.scenes.wide_scenes import particular, wide_scene

WIDE = [number for number in range(60) if particular(number) not in ("far away", "source held")][:32]
FREE = {
    "source.radius": 0.125,
    "destination.radius": 0.5,
    "source.motion": "free",
    "destination.motion": "fixed",
    "contact.location": "outside",
    "contact.method": "penalty_dynamic",
    "contact.viscous_penalty_factor": 5.0,
    "contact.dashpot": "unclamped",
    "contact.penalty_factor": 1e6,
    "gravity": [0.0, 0.0, 0.0],
}
AXIS = {"sphere": {}, "cylinder": {"destination.axis": [0.6, 0.0, 0.8]}}
MISSES = (-1e-3, -1e-6, -1e-9, -1e-12, 1e-12, 1e-6)
ASIDE = (1e-12, 1e-9, 1e-6, 1e-3, 0.1)


def graze(shape, miss):
    """A straight pass; `miss` is the closest approach, negative where the bodies overlap"""
    start = {"source.center": [1.0, 0.625 + miss, 0.5], "source.initial_velocity": [-3.0, 0.0, 0.0]}
    if shape == "sphere":
        start["source.center"] = [1.0, 0.625 + miss, 0.0]
    axis = {"destination.axis": [0.0, 0.0, 1.0]} if shape == "cylinder" else {}
    return shape, FREE | axis | start, 1.0


def through(shape, aside):
    """A soft contact is passed, the middle left `aside`"""
    start = {"source.center": [aside, 0.9, 0.0], "source.initial_velocity": [0.0, -4.0, 0.0]}
    axis = {"destination.axis": [0.0, 0.0, 1.0]} if shape == "cylinder" else {}
    soft = {"contact.penalty_factor": 8.0, "contact.viscous_penalty_factor": 0.1}
    return shape, FREE | axis | start | soft, 0.75


def wide(number):
    return wide_scene(number)


TASKS = [
    *(("wide", wide, (number,)) for number in WIDE),
    *(("graze", graze, (shape, miss)) for shape in AXIS for miss in MISSES),
    *(("through", through, (shape, aside)) for shape in AXIS for aside in ASIDE),
]


def entry(task):
    name, make, which = task
    shape, values, end = make(*which)
    found = reference_of((make, which))
    keys = ("onsets", "steady", "displacement", "velocity", "contact.last_onset_time", "condition")
    kept = {key: found[key] for key in keys}
    title = particular(which[0]) if name == "wide" else f"{which[1]:g} m"
    return {"name": f"{name} {which[0]}, {title}", "shape": shape, "values": values, "end": end, **kept}


def main():
    with ProcessPoolExecutor(2) as pool:
        lines = ",\n".join(json.dumps(row) for row in pool.map(entry, TASKS))
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
