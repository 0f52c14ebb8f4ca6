"""What a scene of the atlas may be: the FMU's start values and the answer of the same motion, both from one
set of numbers
"""

import json
import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

from contact_fmus.fmu.variables import OPEN

from .line_motion import DIGITS, Line, damping_ratio, halved

# The answer that a run is held against

EPSILON = 2.0**-52
SLOW = 1e-6  # onsets slower than this part of the fastest motion are not counted on


@dataclass(frozen=True, kw_only=True)
class Expected:
    """The end of a run; defaults are those of one impact"""

    displacement: dict[str, Sequence[Any]]  # of the free bodies, in as many digits as it takes
    way: float  # what errors are measured by, m
    rounding: float = 0.0  # what the last digits of the numbers given leave open, m
    fastest: float  # m/s
    onsets: int = 1
    sure: bool = True  # whether rounding cannot change the number of onsets
    strong: int = 1  # onsets that nothing may miss
    last_onset: float | None
    onset_rounding: float = 0.0  # s
    through_middle: bool = False  # of a solid body, where the normal turns round
    turned: Any = None  # rad, the source about y; None where nothing is said of it


# What all motions have in common

PLANE = "plane"  # its normal is along z; it has an axis of its own and no radius


class Moving:
    """Defaults: a source of 1 kg meets a fixed destination, and nothing but the contact acts on the bodies. `geometry`
    is the destination's shape, and the side on which it is met."""

    geometry = "sphere outside"
    source_mass = 1.0
    destination_mass: float | None = None
    source_radius = destination_radius = 0.0
    stored_penalty = 0.0  # the stiffness of what is stored besides motion
    held = False  # whether neither body can move
    law = "undamped"
    restitution: float | None = None
    scale: float  # a length of the scene

    @property
    def shape(self) -> str:
        return self.geometry.partition(" ")[0]

    @property
    def inside(self) -> bool:
        return self.geometry.endswith("inside")

    @property
    def fmu(self) -> str:
        return OPEN[self.shape]

    @property
    def reach(self) -> float:
        """The distance of the source's centre from the destination's centre, axis or plane at the touch"""
        if self.shape == PLANE:
            return self.source_radius
        return self.destination_radius + self.source_radius * (-1 if self.inside else 1)

    @property
    def mass(self) -> mpf:
        """The reduced one, of both bodies"""
        source = mpf(self.source_mass)
        return source if self.destination_mass is None else 1 / (1 / source + 1 / mpf(self.destination_mass))

    def masses(self) -> tuple[float, float | None]:
        """The second where the destination is free"""
        return self.source_mass, self.destination_mass

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        """What gravity and the external force have passed to a body"""
        return np.zeros(3)

    def passive(self) -> bool:
        """Whether nothing but gravity gives energy"""
        return True

    def swings(self, time: float) -> float:
        """Radians of slow motion that an integrator has to follow"""
        return 0.0

    def bodies(self, center: Sequence[float], velocity: Sequence[float], gravity: float = 0.0) -> dict[str, Any]:
        """Start values of the source, of the destination's radius and axis, and of gravity"""
        values = {
            "source.radius": self.source_radius,
            "source.mass": self.source_mass,
            "source.center": list(center),
            "source.initial_velocity": list(velocity),
            "gravity": [0.0, 0.0, 0.0 - gravity],
        }
        if self.shape != PLANE:
            values["destination.radius"] = self.destination_radius
        if self.shape != "sphere":
            values["destination.axis"] = [0.0, 0.0, 1.0] if self.shape == PLANE else [0.0, 1.0, 0.0]
        if self.destination_mass is not None:
            values |= {"destination.motion": "free", "destination.mass": self.destination_mass}
        return values

    def dashpot_values(self, kind: str, factor: dict[str, float]) -> dict[str, Any]:
        """Start values of the dashpot, by its factor or a coefficient of restitution"""
        if self.law == "undamped":
            return {"contact.method": "penalty"}
        if self.restitution is not None:
            factor = {"contact.viscous_control": "restitution", "contact.restitution": self.restitution}
        return {"contact.dashpot": kind} | factor


# Head-on scenes: the FMU's start values and the closed form of the same motion, from one set of numbers.
#
# Bodies meet along z; a cylinder lies along y, so that motion along y is free of the contact. The source
# comes from +z outside and goes to -z inside a hollow destination, where gravity and the push point too.

GEOMETRIES = ("sphere outside", "sphere inside", "cylinder outside", "cylinder inside")
LAWS = ("undamped", "non_adhesive", "unclamped", "approach_only", "viscous_only")


@dataclass(frozen=True)
class Straight(Moving):
    """SI units. `source_mass` meets a fixed destination, or a free one of `destination_mass`, head-on."""

    geometry: str = "sphere outside"
    law: str = "non_adhesive"
    source_radius: float = 0.125
    destination_radius: float = 0.5
    gap: float = 0.125
    speed: float = 1.0  # towards the contact
    source_mass: float = 1.0
    destination_mass: float | None = None
    restitution: float | None = None  # in place of other numbers of the dashpot
    end: float = 0.0  # 0: as long as a first contact and a flight as long as that before it

    @property
    def start_place(self) -> float:
        """Where the gap puts the source along z"""
        return -(self.reach - self.gap) if self.inside else self.reach + self.gap

    @property
    def exact_reach(self) -> mpf:
        destination = mpf(0 if self.shape == PLANE else self.destination_radius)
        return destination + mpf(self.source_radius) * (-1 if self.inside else 1)


@dataclass(frozen=True)
class HeadOn(Straight):
    """By the linear law; without `damping` the dashpot has `ratio` of the critical damping."""

    dashpot: str = "non_adhesive"  # of viscous_only
    penalty: float = 1e6
    ratio: float = 0.2
    damping: float | None = None
    gravity: float = 9.81
    force: float = 0.0  # on the source, into the contact
    offset: float = 0.0  # of both bodies, in all directions
    place: float | None = None  # along z, instead of the gap
    length: float | None = None  # of a finite cylinder
    along: float = 0.0  # where the source starts along the cylinder's axis
    along_speed: float = 0.0
    prescribed: bool = False  # the destination is, and jumps

    @property
    def stored_penalty(self) -> float:
        return 0.0 if self.law == "viscous_only" else self.penalty

    @property
    def dashpot_factor(self) -> float:
        if self.law == "undamped":
            return 0.0
        if self.damping is not None:
            return self.damping
        if self.restitution is not None:
            return float(self._restitution_factor())
        return 2 * self.ratio * math.sqrt(self.penalty * float(self.mass))

    @property
    def kind(self) -> str:
        return {"undamped": "unclamped", "viscous_only": self.dashpot}.get(self.law, self.law)

    def source_center(self) -> list[float]:
        place = self.start_place if self.place is None else self.place
        return [self.offset, self.offset + self.along, self.offset + place]

    def configuration(self) -> dict[str, Any]:
        values = self.bodies(self.source_center(), [0.0, self.along_speed, -self.speed], self.gravity)
        values |= {"destination.center": [self.offset] * 3, "source.external_force": [0.0, 0.0, -self.force]}
        if self.geometry != PLANE:
            values["contact.location"] = "inside" if self.inside else "outside"
        if self.prescribed:
            values["destination.motion"] = "prescribed"
        if self.length is not None:
            values |= {"destination.finite_length": True, "destination.length": self.length}
        if self.law == "viscous_only":
            values["contact.penalty_control"] = "viscous_only"
        else:
            values["contact.penalty_factor"] = self.penalty
        factor = {} if self.restitution is not None else {"contact.viscous_penalty_factor": self.dashpot_factor}
        return values | self.dashpot_values(self.kind, factor)

    def _restitution_factor(self) -> mpf:
        with mp.workdps(DIGITS):
            return 2 * damping_ratio(self.restitution, self.kind) * mp.sqrt(mpf(self.penalty) * self.mass)

    def line(self) -> Line:
        """The closed form, from the very numbers that the FMU is given"""
        with mp.workdps(DIGITS):
            free = self.destination_mass is not None
            damped = self.restitution is not None and self.law != "undamped"
            return Line(
                inside=self.inside,
                flat=self.geometry == PLANE,
                reach=self.exact_reach,
                mass=self.mass,
                stiffness=mpf(self.stored_penalty),
                damping=self._restitution_factor() if damped else mpf(self.dashpot_factor),
                dashpot=self.kind,
                push=-mpf(self.force) / mpf(self.source_mass) - (mpf(0) if free else mpf(self.gravity)),
                place=mpf(self.source_center()[2]) - mpf(self.offset),
                speed=-mpf(self.speed),
                **self._ends(),
            )

    def _ends(self) -> dict[str, Any]:
        """When the source passes the ends of a finite cylinder"""
        if self.length is None:
            return {}
        start, half = mpf(self.source_center()[1]) - mpf(self.offset), mpf(self.length) / 2
        times = ()
        if self.along_speed:
            times = ((side * half - start) / mpf(self.along_speed) for side in (1, -1))
        return {"within": abs(start) <= half, "ends": tuple(t for t in times if t > 0)}

    def flight_time(self) -> float:
        """The time to the first touch, about"""
        pull = self.gravity * (self.destination_mass is None) + self.force / self.source_mass
        gap = max(self.gap, 0.0)
        if pull == 0 and self.speed == 0:
            return 0.0
        return 2 * gap / (self.speed + math.sqrt(self.speed**2 + 2 * pull * gap))

    def contact_time(self) -> float:
        return math.pi * math.sqrt(float(self.mass) / self.penalty)

    @property
    def scale(self) -> float:
        return max(min(self.gap or self.reach, self.reach), 1e-5 * self.destination_radius)

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        source = body == "source"
        mass = self.source_mass if source else self.destination_mass
        return np.array([0.0, 0.0, -(mass * self.gravity + self.force * source) * time])

    def passive(self) -> bool:
        """Whether nothing but gravity gives energy; a finite cylinder's end may"""
        return self.force == 0 and not self.prescribed and self.length is None

    def swings(self, time: float) -> float:
        """Radians of the pendulum that a ball pressed into a hollow body is"""
        pull = self.gravity * (self.destination_mass is None) + self.force / self.source_mass
        return time * math.sqrt(abs(pull) / self.reach) if self.inside else 0.0

    def expected(self, jumps: Sequence[tuple[float, float]] = ()) -> Expected:
        """`jumps`: times, and where the destination is from then on"""
        line, shift = self.line(), 0.0
        for time, place in jumps:
            line.run(time)
            line.moved(shift - place)
            shift = place
        line.run(self.end)
        with mp.workdps(DIGITS):
            along = mpf(self.along_speed) * mpf(self.end)
            moved = {body: [mpf(0), mpf(0), u] for body, u in self._along_z(line).items()}
            moved["source"][1] = along
            largest = max(float(abs(u[2])) for u in moved.values())
        fastest = float(line.fastest)
        way = max(largest, fastest * self.end, float(line.deepest))
        apart = largest if self.destination_mass is not None else 0.0  # both may have gone far together
        resolution = EPSILON * (float(line.reach) + apart)
        vanishing = line.touching and line.depth() < 1e3 * resolution
        slowest = min((float(v) for v in line.onset_speeds), default=math.inf)
        return Expected(
            displacement=moved,
            way=way,
            rounding=4 * resolution * (len(line.onset_times) + 1) + 4 * EPSILON * abs(float(along)),
            fastest=fastest,
            onsets=len(line.onset_times),
            sure=slowest > SLOW * fastest + 1e3 * resolution / self.end
            and line.closest_end > 1e3 * EPSILON * way
            and not vanishing,
            strong=sum(float(v) > 1e-3 * fastest for v in line.onset_speeds),
            last_onset=float(line.onset_times[-1]) if line.onset_times else None,
            onset_rounding=8 * resolution * len(line.onset_times) / slowest if slowest > 0 else 0.0,
            through_middle=line.through_middle,
        )

    def _along_z(self, line: Line) -> dict[str, mpf]:
        """Displacements from the relative motion and that of the centre of mass"""
        begin = mpf(self.source_center()[2]) - mpf(self.offset)
        if self.destination_mass is None:
            return {"source": line.place - begin}
        masses = mpf(self.source_mass), mpf(self.destination_mass)
        together = (-mpf(self.speed) * masses[0] - mpf(self.force) * line.time / 2) / sum(masses)
        middle = together * line.time - mpf(self.gravity) * line.time**2 / 2
        relative = (line.place - begin) / sum(masses)
        return {"source": middle + masses[1] * relative, "destination": middle - masses[0] * relative}

    def timed(self) -> Self:
        return self if self.end else replace(self, end=2.5 * self.flight_time() + 2.5 * self.contact_time())


# One free head-on impact by Hertz's law with the damping of Hunt and Crossley: the FMU's start values and
# the closed form of the same motion, up to one quadrature for its duration.
#
# With delta' = v and y = chi v, v dv / d delta = -(k/m) delta^(3/2) (1 + y) gives
#
#     (2/5) (k/m) delta^(5/2) = Q(v_0) - Q(v),   Q = v/chi - ln(1 + chi v)/chi^2, or v^2/2 without damping
#
# and the time follows from dt = -dv / ((k/m) delta^(3/2) (1 + y)). The approach-only dashpot has no damping
# on the way back. Bodies lie along z as those of HeadOn.

IMPACT_GEOMETRIES = (*GEOMETRIES, PLANE)
POISSON = 0.3
LEAST = 1e-3  # smaller coefficients of restitution count as this


@dataclass(frozen=True)
class Impact(Straight):
    """k_h by the modulus of both bodies, or `stiffness`; chi by `restitution`, or as chi v. The law is the dashpot."""

    modulus: float | None = None
    stiffness: float = 1e8
    damped: float = 0.0

    @property
    def scale(self) -> float:
        return min(self.gap, self.reach)

    def configuration(self) -> dict[str, Any]:
        values = self.bodies([0.0, 0.0, self.start_place], [0.0, 0.0, -self.speed]) | {"contact.law": "hertz"}
        if self.shape != PLANE:
            values["contact.location"] = "inside" if self.inside else "outside"
        factor = {"contact.hunt_crossley_factor": self.damped / self.speed}
        values |= self.dashpot_values(self.law, factor)
        if self.modulus is None:
            return values | {"contact.hertz_stiffness": self.stiffness}
        for body in ("source", "destination"):
            values |= {f"{body}.youngs_modulus": self.modulus, f"{body}.poissons_ratio": POISSON}
        return values | {"contact.penalty_control": "automatic"}

    # The closed form

    @cached_property
    def factor(self) -> mpf:
        """k_h"""
        if self.modulus is None:
            return mpf(self.stiffness)
        with mp.workdps(DIGITS):
            modulus = mpf(self.modulus) / (2 * (1 - mpf(POISSON) ** 2))
            along = 1 / (2 * mpf(self.source_radius))
            other = mpf(self.destination_radius) * (-1 if self.inside else 1)
            curved = along + 1 / (2 * other)
            if self.shape != "cylinder":
                return 4 * modulus / (3 * mp.sqrt(2 * (along if self.shape == "plane" else curved)))
            return elliptic_stiffness(modulus, min(along, curved), max(along, curved))

    @cached_property
    def damping(self) -> mpf:
        """chi v_0"""
        if self.law == "undamped" or self.restitution == 1.0:
            return mpf(0)
        return mpf(self.damped) if self.restitution is None else damping_of(self.restitution, self.law)

    @cached_property
    def impact(self) -> tuple[mpf, mpf, mpf]:
        """Duration, relative speed after it, depth"""
        with mp.workdps(DIGITS):
            speed, duration, after, depth = mpf(self.speed), *free_impact(self.damping, self.law)
            unit = (speed**2 / (self.factor / self.mass)) ** (mpf(2) / 5)
            return duration * unit / speed, after * speed, depth * unit

    def timed(self) -> Self:
        return self if self.end else replace(self, end=2 * self.gap / self.speed + float(self.impact[0]))

    def expected(self) -> Expected:
        with mp.workdps(DIGITS):
            duration, after, depth = self.impact
            speed, end = mpf(self.speed), mpf(self.end)
            touch = (mpf(self.start_place) - (-self.exact_reach if self.inside else self.exact_reach)) / speed
            if end < touch + duration:
                raise ValueError("the end is within the impact")
            # the bodies' distance at the end, over what it would be without contact
            gained = (speed + after) * (end - touch) - after * duration
            share = self.mass / mpf(self.source_mass)
            moved = {"source": [mpf(0), mpf(0), share * gained - speed * end]}
            if self.destination_mass is not None:
                share = self.mass / mpf(self.destination_mass)
                moved["destination"] = [mpf(0), mpf(0), -share * gained]
        way = max(self.speed * self.end, float(depth))
        resolution = EPSILON * (self.reach + max(float(abs(u[2])) for u in moved.values()))
        return Expected(
            displacement=moved,
            way=way,
            rounding=8 * resolution,
            fastest=self.speed,
            last_onset=float(touch),
            onset_rounding=8 * resolution / self.speed,
        )


def elliptic_stiffness(modulus: mpf, a: mpf, b: mpf) -> mpf:
    """K. L. Johnson, Contact Mechanics, 4.2: with K, E of the eccentricity e and the larger half axis h,
    A, B = 3 F/(2 pi E* h^3) times (K - E)/e^2 and (E/(1 - e^2) - K)/e^2; depth = 3 F K/(2 pi E* h)."""

    def parts(m: mpf) -> tuple[mpf, mpf, mpf]:
        k, e = mp.ellipk(m), mp.ellipe(m)
        return k, (k - e) / m, (e / (1 - m) - k) / m

    def wanted(m: mpf) -> mpf:
        _, first, second = parts(m)
        return first / second - a / b

    m = mp.findroot(wanted, (mpf("1e-9"), 1 - mpf("1e-12")), solver="anderson")
    k, first, _ = parts(m)
    return 2 * mp.pi * modulus / 3 * mp.sqrt(first / (a * k**3))


def damping_of(restitution: float, law: str) -> mpf:
    """chi v_0 by its coefficient of restitution (the module's integral from v_0 to -e v_0)"""
    with mp.workdps(DIGITS):
        e = mpf(max(restitution, LEAST))
        if law == "approach_only":
            return halved(lambda y: 2 * (y - mp.log(1 + y)) / y**2 > e**2, mpf("1e-20"), 2 / e**2)
        highest = (1 - mpf("1e-20")) / e
        return halved(lambda y: mp.log((1 + y) / (1 - e * y)) < y * (1 + e), mpf("1e-20"), highest)


@cache
def free_impact(damped: mpf, law: str) -> tuple[mpf, mpf, mpf]:
    """Duration, speed after it, depth, for k_h, mass and speed of 1. The variable is L = -ln(1 + y):
    (2/5) delta^(5/2) = (1 + 1/y - exp(-L)/y)/y - (ln(1 + y) + L)/y^2, dt = dL/(y delta^(3/2))."""
    half = mpf("0.5")
    if damped == 0:
        return 2 * _time_without_damping(half), mpf(1), (mpf(5) / 2 * half) ** (mpf(2) / 5)
    y, begin = damped, -mp.log(1 + damped)

    def energy(turned: mpf) -> mpf:
        return (1 + (1 - mp.exp(-turned)) / y) / y - (turned - begin) / y**2

    def pace(turned: mpf) -> mpf:
        left = energy(turned)
        return 1 / (y * (mpf(5) / 2 * left) ** (mpf(3) / 5)) if left > 0 else mpf(0)

    deepest = energy(mpf(0))
    depth = (mpf(5) / 2 * deepest) ** (mpf(2) / 5)
    forth = mp.quad(pace, [begin, 0])
    if law == "approach_only":
        return forth + _time_without_damping(deepest), mp.sqrt(2 * deepest), depth
    last = halved(lambda turned: energy(turned) > 0, mpf(0), 1 + y - begin)
    back = mp.quad(pace, [0, last / 2, last])
    return forth + back, (1 - mp.exp(-last)) / y, depth


def _time_without_damping(energy: mpf) -> mpf:
    """The time to rise from the deepest place is sqrt(pi) Gamma(7/5)/Gamma(9/10) of depth / speed."""
    depth = (mpf(5) / 2 * energy) ** (mpf(2) / 5)
    factor = mp.sqrt(mp.pi) * mp.gamma(mpf(7) / 5) / mp.gamma(mpf(9) / 10)
    return factor * depth / mp.sqrt(2 * energy)


# A ball that flies at the rim of a capped cylinder: the FMU's start values and the same motion from touch to
# release by DOP853 (scipy), with flight in closed form before and after.
#
# All happens in the plane of the axis, y, and of the way outward, x. About the point of the rim that lies in
# it the force is central: with the distance r, delta = r_s - r and the angular momentum h by mass,
#
#     delta'' = -h^2/r^3 - F(delta, delta')/m,   angle' = h/r^2,
#
# in units of the speed into the contact and of the oscillation's rate. A ball that comes down on the cap or
# the side itself does so head-on: h = 0.

ACCURACY = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
TURN = math.pi / 2


class Bounce(NamedTuple):
    """The contact in units: its duration, the rate of delta at its end, the angle turned, and delta there"""

    duration: float
    rate: float
    turned: float
    depth: float


@dataclass(frozen=True)
class Edge(Moving):
    """SI units. The ball flies towards the rim at `angle` from the way inward: 0 across the side, pi/2 down
    on the cap. Its centre's path passes the rim's point at the distance `offset`: beyond the face that it
    would meet if positive, else over the face."""

    law: str = "non_adhesive"  # the dashpot, or undamped
    hertz: bool = False
    angle: float = TURN
    offset: float = 0.0
    source_radius: float = 0.125
    destination_radius: float = 0.5
    length: float = 1.0
    gap: float = 0.125
    speed: float = 1.0
    source_mass: float = 1.0
    depth: float = 1e-3  # of an impact without damping, over the ball's radius; decides the stiffness
    ratio: float = 0.2  # of critical damping; chi times the speed under Hertz's law
    end: float = 0.0  # 0: as long after the impact as before it

    geometry = "capped cylinder"
    scale = property(attrgetter("gap"))
    shape = "cylinder"

    @property
    def stiffness(self) -> float:
        deep = self.depth * self.source_radius
        if self.hertz:
            return 1.25 * self.source_mass * self.speed**2 / deep**2.5
        return self.source_mass * (self.speed / deep) ** 2

    @property
    def stored_penalty(self) -> float:
        return 0.0 if self.hertz else self.stiffness

    @property
    def damping(self) -> float:
        """p_nv, or chi"""
        if self.law == "undamped":
            return 0.0
        if self.hertz:
            return self.ratio / self.speed
        return 2 * self.ratio * math.sqrt(self.stiffness * self.source_mass)

    def towards(self) -> np.ndarray:
        if self.angle == TURN:
            return np.array([0.0, -1.0])
        return np.array([-math.cos(self.angle), -math.sin(self.angle)])

    def aside(self) -> np.ndarray:
        """Across the way, away from the face that the ball would meet head-on"""
        x, y = self.towards()
        return np.array([-y, x]) if self.angle > TURN / 2 else np.array([y, -x])

    def corner(self) -> np.ndarray:
        return np.array([self.destination_radius, self.length / 2])

    def reach(self) -> float:
        """How far before the point nearest to the rim the ball touches; nan: it passes"""
        if self.on_face:
            return self.source_radius
        left = (self.source_radius - self.offset) * (self.source_radius + self.offset)
        return math.sqrt(left) if left > 0 else math.nan

    @property
    def on_face(self) -> bool:
        return self.offset <= 0 and self.angle in (0.0, TURN)

    def begin(self) -> np.ndarray:
        """The place of the ball's centre at the start, in the plane"""
        back = self.source_radius + self.gap
        return self.corner() + self.offset * self.aside() - back * self.towards()

    def configuration(self) -> dict[str, Any]:
        begin, velocity = self.begin(), self.speed * self.towards()
        values = self.bodies([*begin, 0.0], [*velocity, 0.0]) | {
            "destination.finite_length": True,
            "destination.length": self.length,
            "destination.ends": "capped",
        }
        if self.hertz:
            values |= {"contact.law": "hertz", "contact.hertz_stiffness": self.stiffness}
        else:
            values |= {"contact.penalty_factor": self.stiffness}
        factor = "contact.hunt_crossley_factor" if self.hertz else "contact.viscous_penalty_factor"
        return values | self.dashpot_values(self.law, {factor: self.damping})

    def timed(self) -> Self:
        lasts = math.pi * self.depth * self.source_radius / self.speed
        near = (self.gap + self.source_radius) / self.speed
        return self if self.end else replace(self, end=2 * near + 4 * lasts)

    def expected(self) -> Expected:
        reach, way = self.reach(), self.speed * self.end
        if math.isnan(reach):
            place, touch = self.begin() + way * self.towards(), None
        else:
            touch = (self.source_radius + self.gap - reach) / self.speed
            place = self._after(reach, self.end - touch)
        moved = place - self.begin()
        resolution = EPSILON * (self.destination_radius + self.length + way)
        # a touch that is turned by its rounding, or that is a graze, throws the ball off elsewhere
        steep = 1.0 if math.isnan(reach) else self.source_radius / reach
        rounding = 8 * resolution * steep * (1 + way / self.source_radius)
        return Expected(
            displacement={"source": [*moved, 0.0]},
            way=max(way, float(np.linalg.norm(moved))),
            rounding=rounding + 1e-11 * way,  # of DOP853
            fastest=self.speed,
            onsets=int(touch is not None),
            strong=int(touch is not None),
            last_onset=touch,
            onset_rounding=8 * resolution * steep / self.speed,
        )

    def _after(self, reach: float, left: float) -> np.ndarray:
        """The place `left` seconds after the touch"""
        arm = self.offset * self.aside() * (not self.on_face) - reach * self.towards()
        normal = arm / self.source_radius
        into = -self.speed * float(normal @ self.towards())
        momentum = self.speed * (arm[0] * self.towards()[1] - arm[1] * self.towards()[0])
        unit = self.depth * self.source_radius
        time = unit / self.speed
        bounce = self._bounce(into / self.speed, momentum * time, unit)
        if bounce.duration * time > left:
            raise ValueError("the end is within the impact")
        c, s = math.cos(bounce.turned), math.sin(bounce.turned)
        normal = np.array([[c, -s], [s, c]]) @ normal
        along = np.array([-normal[1], normal[0]])
        if not self.on_face and min(normal) < 0:
            raise ValueError("the ball goes on over a face")
        apart = self.source_radius - bounce.depth * unit
        velocity = -bounce.rate * self.speed * normal + momentum / apart * along
        corner = self.corner() + self.offset * self.aside() * self.on_face
        return corner + apart * normal + (left - bounce.duration * time) * velocity

    def _bounce(self, into: float, momentum: float, unit: float) -> Bounce:
        """Lengths in `unit`, times in which the speed covers it"""
        radius = self.source_radius / unit
        spin = momentum / unit**2
        time, y = 0.0, np.array([0.0, into, 0.0])
        for force, ends in self._parts():

            def rates(_time: float, y: np.ndarray, force=force) -> list[float]:
                r = radius - y[0]
                return [y[1], -(spin**2) / r**3 - force(y[0], y[1]), spin / r**2]

            events = [lambda _t, y: y[0], lambda _t, y, ends=ends: ends(y[0], y[1])]
            for event in events:
                event.terminal, event.direction = True, -1.0
            found = solve_ivp(rates, (time, time + 50.0), y, events=events, max_step=0.1, first_step=1e-3, **ACCURACY)
            if found.status != 1:
                raise ArithmeticError("the bodies do not part")
            time, y = found.t[-1], found.y[:, -1]
            if found.t_events[0].size:
                return Bounce(time, y[1], y[2], 0.0)
        return Bounce(time, y[1], y[2], y[0])

    def _parts(self) -> list[tuple[Callable[[float, float], float], Callable[[float, float], float]]]:
        """The forces of the contact one after another, and what falls through zero where each ends"""
        c = 0.0 if self.law == "undamped" else self.ratio if self.hertz else 2 * self.ratio

        def spring(s: float, _v: float) -> float:
            return 1.25 * max(s, 0.0) ** 1.5 if self.hertz else s

        def full(s: float, v: float) -> float:
            return spring(s, v) * (1 + c * v) if self.hertz else s + c * v

        if self.law == "approach_only" and c > 0:
            return [(full, lambda s, v: v), (spring, lambda s, v: 1.0)]
        if self.law == "non_adhesive" and c > 0:
            pull = (lambda _s, v: 1 + c * v) if self.hertz else full
            return [(full, pull)]  # nothing acts from there on: it is free
        return [(full, lambda s, v: 1.0)]


# A ball that slides and then rolls on a plane, and a cylinder that tumbles into a ball: the FMU's start
# values and the closed form of the same motions.
#
# Rolling: under regularized friction and a constant normal force the slip s obeys s' = -r (1 - exp(-s/v_0))
# with r = (1 + 1/k) mu g and I = k m a^2, hence with A = exp(s_0/v_0) - 1
#
#     s = v_0 ln(1 + A exp(-r t/v_0)),  integral of s = (v_0^2/r) (Li_2(-A exp(-r t/v_0)) - Li_2(-A)),
#
# and the ball has lost (s_0 - s)/(1 + 1/k) of its speed; it turns at the rate (v - s)/a.
#
# Tumbling: an axis that turns in a plane with the rate w comes within r_s + r_d of a ball at the distance D
# from the middle of the cylinder when D cos(w t) = r_s + r_d.

G = 9.81
LONGEST = 10.0  # s
MOST_TURNS = 1000  # of a ball, each of which an integrator has to follow


@dataclass(frozen=True)
class Rolling(Moving):
    """SI units. A ball of 1 kg, in balance with its weight"""

    speed: float = 2.0
    spin: float = 0.0  # about y; back-spin is negative
    friction: float = 0.2
    slip_velocity: float = 1e-3
    inertia: float = 0.4  # over m a^2
    radius: float = 0.125
    penalty: float = 1e6
    end: float = 0.0  # 0: half as long again as it slides, ten seconds and so many turns at most

    geometry = "plane"
    scale = property(attrgetter("radius"))

    @property
    def slip(self) -> float:
        return self.speed - self.radius * self.spin

    @property
    def rate(self) -> float:
        """The rate of the slip while the ball slides, m/s^2"""
        return (1 + 1 / self.inertia) * self.friction * G

    def timed(self) -> Self:
        turns = 2 * math.pi * MOST_TURNS / abs(self.spin) if self.spin else math.inf
        return self if self.end else replace(self, end=min(1.5 * self.slip / self.rate, LONGEST, turns))

    def configuration(self) -> dict[str, Any]:
        return {
            "source.radius": self.radius,
            "source.center": [0.0, 0.0, self.radius - G / self.penalty],
            "source.initial_velocity": [self.speed, 0.0, 0.0],
            "source.rotation": "free",
            "source.inertia_control": "user_defined",
            "source.axial_inertia": self.inertia * self.radius**2,
            "source.initial_angular_velocity": [0.0, self.spin, 0.0],
            "contact.method": "penalty",
            "contact.penalty_factor": self.penalty,
            "contact.friction": "regularized",
            "contact.friction_coefficient": self.friction,
            "contact.slip_velocity_control": "user_defined",
            "contact.characteristic_slip_velocity": self.slip_velocity,
        }

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        return np.array([0.0, 0.0, -G * time if body == "source" else 0.0])

    def expected(self) -> Expected:
        with mp.workdps(DIGITS):
            small, slip, rate, end = map(mpf, (self.slip_velocity, self.slip, self.rate, self.end))
            begun = mp.expm1(slip / small)
            area = small**2 / rate * (_dilogarithm(begun * mp.exp(-rate * end / small)) - _dilogarithm(begun))
            way = mpf(self.speed) * end - (slip * end - area) / (1 + 1 / mpf(self.inertia))
            turned = (way - area) / mpf(self.radius)
        size = max(self.speed, self.slip) * self.end
        return Expected(
            displacement={"source": [way, mpf(0), mpf(0)]},
            way=size,
            rounding=16 * EPSILON * size,
            fastest=max(self.speed, self.slip),
            last_onset=0.0,
            turned=turned,
        )


def _dilogarithm(a: mpf) -> mpf:
    """Li_2(-a); large ones by its inversion, which does not need a itself"""
    if a <= 1:
        return mp.re(mp.polylog(2, -a))
    return -(mp.pi**2) / 6 - mp.log(a) ** 2 / 2 - mp.re(mp.polylog(2, -1 / a))


@dataclass(frozen=True)
class Tumbling(Moving):
    """SI units. A cylinder that turns about its fixed middle meets a fixed ball"""

    rate: float = 1.0  # rad/s
    law: str = "undamped"
    source_radius: float = 0.125
    destination_radius: float = 0.25
    away: float = 2.0  # of the ball, from the middle
    length: float = 6.0
    penalty: float = 0.0  # 0: an impact that lasts a thousandth of a radian
    end: float = 0.0  # 0: half as long again as until the touch

    geometry = "cylinder outside"
    scale = property(attrgetter("source_radius"))
    held = True

    @property
    def touch(self) -> float:
        return math.acos((self.source_radius + self.destination_radius) / self.away) / self.rate

    def timed(self) -> Self:
        return self if self.end else replace(self, end=1.5 * self.touch)

    def configuration(self) -> dict[str, Any]:
        across = (3 * self.destination_radius**2 + self.length**2) / 12
        penalty = self.penalty or across / self.away**2 * (math.pi * self.rate / 1e-3) ** 2
        return {
            "source.motion": "fixed",
            "source.radius": self.source_radius,
            "source.center": [self.away, 0.0, 0.0],
            "destination.motion": "fixed",
            "destination.rotation": "free",
            "destination.radius": self.destination_radius,
            "destination.finite_length": True,
            "destination.length": self.length,
            "destination.axis": [0.0, 0.0, 1.0],
            "destination.initial_angular_velocity": [0.0, self.rate, 0.0],
            "contact.location": "outside",
            "contact.method": "penalty",
            "contact.penalty_factor": penalty,
        }

    def swings(self, time: float) -> float:
        return self.rate * time

    def expected(self) -> Expected:
        touch = {"last_onset": self.touch, "onset_rounding": 16 * EPSILON * self.touch}
        still = {"source": [mpf(0)] * 3}
        return Expected(displacement=still, way=self.away, fastest=self.rate * self.away, **touch)


# Oblique scenes in other units: the same motion with lengths, masses and times multiplied by powers of two.
# Every number given to the FMU is then exactly that of the original but for its exponent, so the end is that
# of oblique_references.json, scaled, however extreme the units are.

FILE = Path(__file__).parent / "oblique_references.json"


class Units(NamedTuple):
    """Powers of two"""

    length: int = 0
    mass: int = 0
    time: int = 0

    def factor(self, length: int = 0, mass: int = 0, time: int = 0) -> float:
        return 2.0 ** (length * self.length + mass * self.mass + time * self.time)


UNCHANGED = Units()

# Dimensions of variables by the ends of their names, and start values of the FMUs
TABLE = tomllib.loads(Path(__file__).with_name("units.toml").read_text(encoding="utf-8"))


def dimension(name: str) -> tuple[int, int, int] | None:
    """None: free of units"""
    last = name.rsplit(".", 1)[-1]
    if last.endswith(tuple(TABLE["free"])):
        return None
    return TABLE["dimensions"][max((end for end in TABLE["dimensions"] if last.endswith(end)), key=len)]


@cache
def bases() -> list[dict[str, Any]]:
    return json.loads(FILE.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Similar(Moving):
    """A scene of oblique_references.json by its number, in other units"""

    number: int
    units: Units = UNCHANGED

    @property
    def base(self) -> dict[str, Any]:
        return bases()[self.number]

    @property
    def geometry(self) -> str:
        return f"{self.base['shape']} {self.base['values'].get('contact.location', '')}".strip()

    @property
    def law(self) -> str:
        values = self.base["values"]
        if values.get("contact.penalty_control") == "viscous_only":
            return "viscous_only"
        return "undamped" if values["contact.method"] == "penalty" else values["contact.dashpot"]

    @property
    def end(self) -> float:
        return self.base["end"] * self.units.factor(time=1)

    @property
    def scale(self) -> float:
        return 0.125 * self.units.factor(length=1)

    def configuration(self) -> dict[str, Any]:
        """All that has a unit is given, with "<input>.derivatives" as lists of first and second ones"""
        values = TABLE["start"] | self.base["values"]
        return {name: self._scaled(name, value) for name, value in values.items()}

    def _scaled(self, name: str, value: Any) -> Any:
        if name.endswith(".derivatives"):
            powers = dimension(name.removesuffix(".derivatives"))
            factors = [self.units.factor(*powers) * self.units.factor(time=-k) for k in (1, 2)]
            return [(f * np.array(row)).tolist() for f, row in zip(factors, value, strict=False)]
        powers = dimension(name)
        if powers is None:
            return value
        scaled = self.units.factor(*powers) * np.array(value, dtype=float)
        return scaled.tolist() if scaled.ndim else float(scaled)

    def masses(self) -> tuple[float, float | None]:
        values = self.configuration()
        free = values.get("destination.motion") == "free"
        return values["source.mass"], values["destination.mass"] if free else None

    def given_impulse(self, body: str, time: float) -> np.ndarray:
        values = self.configuration()
        rows = [values.get(f"{body}.external_force", [0.0] * 3)]
        rows += values.get(f"{body}.external_force.derivatives", [])
        impulse = values[f"{body}.mass"] * np.array(values["gravity"]) * time
        for order, (row, divisor) in enumerate(zip(rows, (1, 2, 6), strict=False)):
            impulse = impulse + np.array(row) * time ** (order + 1) / divisor
        return impulse

    def passive(self) -> bool:
        values = self.base["values"]
        moved = values.get("destination.motion") == "prescribed" or values.get("destination.finite_length")
        return not moved and not any("external_force" in name for name in values)

    def expected(self) -> Expected:
        base, length = self.base, self.units.factor(length=1)
        moved = np.array(base["displacement"]) * length
        free = ["source", "destination"] if self.masses()[1] is not None else ["source"]
        way = float(max(np.linalg.norm(moved[:3]), np.linalg.norm(moved[3:])))
        velocity = np.array(base["velocity"]) * self.units.factor(length=1, time=-1)
        condition = 1 + base["condition"]["displacement"]
        time = self.units.factor(time=1)
        return Expected(
            displacement={body: list(moved[3 * i : 3 * i + 3]) for i, body in enumerate(free)},
            way=max(way, 0.1 * length),
            rounding=8 * EPSILON * condition * length,
            fastest=float(np.linalg.norm(velocity[:3])),
            onsets=base["onsets"],
            sure=base["steady"],
            strong=0,
            last_onset=base["contact.last_onset_time"] * time if base["onsets"] else None,
        )


# The motions that a scene of the atlas may have

Motion = Edge | HeadOn | Impact | Rolling | Similar | Tumbling
