"""Seeded random scenes: a ball fired at a finite cylinder that tumbles, free to fly or held at its centre.
Onsets of one, run in one communication step, against reference/tumbling.py."""

import math

import numpy as np

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import start
from support.reference.tumbling import TumblingPair
from support.scenes.random_scenes import unit_vector

FIRST_TOUCH = 1e-9  # s
TOLERANCE = 1e-10
AFTER = 1e-7  # s after the first touch, where the FMU tells when it was; less than any contact lasts here

END = 10.0  # s, one communication step


def random_tumbling_scene(seed, ends="open"):
    """The ball comes near the cylinder after some seconds and up to hundreds of turns; most touch."""
    random = np.random.default_rng([154, seed])
    radius, length = random.uniform(0.05, 0.4), random.uniform(0.4, 3.0)
    ball = random.uniform(0.03, 0.3)
    held = bool(random.integers(2))
    gravity = 9.81 * unit_vector(random)
    arrival = random.uniform(0.5, 9.0)
    reach = 0.5 * length + radius + ball
    start = unit_vector(random) * reach * random.uniform(1.1, 6.0)
    aim = unit_vector(random) * random.uniform(0.0, 1.0) * reach
    middle = random.normal(size=3)
    velocity = random.normal(size=3) * (not held)
    # both fall alike unless the cylinder is held
    thrown = (aim - start) / arrival + velocity - 0.5 * gravity * arrival * held
    return {
        "source.motion": "free", "source.radius": ball, "source.mass": float(10 ** random.uniform(-1, 1)),
        "source.center": (middle + start).tolist(),
        "source.initial_velocity": thrown.tolist(), "destination.motion": "fixed" if held else "free",
        "destination.rotation": "free", "destination.radius": radius,
        "destination.mass": float(10 ** random.uniform(-1, 1)), "destination.center": middle.tolist(),
        "destination.initial_velocity": velocity.tolist(),
        "destination.axis": (unit_vector(random) * random.uniform(0.5, 2)).tolist(),
        "destination.finite_length": True, "destination.ends": ends, "destination.length": length,
        "destination.initial_angular_velocity": (10 ** random.uniform(-0.5,
            2.3) * unit_vector(random)).tolist(),
        "gravity": gravity.tolist(), "contact.location": "outside", "contact.method": "penalty",
        "contact.penalty_factor": 1e6,
    }  # fmt: skip


def first_onset(fmu, values, expected, method):
    """By a step that ends just after the expected one; inf where nothing has touched by then."""
    start(fmu, values, TOLERANCE, method)
    fmu.step(expected + AFTER)
    return fmu["contact.last_onset_time"] if fmu["contact.onsets"] else math.inf


def failures(fmu, seed, method="event_driven", ends="open"):
    """Lines on what is wrong, and how far off the first touch was [s]."""
    values = random_tumbling_scene(seed, ends)
    onsets = TumblingPair(values).run(END)
    try:
        start(fmu, values, TOLERANCE, method)
        fmu.step(END)
        count = fmu["contact.onsets"]
        off = abs(first_onset(fmu, values, onsets[0], method) - onsets[0]) if onsets else 0.0
    except FmuError as error:
        return [f"seed {seed}, {ends}: {error}"], 0.0
    lines = []
    if count != len(onsets):
        lines.append(f"seed {seed}, {ends}: {count} onsets, expected {len(onsets)}, at {onsets[:4]}")
    if not off <= FIRST_TOUCH:
        lines.append(f"seed {seed}, {ends}: first touch off by {off} s, at {onsets[0]}")
    return lines, off
