"""Seeded random scenes: a ball fired at a finite cylinder that tumbles, free to fly or held at its centre."""

import numpy as np

from support.scenes.random_scenes import unit_vector

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
        "source.motion": "free",
        "source.radius": ball,
        "source.mass": float(10 ** random.uniform(-1, 1)),
        "source.center": (middle + start).tolist(),
        "source.initial_velocity": thrown.tolist(),
        "destination.motion": "fixed" if held else "free",
        "destination.rotation": "free",
        "destination.radius": radius,
        "destination.mass": float(10 ** random.uniform(-1, 1)),
        "destination.center": middle.tolist(),
        "destination.initial_velocity": velocity.tolist(),
        "destination.axis": (unit_vector(random) * random.uniform(0.5, 2)).tolist(),
        "destination.finite_length": True,
        "destination.ends": ends,
        "destination.length": length,
        "destination.initial_angular_velocity": (
            10 ** random.uniform(-0.5, 2.3) * unit_vector(random)
        ).tolist(),
        "gravity": gravity.tolist(),
        "contact.location": "outside",
        "contact.method": "penalty",
        "contact.penalty_factor": 1e6,
    }
