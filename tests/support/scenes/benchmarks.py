"""The four problems of the peers' comparison: configuration, end and position of the source at the end.

The references come from a quadruple-precision Taylor integrator checked by a second method; event_driven ends
within 1e-9 m of them (test_benchmarks.py).
"""

from math import sqrt
from typing import NamedTuple


class Benchmark(NamedTuple):
    fmu: str
    shape: str
    configuration: dict
    end: float
    position: tuple


BALL = {
    "source.radius": 0.1,
    "source.mass": 1.0,
    "source.motion": "free",
    "destination.radius": 0.5,
    "destination.motion": "fixed",
    "contact.penalty_factor": 1e6,
}
RUNNER = {
    "source.radius": 0.05,
    "source.mass": 0.1,
    "source.motion": "free",
    "source.initial_velocity": [0.0, 0.1, 0.0],
    "destination.radius": 0.5,
    "destination.motion": "fixed",
    "destination.axis": [0.0, 1.0, 0.0],
    "contact.location": "inside",
    "contact.method": "penalty_dynamic",
    "contact.penalty_factor": 1e7,
    "contact.viscous_penalty_factor": 50.0,
}
DASHPOT = {
    "contact.method": "penalty_dynamic",
    "contact.viscous_penalty_factor": 100.0,
    "contact.dashpot": "unclamped",
}
BENCHMARKS = {
    "P1": Benchmark(
        "SphereSphere",
        "sphere",
        {**BALL, "source.center": [0.0, 0.0, 1.1], "contact.method": "penalty"},
        5.0,
        (0.0, 0.0, 1.0124643381657108),
    ),
    "P2": Benchmark(
        "SphereSphere",
        "sphere",
        {**BALL, **DASHPOT, "source.center": [0.03, 0.04, 1.1]},
        1.5,
        (1.202543835278544, 1.603391780371392, -1.0316677437162367),
    ),
    "P3": Benchmark(
        "SphereCylinder",
        "cylinder",
        {**RUNNER, "source.center": [0.45 * sqrt(3) / 2, 0.0, -0.225]},
        2.0,
        (-0.32067707805009105, 0.2, -0.3156997135678965),
    ),
    "P3b": Benchmark(
        "SphereCylinder",
        "cylinder",
        {**RUNNER, "source.center": [0.44 * sqrt(3) / 2, 0.0, -0.22], "contact.dashpot": "unclamped"},
        2.0,
        (-0.32088206508892142, 0.2, -0.31549135647495175),
    ),
}
