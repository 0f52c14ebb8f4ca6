"""The report's problems as a peer is given them, taken from what the FMU is given."""

from __future__ import annotations

from math import sqrt

from contact_fmus.bench.problems import benchmarks

from .case import BallAndWall

GRAVITY = 9.81  # the FMUs' start value


def problem_of(name: str) -> BallAndWall:
    """P1, P2, P3 or P3b; refuses what no peer's module here would notice"""
    benchmark = benchmarks()[name]
    start = dict(benchmark.start)
    inside = benchmark.fmu == "SphereCylinder"
    if inside and (start.pop("destination.axis"), start.pop("contact.location")) != ([0, 1, 0], "inside"):
        raise ValueError(f"{name}: the peers know a hollow cylinder about the y axis only")
    dashpot = start.pop("contact.method") == "penalty_dynamic"
    if dashpot and start.pop("contact.dashpot") != "unclamped":
        raise ValueError(f"{name}: the peers are given an unclamped dashpot only")
    problem = BallAndWall(
        name=name,
        inside=inside,
        wall_radius=start.pop("destination.radius"),
        radius=start.pop("source.radius"),
        mass=start.pop("source.mass"),
        stiffness=start.pop("contact.penalty_factor"),
        damping=start.pop("contact.viscous_penalty_factor") if dashpot else 0.0,
        position=tuple(start.pop("source.center")),
        velocity=tuple(start.pop("source.initial_velocity", (0.0, 0.0, 0.0))),
        gravity=GRAVITY,
        end=benchmark.stop,
    )
    if start:
        raise ValueError(f"{name}: the peers are not given {', '.join(start)}")
    return problem


def error_of(name: str, position: list[float]) -> float:
    """Distance from the reference; not a number where the position is none"""
    reference = benchmarks()[name].position
    return sqrt(sum((a - b) ** 2 for a, b in zip(position, reference, strict=True)))
