"""An independent reference for bodies that turn and rub: forces, torques and rates at one instant, as
DESIGN sections 1, 6 and 7 write them.

One sphere against a sphere, a cylinder or a plane. The state is a flat list: of each body position,
velocity, orientation and spin (its angular momentum where it turns freely, else its angular velocity), then
the springs of friction, rolling and spinning, then what is summed up: impulse and torque impulses, dissipated
energy, friction's work, external work. Everything is in the world frame, but for spinning: its motion, its
torque and its spring are numbers along the normal, written as the first component of a vector.
turning_run.py integrates it.
"""

import math
from types import SimpleNamespace

from support.reference.law import START_VALUES
from support.reference.turning_vectors import (
    add,
    cross,
    dot,
    first_orientation,
    minus,
    norm,
    times,
    turned_axis,
    unit,
)

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
        """Mass and moments of inertia; None where the body does not move or turn freely."""
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
            law=self.of("contact.friction"),
            mu=self.of("contact.friction_coefficient"),
            mu_static=self.of("contact.static_friction_coefficient"),
            largest=self.of("contact.maximum_friction_force"),
            v_0=self.values.get("contact.characteristic_slip_velocity"),
            k=self.of("contact.tangential_stiffness"),
            c=self.of("contact.tangential_damping"),
            follows=self.hertz and self.of("contact.tangential_law") == "mindlin",
        )
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
        """Gap, its rate, the direction n from the source, its rate, and how far along the axis."""
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
        return SimpleNamespace(
            src=src, dst=dst, gap=g, rate=self.side * dot(n, w), n=n, n_rate=n_rate, along=along
        )

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
        """The largest force, or torque, by the law `one` of self.opposed."""
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
        """Stiffness of a spring: given, or in proportion to dF_n/d delta of Hertz's spring."""
        if not one.follows:
            return one.k
        # The stiffness goes with the root of the depth, which is so steep near the release that integrating
        # a damped spring would take ever smaller steps. The depth counts as `least` there.
        least = 1e-12 if one.c > 0 else 0.0
        depth = -gap if gap.real < -least else least
        return self.of("contact.tangential_ratio") * 1.5 * self.stiffness * depth**0.5

    def held(self, kind, place, spring):
        """The energy in a spring."""
        return 0.5 * self.stiffness_of(self.opposed[kind], place.gap) * dot(spring, spring)

    def motions(self, place):
        """The opposed motions by their kinds."""
        spin = minus(place.src.omega, place.dst.omega)
        along = dot(spin, place.n)
        rolling = minus(spin, times(along, place.n))
        return {"slip": self.slip(place)[0], "rolling": rolling, "spinning": [along, 0.0, 0.0]}

    def elastic(self):
        return [kind for kind in KINDS if self.opposed[kind].law == "elastic"]

    def trial(self, one, place, motion, spring):
        """F* of the elastic law: what the spring and the dashpot would pull with."""
        return add(times(self.stiffness_of(one, place.gap), spring), times(one.c, motion))
