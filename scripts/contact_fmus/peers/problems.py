"""What a peer's module and the runner say to each other: prepare(problem, case) gives a Run; it is called anew for each
repeat, in a process of the peer's own.

The peer's packages are imported in prepare only, so that a missing one is found before anything breaks."""

from collections.abc import Callable
from math import pi, sqrt
from typing import NamedTuple

from contact_fmus.bench.problems import ISLANDS, benchmarks, stored_problems


class BallAndWall(NamedTuple):
    """A free ball and a fixed wall, SI units, gravity along -z: a solid sphere about the origin, or a hollow
    cylinder about the y axis."""

    name: str
    inside: bool  # the cylinder
    wall_radius: float
    radius: float
    mass: float
    stiffness: float  # p_n
    damping: float  # p_nv, of an unclamped dashpot
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    gravity: float
    end: float

    @property
    def touching_distance(self) -> float:
        """The distance of the ball's centre from the wall's centre or axis at the touch"""
        return self.wall_radius - self.radius if self.inside else self.wall_radius + self.radius

    @property
    def touching(self) -> bool:
        """At the start, to rounding"""
        x, y, z = self.position
        distance = sqrt(x * x + (0.0 if self.inside else y * y) + z * z)
        return abs(distance - self.touching_distance) < 1e-12

    @property
    def contact_time(self) -> float:
        """The duration of a short contact without damping, half a period of the ball on its spring"""
        return pi * sqrt(self.mass / self.stiffness)


class Cradle(NamedTuple):
    """Free balls in a row along x, which touch without a force; the first one moves. SI units, no gravity"""

    name: str
    balls: int
    radius: float
    mass: float
    stiffness: float
    power: float  # of the overlap in the force: 1, or 1.5 by Hertz's law
    speed: float
    end: float


class Case(NamedTuple):
    integrator: str
    setting: str  # what `parameter` is: step size in s or RELATIVE_TOLERANCE, and what else was chosen
    parameter: float
    law: str  # SAME or SIMILAR
    note: str = ""


class Run(NamedTuple):
    advance: Callable[[], object]  # from start to end; this alone is timed
    state: Callable[[], list[float]]  # position and velocity at the end
    onsets: Callable[[], int | None] = lambda: None  # contacts begun, where the peer can tell


def steps_of(end: float, size: float) -> tuple[int, float]:
    """The whole number of steps nearest to the size asked for, and their exact size"""
    count = max(1, round(end / size))
    return count, end / count


# The report's problems as a peer is given them, taken from what the FMU is given.

GRAVITY = 9.81  # the FMUs' start value


def problem_of(name: str) -> BallAndWall | Cradle:
    """P1, P2, P3 or P3b, a cradle; refuses what no peer's module here would notice"""
    if name not in benchmarks():
        cradle = stored_problems(ISLANDS)[name]
        start, hertz = cradle.start, cradle.start["touch[1].law"] == "hertz"
        stiffness = start["touch[1].hertz_stiffness" if hertz else "touch[1].penalty_factor"]
        ball = start["ball[1].radius"], start["ball[1].mass"]
        speed = start["ball[1].initial_velocity"][0]
        return Cradle(name, len(cradle.bodies), *ball, stiffness, 1.5 if hertz else 1.0, speed, cradle.stop)
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
