"""An independent reference for bodies that turn and rub, as DESIGN sections 1, 6 and 7 write them.

Vectors of three numbers and quaternions (w, x, y, z) are of real or complex numbers: an imaginary part of
1e-30 carries a derivative along."""

import cmath
import math
from types import SimpleNamespace

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from support.reference.kept import kept
from support.reference.law import START_VALUES


def add(a, b):
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def times(factor, a):
    return [factor * a[0], factor * a[1], factor * a[2]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def root(x):
    return cmath.sqrt(x) if isinstance(x, complex) else math.sqrt(x)


def norm(a):
    return root(dot(a, a))


def unit(a):
    return times(1 / norm(a), a)


def first_orientation(axis):
    """Returns the smallest rotation that takes e_z to the axis, about x where the axis is -e_z."""
    w = 1 + axis[2]
    if w.real < 1e-15:
        return [0.0, 1.0, 0.0, 0.0]
    size = root(w * w + axis[0] ** 2 + axis[1] ** 2)
    return [w / size, -axis[1] / size, axis[0] / size, 0.0]


def turned_axis(q):
    """Returns the third column of the rotation matrix of q, which need not be of unit length."""
    w, x, y, z = q
    size = w * w + x * x + y * y + z * z
    return [2 * (x * z + w * y) / size, 2 * (y * z - w * x) / size, (w * w - x * x - y * y + z * z) / size]


def quaternion_rate(q, omega):
    """q' = (0, omega) q / 2, omega in the world."""
    w, x, y, z = q
    a, b, c = omega
    return [
        -0.5 * (a * x + b * y + c * z), 0.5 * (a * w + b * z - c * y), 0.5 * (b * w + c * x - a * z),
        0.5 * (c * w + a * y - b * x),
    ]  # fmt: skip


# The next functions give forces, torques and rates at one instant.
#
# A sphere meets a sphere, a cylinder or a plane. The state is a flat list: of each body position,
# velocity, orientation and spin (its angular momentum where it turns freely, else its angular velocity), then
# the springs of friction, rolling and spinning, then what is summed up: impulse and torque impulses,
# dissipated energy, friction's work, external work. Everything is in the world frame, but for spinning: its
# motion, its torque and its spring are numbers along the normal, written as the first component of a vector.

BODIES = ("source", "destination")
EACH = 13  # numbers of a body
SPRING = 2 * EACH
KINDS = ("slip", "rolling", "spinning")  # the motions that a contact may oppose, each with its spring
SPRINGS = {kind: slice(SPRING + 3 * k, SPRING + 3 * k + 3) for k, kind in enumerate(KINDS)}
SUMS = SPRING + 3 * len(KINDS)
DISSIPATED, FRICTION, WORK = SUMS + 9, SUMS + 10, SUMS + 11
SIZE = SUMS + 12
TINY = 1e-30  # step of derivatives by the imaginary part: no rounding enters, only its square is lost
ZERO = (0.0, 0.0, 0.0)
START = START_VALUES | {
    # start values of variables.toml
    "contact.location": "outside", "contact.law": "linear", "contact.friction": "none",
    "contact.friction_coefficient": 0.3, "contact.static_friction_coefficient": 0.3,
    "contact.maximum_friction_force": 1e300, "contact.tangential_stiffness": 2e6 / 7,
    "contact.tangential_damping": 0.0, "contact.tangential_law": "linear",
    "contact.tangential_ratio": 1.4 / 1.7,  # of two bodies with nu = 0.3
    "contact.rolling": "none", "contact.rolling_coefficient": 0.01,
    "contact.characteristic_rolling_rate": 1e-3, "contact.rolling_stiffness": 2.25,
    "contact.rolling_damping": 0.0, "contact.spinning": "none", "contact.spinning_coefficient": 0.01,
    "contact.characteristic_spinning_rate": 1e-3, "contact.spinning_stiffness": 2.25,
    "contact.spinning_damping": 0.0, "contact.hertz_stiffness": 1e9, "contact.hunt_crossley_factor": 0.0,
}  # fmt: skip


class TurningPair:
    """Constants of a scene, and what follows from a state."""

    def __init__(self, values, shape):
        self.values, self.shape = values, shape
        self.side = -1 if self.of("contact.location") == "inside" and shape != "plane" else 1
        self.r_s = self.of("source.radius")
        self.r_d = 0.0 if shape == "plane" else self.of("destination.radius")
        self.half_length = math.inf
        if values.get("destination.finite_length"):
            self.half_length = 0.5 * values.get("destination.length", 1.0)
        self.bodies = [self._body(name) for name in BODIES]
        self.gravity = self.of("gravity")
        self._law()

    def of(self, name, otherwise=ZERO):
        return self.values.get(name, START.get(name, otherwise))

    def _body(self, name):
        """Returns mass and moments of inertia, or None where the body does not move or turn freely."""
        values = self.values
        free = self.of(f"{name}.motion") == "free"
        rotation = values.get(f"{name}.rotation", "none")
        mass, inertia = self.of(f"{name}.mass"), None
        radius = self.r_s if name == "source" else self.r_d
        if rotation == "free":
            if values.get(f"{name}.inertia_control", "automatic") == "user_defined":
                inertia = (
                    values[f"{name}.axial_inertia"],
                    values.get(f"{name}.transverse_inertia", values[f"{name}.axial_inertia"]),
                )
            elif name == "destination" and self.shape == "cylinder":
                across = mass * (3 * radius**2 + (2 * self.half_length) ** 2) / 12
                inertia = (0.5 * mass * radius**2, across)
            else:
                inertia = (0.4 * mass * radius**2,) * 2
        if name == "source" or self.shape == "sphere":
            inertia = inertia and (inertia[0],) * 2
        return SimpleNamespace(
            name=name, mass=mass if free else None, moved=self.of(f"{name}.motion") == "prescribed",
            rotation=rotation, inertia=inertia, force=self.of(f"{name}.external_force"),
            torque=self.of(f"{name}.external_torque"),
        )  # fmt: skip

    def _law(self):
        self.hertz = self.of("contact.law") == "hertz"
        damped = self.of("contact.method") == "penalty_dynamic"
        if self.hertz:
            self.stiffness = self.of("contact.hertz_stiffness")
            self.viscous = self.of("contact.hunt_crossley_factor") if damped else 0.0
        else:
            self.stiffness = self.of("contact.penalty_factor")
            self.viscous = self.of("contact.viscous_penalty_factor") if damped else 0.0
        self.dashpot = self.of("contact.dashpot")
        slip = SimpleNamespace(
            law=self.of("contact.friction"), mu=self.of("contact.friction_coefficient"),
            mu_static=self.of("contact.static_friction_coefficient"),
            largest=self.of("contact.maximum_friction_force"),
            v_0=self.values.get("contact.characteristic_slip_velocity"),
            k=self.of("contact.tangential_stiffness"), c=self.of("contact.tangential_damping"),
            follows=self.hertz and self.of("contact.tangential_law") == "mindlin",
        )  # fmt: skip
        self.opposed = {"slip": slip} | {kind: self._resistance(kind) for kind in KINDS[1:]}

    def _resistance(self, kind):
        """The same numbers for the torque: mu_r R_r in place of mu, radians in place of metres."""
        turns = any(body.rotation != "none" for body in self.bodies)
        lever = 1 / (1 / self.r_s + (self.side / self.r_d if self.r_d else 0.0))
        mu = lever * self.of(f"contact.{kind}_coefficient")
        return SimpleNamespace(
            law=self.of(f"contact.{kind}") if turns else "none", mu=mu, mu_static=mu, largest=math.inf,
            v_0=self.of(f"contact.characteristic_{kind}_rate"), k=self.of(f"contact.{kind}_stiffness"),
            c=self.of(f"contact.{kind}_damping"), follows=False,
        )  # fmt: skip

    def first_state(self):
        y = []
        for body in self.bodies:
            name = body.name
            given = "prescribed" if body.moved else "initial"
            y += add(self.of(f"{name}.center"), self.of(f"{name}.{given}_displacement"))
            y += self.of(f"{name}.{given}_velocity") if body.moved or body.mass else ZERO
            sphere = name == "source" or self.shape == "sphere"
            axis = (0.0, 0.0, 1.0) if sphere else unit(self.of("destination.axis"))
            y += first_orientation(axis)
            spin = self.of(f"{name}.initial_angular_velocity") if body.inertia else ZERO
            if body.rotation == "prescribed":
                spin = self.of(f"{name}.prescribed_angular_velocity")
            if body.inertia:  # L = I_1 omega + (I_3 - I_1)(omega . e) e
                along, across = body.inertia
                spin = add(times(across, spin), times((along - across) * dot(spin, axis), axis))
            y += spin
        return [float(x) for x in y] + [0.0] * (SIZE - len(y))

    def body_at(self, y, index):
        """x, v, orientation, angular velocity, axis of one body."""
        at, body = EACH * index, self.bodies[index]
        q, spin = y[at + 6 : at + 10], y[at + 10 : at + 13]
        axis = turned_axis(q) if index == 1 and self.shape != "sphere" else (0.0, 0.0, 1.0)
        omega = spin
        if body.inertia:
            along, across = body.inertia
            omega = times(1 / across, spin)
            if along != across:
                omega = add(omega, times((1 / along - 1 / across) * dot(spin, axis), axis))
        return SimpleNamespace(x=y[at : at + 3], v=y[at + 3 : at + 6], q=q, omega=omega, axis=axis)

    def geometry(self, y):
        """Returns gap, its rate, the direction n from the source, its rate, and how far along the axis."""
        src, dst = self.body_at(y, 0), self.body_at(y, 1)
        c, w = minus(dst.x, src.x), minus(dst.v, src.v)
        w = minus(w, cross(dst.omega, c))  # as seen from the destination, which turns
        along = dot(c, dst.axis)
        if self.shape == "plane":
            n = times(-1.0, dst.axis)
            distance, shift = -along, ZERO
        else:
            if self.shape == "cylinder":
                c = minus(c, times(along, dst.axis))
                w_across = minus(w, times(dot(w, dst.axis), dst.axis))
            else:
                w_across = w
            distance = norm(c)
            n = times(1 / distance, c)
            shift = times(1 / distance, minus(w_across, times(dot(n, w_across), n)))
        g = distance - self.r_s - self.r_d if self.side > 0 else self.r_d - self.r_s - distance
        n_rate = add(shift, cross(dst.omega, n))
        rate = self.side * dot(n, w)
        return SimpleNamespace(src=src, dst=dst, gap=g, rate=rate, n=n, n_rate=n_rate, along=along)

    def law_force(self, gap, rate):
        """F_n before it is clipped: linear, or Hertz with Hunt and Crossley."""
        if self.dashpot == "approach_only" and rate.real > 0:
            rate = 0.0
        if self.hertz:
            return self.stiffness * (-gap) ** 1.5 * (1 - self.viscous * rate) if gap.real < 0 else 0.0
        return -self.stiffness * gap - self.viscous * rate

    def normal_force(self, gap, rate):
        force = self.law_force(gap, rate)
        return 0.0 if self.dashpot == "non_adhesive" and force.real < 0 else force

    def stored(self, gap):
        depth = max(-gap, 0.0)
        return 0.4 * self.stiffness * depth**2.5 if self.hertz else 0.5 * self.stiffness * depth**2

    def limit(self, one, force, static=False):
        """Returns the largest force, or torque, by the law `one` of self.opposed."""
        limit = (one.mu_static if static else one.mu) * force
        return 0.0 if limit.real < 0.0 else one.largest if limit.real > one.largest else limit

    def slip(self, place):
        """Of the source's surface on that of the destination, across n; and the lever arms of both."""
        src, dst = place.src, place.dst
        arm = times(self.r_s * self.side, place.n)
        other = minus(add(src.x, arm), dst.x)
        v = minus(add(src.v, cross(src.omega, arm)), add(dst.v, cross(dst.omega, other)))
        return minus(v, times(dot(v, place.n), place.n)), arm, other

    def stiffness_of(self, one, gap):
        """Returns the stiffness of a spring: given, or in proportion to dF_n/d delta of Hertz's spring."""
        if not one.follows:
            return one.k
        # The stiffness goes with the root of the depth, which is so steep near the release that integrating
        # a damped spring would take ever smaller steps. The depth counts as `least` there.
        least = 1e-12 if one.c > 0 else 0.0
        depth = -gap if gap.real < -least else least
        return self.of("contact.tangential_ratio") * 1.5 * self.stiffness * depth**0.5

    def held(self, kind, place, spring):
        """Returns the energy in a spring."""
        return 0.5 * self.stiffness_of(self.opposed[kind], place.gap) * dot(spring, spring)

    def motions(self, place):
        """Returns the opposed motions by their kinds."""
        spin = minus(place.src.omega, place.dst.omega)
        along = dot(spin, place.n)
        rolling = minus(spin, times(along, place.n))
        return {"slip": self.slip(place)[0], "rolling": rolling, "spinning": [along, 0.0, 0.0]}

    def elastic(self):
        return [kind for kind in KINDS if self.opposed[kind].law == "elastic"]

    def trial(self, one, place, motion, spring):
        """Returns F* of the elastic law: what the spring and the dashpot would pull with."""
        return add(times(self.stiffness_of(one, place.gap), spring), times(one.c, motion))


# The next functions give the rates of the state by Newton, Euler and the laws of friction, and of the sums.
#
# `touching` says which side of its events the contact is on, and `sticking` names the opposed motions that
# stick; they are remembered by who integrates, not recomputed from a rounded gap.

SHORT = 1e-9  # m or rad; below, its direction follows that of the slip within a thousandth of a degree


def along_spring(spring, slip, rate):
    """Returns the unit vector of the spring, or of the slip at `rate` while the spring is too short."""
    size = norm(spring)
    if size > (SHORT if rate < 0 else 0.0):
        return times(1 / size, spring)
    size = norm(slip)
    return times(1 / size, slip) if size > 0.0 else list(ZERO)


def friction_of(pair, one, place, force, motion, spring, sticking):
    """Returns the force or torque that opposes a motion by the law `one`, and the rate of the spring before
    it is turned with the normal: None where the spring is at its limit, whose rate then is the spring's."""
    if one.law == "none":
        return list(ZERO), list(ZERO)
    if one.law == "regularized":
        speed = norm(motion)
        if speed == 0.0:
            return list(ZERO), list(ZERO)
        return times(pair.limit(one, force) * np.expm1(-speed / one.v_0) / speed, motion), list(ZERO)
    if sticking:
        return times(-1.0, pair.trial(one, place, motion, spring)), motion
    limit = pair.limit(one, force)
    if one.c == 0.0:
        if limit == 0.0:  # no force holds a spring
            return list(ZERO), list(ZERO)
        return times(-limit, along_spring(spring, motion, place.rate)), None
    trial = pair.trial(one, place, motion, spring)
    size = norm(trial)
    pull = times(limit / size, trial) if size > 0.0 else list(ZERO)
    return times(-1.0, pull), times(1 / one.c, minus(pull, times(pair.stiffness_of(one, place.gap), spring)))


def forces(pair, y, touching, sticking):
    """Returns everything that acts at one instant."""
    place = pair.geometry(y)
    now = SimpleNamespace(place=place, force=0.0, friction=list(ZERO), spring_rate={}, slip=list(ZERO))
    now.on_source = now.source_torque = now.destination_torque = now.resistance = list(ZERO)
    now.motion, now.pull = {}, {}
    if not touching:
        return now
    now.force = pair.normal_force(place.gap, place.rate)
    now.slip, arm, other = pair.slip(place)
    now.motion = pair.motions(place)
    for kind in KINDS:
        now.pull[kind], now.spring_rate[kind] = friction_of(
            pair, pair.opposed[kind], place, now.force, now.motion[kind], y[SPRINGS[kind]], kind in sticking
        )
    now.friction = now.pull["slip"]
    now.on_source = add(times(-pair.side * now.force, place.n), now.friction)
    now.resistance = add(now.pull["rolling"], times(now.pull["spinning"][0], place.n))
    now.source_torque = add(cross(arm, now.on_source), now.resistance)
    now.destination_torque = minus(times(-1.0, cross(other, now.on_source)), now.resistance)
    return now


def body_rates(pair, y, now, out):
    """Of both bodies; the power that moves what is prescribed comes back."""
    power = 0.0
    for index, body in enumerate(pair.bodies):
        at = EACH * index
        push = now.on_source if index == 0 else times(-1.0, now.on_source)
        turn = now.source_torque if index == 0 else now.destination_torque
        here = now.place.src if index == 0 else now.place.dst
        out[at : at + 3] = here.v
        if body.mass:
            out[at + 3 : at + 6] = add(times(1 / body.mass, add(push, body.force)), pair.gravity)
            power += dot(body.force, here.v)
        elif body.moved:
            power -= dot(push, here.v)
            bend = pair.values.get(f"{body.name}.prescribed_velocity.derivatives", [ZERO])[0]
            out[at + 3 : at + 6] = list(bend)
        if body.rotation == "none":
            continue
        out[at + 6 : at + 10] = quaternion_rate(here.q, here.omega)
        if body.inertia:
            out[at + 10 : at + 13] = add(turn, body.torque)
            power += dot(body.torque, here.omega)
        else:
            power -= dot(turn, here.omega)
            rates = pair.values.get(f"{body.name}.prescribed_angular_velocity.derivatives", [ZERO])
            out[at + 10 : at + 13] = list(rates[0])
    return power


def rates(pair, y, touching, sticking):
    y = [float(x) for x in y]
    out = [0.0] * SIZE
    now = forces(pair, y, touching, sticking)
    out[WORK] = body_rates(pair, y, now, out)
    if not touching:
        return out
    place = now.place
    # The dashpot's part, F_n less the spring's, takes its power from the normal motion.
    kept = pair.stiffness * max(-place.gap, 0.0) ** 1.5 if pair.hertz else -pair.stiffness * place.gap
    out[DISSIPATED] = -(now.force - kept) * place.rate
    out[SUMS : SUMS + 9] = now.on_source + now.source_torque + now.destination_torque
    for kind in KINDS:
        out[FRICTION] -= dot(now.pull[kind], now.motion[kind])
    for kind in pair.elastic():
        spring, rate = y[SPRINGS[kind]], now.spring_rate[kind]
        if rate is None:
            rate, _ = at_limit(pair, kind, y, now, out)
        turned = ZERO if kind == "spinning" else times(dot(spring, place.n_rate), place.n)
        out[SPRINGS[kind]] = minus(rate, turned)
    return out


def longest_rate(pair, one, y, out):
    """Returns the rate of L / k along the motion `out`, by the imaginary part."""
    moved = [complex(a, TINY * b) for a, b in zip(y[:SPRING], out[:SPRING], strict=True)]
    place = pair.geometry(moved)
    force = pair.normal_force(place.gap, place.rate)
    if force.real <= 0:
        return 0.0
    limit, k = pair.limit(one, force), complex(pair.stiffness_of(one, place.gap))
    return (complex(limit).imag - limit.real * k.imag / k.real) / TINY / k.real


def growth_of_limit(pair, one, y):
    """The same while nothing rubs yet."""
    out = [0.0] * SIZE
    body_rates(pair, y, forces(pair, y, True, ()), out)
    moved = [complex(a, TINY * b) for a, b in zip(y[:SPRING], out[:SPRING], strict=True)]
    place = pair.geometry(moved)
    return one.mu_static * pair.law_force(place.gap, place.rate).imag / TINY


def at_limit(pair, kind, y, now, out):
    """Returns the rate of a spring without dashpot at its limit, and how fast the contact slides along it."""
    one, spring, motion = pair.opposed[kind], y[SPRINGS[kind]], now.motion[kind]
    unit = along_spring(spring, motion, now.place.rate)
    grows = longest_rate(pair, one, y, out)
    along = dot(motion, unit)
    if norm(spring) < SHORT:  # keeps its direction up to the release, which costs no steps
        return times(grows, unit), norm(motion)
    return add(minus(motion, times(along, unit)), times(grows, unit)), along - grows


def sliding_rate(pair, kind, y, sticking):
    """lambda of the definitions: while it is positive the contact slides."""
    out = [0.0] * SIZE
    now = forces(pair, y, True, [one for one in sticking if one != kind])
    if now.spring_rate[kind] is not None:
        return norm(now.motion[kind])
    body_rates(pair, y, now, out)
    return at_limit(pair, kind, y, now, out)[1]


# The outputs of a contact that turns and rubs at one instant.
#
# All functions are analytic within a regime, so that a complex step gives exact derivatives.


def outputs(pair, m):
    """Returns {name of an output without `contact.`: vector} in the motion m. Both bodies are led."""
    y = []
    for body in BODIES:
        has_axis = body == "destination" and pair.shape != "sphere"
        axis = unit(m["axis"]) if has_axis else (0.0, 0.0, 1.0)
        y += [*(m[f"{body}.center"] + m[f"{body}.displacement"]), *m[f"{body}.velocity"]]
        y += [*first_orientation(axis), *m[f"{body}.omega"]]
    y += [0.0] * 9
    place = pair.geometry(y)
    now = forces(pair, y, place.gap.real < 0.0, sticking=())
    slip, arm, _ = pair.slip(place)
    n, point = np.array(place.n), np.add(place.src.x, arm)
    spin = np.subtract(place.src.omega, place.dst.omega)
    found = {"gap": place.gap, "gap_rate": place.rate, "normal_force": now.force}
    found |= {"distance": pair.side * (place.gap + pair.r_s) + pair.r_d}
    found |= {"direction": -n if pair.shape == "cylinder" and pair.side < 0 else n}
    found |= {"source_force": now.on_source, "destination_force": -np.array(now.on_source)}
    found |= {"friction_force": now.friction, "slip_velocity": slip, "source_point": point}
    found |= {"point": point + place.gap * pair.side * n, "rolling_torque": now.resistance}
    found |= {"rolling_rate": spin - (spin @ n) * n, "spinning_rate": pair.side * (spin @ n)}
    found |= {"source_torque": now.source_torque, "destination_torque": now.destination_torque}
    if pair.shape != "sphere":
        found["current_axis"] = place.dst.axis
    return {name: np.atleast_1d(value) for name, value in found.items()}


# The next functions find where a function of time passes zero: between samples, and at extremes between them.

FALLS, RISES, BOTH = -1, 1, 0


def crossing(function, times_, of, direction):
    """Returns the first time at which the function passes zero in the direction, or None."""
    if direction == BOTH:
        found = [crossing(function, times_, of, one) for one in (FALLS, RISES)]
        return min((t for t in found if t is not None), default=None)
    for i in range(len(of) - 1):
        a, b = direction * of[i], direction * of[i + 1]
        if a < 0 <= b or (a == 0 and i == 0 and b > 0):
            return place(function, times_[i], times_[i + 1])
        top = extreme(function, times_, of, i, direction)
        if top is not None:
            return place(function, times_[i], top)
    return None


def extreme(function, times_, of, i, direction):
    """Returns a time between samples i and i + 1 past the crossing of a function that returns at i + 1."""
    around = [direction * of[j] for j in range(max(i - 1, 0), min(i + 3, len(of)))]
    if (
        max(direction * of[i], direction * of[i + 1]) >= 0
        or max(around) < max(around[0], around[-1]) + 1e-300
    ):
        return None
    spread = max(around) - min(around)
    if -max(around) > spread:  # a smooth function does not reach zero from there
        return None
    top = minimize_scalar(
        lambda t: -direction * function(t), bounds=(times_[i], times_[i + 1]), method="bounded",
        options={"xatol": 1e-9 * (times_[i + 1] - times_[i])},
    )  # fmt: skip
    return top.x if -top.fun > 0 else None


def place(function, low, high):
    a, b = function(low), function(high)
    if a * b >= 0:
        return low if abs(a) < abs(b) else high
    return brentq(function, low, high, xtol=1e-300, rtol=1e-15)


# The integration: Dormand and Prince's method of order 8 (scipy) at 1e-13, stopped and begun anew at every
# event: touch, release, end of a cylinder, corner of a law, stick and slip.
#
# An event is looked for on the dense output of every step, between samples and at their extremes, and then
# placed by steps of the method itself, which are more accurate than its dense output.

RELATIVE, ABSOLUTE = 1e-13, 1e-15
# A spring without a dashpot turns ever faster as the normal force ends, so that steps end before the
# release. A gap this close to zero [m] counts as one.
NEXT_TO_RELEASE = 1e-14
SAMPLES = 8  # of a step, between which an event may hide only if its function has two extremes there


class TurningRun:
    """State and events of one scene; `run` moves it on."""

    def __init__(self, values, shape, longest=math.inf, relative=RELATIVE):
        self.pair, self.time, self.longest, self.relative = TurningPair(values, shape), 0.0, longest, relative
        self.y = np.array(self.pair.first_state())
        self.onset_times, self.durations, self.events = [], [], []
        self.touching, self.sticking = False, set()  # the opposed motions that stick
        self.ends = 0.0  # to energy.dissipated by the ends of a cylinder
        place = self.pair.geometry(list(self.y))
        self.within = abs(place.along) <= self.pair.half_length
        if place.gap < 0 and self.within:
            self._touch()
        self.begin = self.energies()["total"]

    def _touch(self):
        pair = self.pair
        self.touching = True
        self.onset_times.append(self.time)
        self.y[SPRING:SUMS] = 0.0
        place = pair.geometry(list(self.y))
        force = pair.normal_force(min(place.gap, 0.0), place.rate)
        self.sticking = {kind for kind in pair.elastic() if self._begins_to_stick(kind, place, force)}

    def _begins_to_stick(self, kind, place, force):
        pair, one = self.pair, self.pair.opposed[kind]
        speed = norm(pair.motions(place)[kind])
        if force > 1e-12 * pair.stiffness * pair.r_s or one.c > 0 or speed == 0.0:
            return one.c * speed <= pair.limit(one, force, True)
        if pair.hertz and not one.follows:
            return False
        # both grow from zero, with the same power of time: which one faster
        ratio = pair.stiffness_of(one, -1.0) / pair.stiffness
        damped = 1 - pair.viscous * place.rate if pair.hertz else 1.0
        return ratio * speed <= one.mu_static * damped * -place.rate

    def _release(self):
        self.y[SPRING:SUMS] = 0.0
        self.touching, self.sticking = False, set()
        self.durations.append(self.time - self.onset_times[-1])

    def _functions(self):
        """name -> (function of the state, direction) of what may end the present stretch."""
        pair, found = self.pair, {}
        if math.isfinite(pair.half_length):
            found["end"] = lambda y: abs(pair.geometry(y).along) - pair.half_length, BOTH
        if not self.touching:
            if self.within:
                found["touch"] = lambda y: pair.geometry(y).gap, FALLS
            return found
        found["release"] = lambda y: pair.geometry(y).gap, RISES
        if pair.viscous > 0 and pair.dashpot == "approach_only":
            found["corner"] = lambda y: pair.geometry(y).rate, BOTH
        elif pair.viscous > 0:
            found["corner"] = lambda y: self._law(y), BOTH
        slip = pair.opposed["slip"]
        if slip.law != "none" and slip.largest < 1e299:
            found["largest"] = lambda y: slip.mu * self._law(y) - slip.largest, BOTH
        for kind in pair.elastic():
            found |= self._stick_and_slip(kind)
        return found

    def _law(self, y):
        place = self.pair.geometry(y)
        if self.pair.hertz:  # the sign alone, whatever the depth
            return 1 - self.pair.viscous * place.rate
        return self.pair.law_force(place.gap, place.rate)

    def _over(self, kind, y, static):
        pair, one = self.pair, self.pair.opposed[kind]
        place = pair.geometry(y)
        trial = norm(pair.trial(one, place, pair.motions(place)[kind], y[SPRINGS[kind]]))
        return trial - pair.limit(one, pair.normal_force(place.gap, place.rate), static)

    def _stick_and_slip(self, kind):
        if kind in self.sticking:
            return {f"{kind} slips": (lambda y: self._over(kind, y, True), RISES)}
        if self.pair.opposed[kind].c > 0:
            return {f"{kind} sticks": (lambda y: self._over(kind, y, False), FALLS)}
        return {f"{kind} sticks": (lambda y: sliding_rate(self.pair, kind, y, self.sticking), FALLS)}

    def _happen(self, name):
        self.events.append((self.time, name))
        pair, y = self.pair, list(self.y)
        if name == "touch":
            self._touch()
        elif name == "release":
            self._release()
        elif name.endswith(" sticks"):
            self.sticking.add(name.split()[0])
        elif name.endswith(" slips"):
            self._begin_to_slip(name.split()[0], y)
        elif name == "corner":
            for kind in pair.elastic():
                if pair.opposed[kind].c == 0.0:
                    self._rub_again(kind, y)
        elif name == "end":
            self._pass_end(pair.geometry(y))

    def _begin_to_slip(self, kind, y):
        pair, one = self.pair, self.pair.opposed[kind]
        self.sticking.discard(kind)
        if one.c == 0.0:
            place = pair.geometry(y)
            spring = y[SPRINGS[kind]]
            longest = pair.limit(one, pair.normal_force(place.gap, place.rate))
            longest /= pair.stiffness_of(one, place.gap)
            size = norm(spring)
            if longest < size:
                self.y[SPRINGS[kind]] = times(longest / size, spring)
                # Where the slip does not stretch it on from there it sticks again at once.
                if sliding_rate(pair, kind, list(self.y), self.sticking) < 0.0:
                    self.sticking.add(kind)

    def _rub_again(self, kind, y):
        """A normal force that ends leaves no spring; one that begins again finds none."""
        pair, one = self.pair, self.pair.opposed[kind]
        place = pair.geometry(y)
        if pair.dashpot == "approach_only":  # behind the corner slip may no longer stretch the spring
            if sliding_rate(pair, kind, y, self.sticking) < 0.0:
                self.sticking.add(kind)
            return
        if pair.hertz and place.gap >= 0:
            return
        self.y[SPRINGS[kind]] = 0.0
        y[SPRINGS[kind]] = [0.0] * 3
        speed = norm(pair.motions(place)[kind])
        if pair.stiffness_of(one, place.gap) * speed <= growth_of_limit(pair, one, y):
            self.sticking.add(kind)
        else:
            self.sticking.discard(kind)

    def _pass_end(self, place):
        self.within = not self.within
        if place.gap >= 0:
            return
        stored = self.pair.stored(place.gap)
        self.ends += stored if self.touching else -stored
        self._release() if self.touching else self._touch()

    def _rates(self, t, y):
        return rates(self.pair, y, self.touching, self.sticking)

    def _solver(self, end, first=None):
        return DOP853(
            self._rates, self.time, self.y, end, first_step=first, max_step=self.longest,
            rtol=self.relative, atol=ABSOLUTE * np.ones(SIZE),
        )  # fmt: skip

    def _after(self, length):
        """Returns the state after a time `length`."""
        if self.time + length <= self.time:
            return self.y
        end = self.time + length
        solver = self._solver(end, end - self.time)
        while solver.status == "running":
            solver.step()
        return solver.y

    def run(self, end):
        last = None
        while self.time < end:
            last = self._stretch(end, last)
        return self

    def _stretch(self, end, last):
        """Steps up to the next event; its name, None at the end."""
        functions = self._functions()
        solver = self._solver(end)
        # An event that has just happened leaves its function at zero, give or take a rounding.
        started = last
        while solver.status == "running":
            message = solver.step()
            if (
                solver.status == "failed"
                and self.touching
                and abs(self.pair.geometry(self.y).gap) < NEXT_TO_RELEASE
            ):
                self._happen("release")
                return "release"
            if solver.status == "failed":
                raise ValueError(f"the reference is stuck at {self.time} s: {message}")
            found = self._first(functions, solver.dense_output(), solver.t_old, solver.t, started)
            if found:
                return self._land(*found, functions, solver)
            started = None
            self.time, self.y = solver.t, solver.y.copy()
        return None

    def _first(self, functions, dense, low, high, started):
        times_ = np.linspace(low, high, SAMPLES + 1)
        rows = [dense(t).tolist() for t in times_]
        rows[0] = self.y.tolist()
        best = None
        for name, (function, direction) in functions.items():
            of = [function(row) for row in rows]
            if name == started:
                of[0] = math.copysign(1e-300, of[1])
            where = crossing(lambda t, f=function: f(dense(t).tolist()), times_, of, direction)
            if where is not None and (best is None or where < best[0]):
                best = where, name
        return best

    def _land(self, where, name, functions, solver):
        """Newton's steps on the motion itself; the dense output gives the slope."""
        function = functions[name][0]
        low, dense = solver.t_old, solver.dense_output()
        self.time, length = low, where - low
        apart = 1e-3 * (solver.t - low)
        a, b = max(where - apart, low), min(where + apart, solver.t)
        rise = function(dense(b).tolist()) - function(dense(a).tolist())
        slope = rise / (b - a) if b > a else 0.0
        for _ in range(2):
            value = function(list(self._after(length)))
            if slope != 0 and abs(value / slope) < 0.1 * (solver.t - low):
                length = max(length - value / slope, 0.0)
        self.y = np.array(self._after(length))
        self.time = low + length
        self._happen(name)
        return name

    # What a run says.

    def energies(self):
        pair, y = self.pair, list(self.y)
        place = pair.geometry(y)
        found = dict.fromkeys(("kinetic", "rotational", "potential", "contact", "tangential"), 0.0)
        for index, body in enumerate(pair.bodies):
            here = (place.src, place.dst)[index]
            if body.mass:
                found["kinetic"] += 0.5 * body.mass * dot(here.v, here.v)
                found["potential"] -= body.mass * dot(pair.gravity, here.x)
            if body.inertia:
                at = EACH * index + 10
                found["rotational"] += 0.5 * dot(here.omega, y[at : at + 3])
        if self.touching:
            found["contact"] = pair.stored(place.gap)
            found["tangential"] = sum(pair.held(kind, place, y[SPRINGS[kind]]) for kind in pair.elastic())
        found["dissipated"] = y[DISSIPATED] + self.ends
        found["friction"] = y[FRICTION] - found["tangential"]  # friction's work less what it stores
        found["external_work"] = y[WORK]
        found["total"] = sum(found.values()) - 2 * y[WORK]
        return found

    def ends_at(self, name):
        """Of one body: position, velocity, orientation, angular velocity, axis."""
        here = self.pair.body_at(list(self.y), BODIES.index(name))
        q = np.array(here.q) / np.linalg.norm(here.q)
        values = {"position": np.array(here.x), "velocity": np.array(here.v), "orientation": q}
        values |= {"angular_velocity": np.array(here.omega), "current_axis": np.array(here.axis)}
        return values

    def now(self):
        """Returns forces and torques at this instant."""
        return forces(self.pair, list(self.y), self.touching, self.sticking)

    def figures(self):
        """By the names of FMI; impulses and the spring, which no variable has, under names of their own."""
        now, found = self.now(), {f"energy.{name}": value for name, value in self.energies().items()}
        for body in BODIES:
            found |= {f"{body}.{name}": value for name, value in self.ends_at(body).items()}
        found |= {"contact.gap": now.place.gap, "contact.gap_rate": now.place.rate}
        found |= {"contact.normal_force": now.force, "contact.source_force": np.array(now.on_source)}
        found |= {"contact.source_torque": np.array(now.source_torque)}
        found |= {"contact.destination_torque": np.array(now.destination_torque)}
        found |= {"contact.friction_force": np.array(now.friction)}
        found |= {"contact.slip_velocity": np.array(now.slip), "contact.onsets": len(self.onset_times)}
        found |= {"impulse": self.y[SUMS : SUMS + 3].copy()}
        found |= {"source_torque_impulse": self.y[SUMS + 3 : SUMS + 6].copy()}
        found |= {"destination_torque_impulse": self.y[SUMS + 6 : SUMS + 9].copy()}
        found |= {"spring": self.y[SPRINGS["slip"]].copy()}
        if self.onset_times:
            lasting = self.time - self.onset_times[-1]
            found["contact.last_onset_time"] = self.onset_times[-1]
            found["contact.last_duration"] = lasting if self.touching else self.durations[-1]
        return found


def follow(values, shape, end):
    """Returns the figures of a run at its end, and the names of its events."""

    def find():
        run = TurningRun(values, shape).run(end)
        return run.figures() | {"events": [name for _, name in run.events]}

    return kept(["TurningRun", values, shape, end], find)
