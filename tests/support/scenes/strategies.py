"""What hypothesis chooses from: scenes of one or two contacts, with every law, dashpot, shape and motion."""

import os
from typing import NamedTuple

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from support.scenes.random_scenes import pair

RESULTS = ["contact.onsets", "contact.last_duration", "energy.dissipated", "contact.mean_force"]
VECTORS = {
    *(f"{body}.{row}" for body in ("source", "destination") for row in ("center", "initial_velocity",
        "initial_displacement")),
    "source.external_force", "destination.external_force", "destination.prescribed_velocity",
    "destination.axis", "gravity",
}  # fmt: skip
# Derandomized: the same examples each time, so that a failure is the code's and not the day's.
BOUNDED = settings(
    derandomize=True, deadline=None, max_examples=int(os.environ.get("CONTACT_SCENES", "40")), database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)  # fmt: skip
seeds = st.integers(0, 10**6)


class Scene(NamedTuple):
    shape: str
    configuration: dict
    end: float


def build(shape, location, law, dashpot, motion, seed):
    """A ball is thrown against another body, 0.03 m off, with little gravity. The seed gives the rest."""
    random = np.random.default_rng(seed)
    inside = location == "inside"
    values, outward = pair(random, shape, inside, 0.03)
    towards = outward if inside else -outward
    values |= {
        "destination.motion": motion, "destination.mass": random.uniform(0.5, 2),
        "source.initial_velocity": (towards + 0.2 * random.normal(size=3)).tolist(),
        "source.external_force": random.normal(size=3).tolist(),
        "contact.method": "penalty" if law == "penalty" else "penalty_dynamic",
        "contact.penalty_control": "viscous_only" if law == "viscous_only" else "user_defined",
        "contact.dashpot": dashpot, "contact.penalty_factor": 10 ** random.uniform(4, 5),
        "contact.viscous_penalty_factor": 10 ** random.uniform(0.5, 1.5),
        "gravity": (towards + 0.2 * random.normal(size=3)).tolist(),
    }  # fmt: skip
    if motion == "prescribed":
        values["destination.prescribed_velocity"] = (0.3 * random.normal(size=3)).tolist()
    if motion == "free":
        values["destination.initial_velocity"] = (0.3 * random.normal(size=3)).tolist()
    if shape == "cylinder":
        values |= {"destination.finite_length": bool(random.integers(2)), "destination.length": 2.0}
    return Scene(shape, values, 0.08)


def scenes(shapes=("sphere", "cylinder"), locations=("outside", "inside"), dashpots=None, motions=None):
    return st.builds(
        build,
        shape=st.sampled_from(list(shapes)),
        location=st.sampled_from(list(locations)),
        law=st.sampled_from(["penalty", "penalty_dynamic", "viscous_only"]),
        dashpot=st.sampled_from(list(dashpots or ["non_adhesive", "unclamped", "approach_only"])),
        motion=st.sampled_from(list(motions or ["fixed", "prescribed", "free"])),
        seed=seeds,
    )
