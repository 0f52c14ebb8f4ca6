"""Random scenes in which what pushes the bodies begins at exactly zero: forces and given motions that grow
linearly or with the square of time, on contacts from none to a hundred times critical damping.

`reference` integrates them in Cartesian coordinates (Dormand and Prince's method of order eight, from scipy),
with the energies as further unknowns, independently of the code under test.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

DRIVEN = ["source by force", "destination led", "both by force", "source led"]
VISCOUS = math.inf  # a dashpot alone
RATIOS = [0.0, 0.3, 0.9, 1.01, 1.2, 2.0, 5.0, 20.0, 100.0, VISCOUS]  # of critical damping
MOST_RADIANS = 600.0  # of the fastest rate of the contact, which the reference has to resolve


@dataclass
class RampScene:
    shape: str
    values: dict
    end: float
    steps: int


def unit_vector(random):
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction)


def growing(random, size, time, press):
    """First and second derivatives of an input that starts at zero and comes to about `size` after `time`;
    `press`: the direction it must have a part in, or zero
    """
    linear = size / time * random.normal(size=3)
    square = 2 * size / time**2 * random.normal(size=3)
    for row in (linear, square):
        row *= -1.0 if row @ press < 0 else 1.0
    kind = random.integers(3)
    return [(linear if kind != 1 else 0 * linear).tolist(), (square if kind != 0 else 0 * square).tolist()]


def ends_of(driven):
    """The body that moves freely, and the one that is led or held"""
    return ("source", "destination") if driven != "source led" else ("destination", "source")


def set_in_motion(values, driven, random, moved, time, press):
    """The ramps that move the bodies of the scene by about `moved` in the time"""
    free, held = ends_of(driven)
    if driven.endswith("led"):
        values[f"{held}.motion"], values[f"{free}.motion"] = "prescribed", "free"
        values[f"{held}.prescribed_velocity.derivatives"] = growing(
            random, moved / time, time, press if held == "source" else -press
        )
        if driven == "source led":
            values["destination.mass"] = values["source.mass"]
    else:
        for body in [free, held][: 1 + (driven == "both by force")]:
            values[f"{body}.motion"] = "free"
            values[f"{body}.external_force.derivatives"] = growing(
                random, values[f"{body}.mass"] * moved / time**2, time, press if body == "source" else -press
            )


def ramp_scene(seed):
    random = np.random.default_rng([seed, 11])
    shape = ["sphere", "cylinder"][random.integers(2)]
    inside = bool(random.integers(2))
    driven = DRIVEN[random.integers(len(DRIVEN))]
    ratio = RATIOS[random.integers(len(RATIOS))]
    axis = unit_vector(random)
    outward = np.cross(axis, unit_vector(random))
    outward /= np.linalg.norm(outward)
    radius, small = 0.5, 0.1
    reach = radius - small if inside else radius + small
    side = 1.0 if inside else -1.0  # where contact is, seen from the source
    mass = 10 ** random.uniform(-0.5, 0.5)
    other_mass = 10 ** random.uniform(-0.5, 1.0)
    reduced = mass * other_mass / (mass + other_mass) if driven == "both by force" else mass
    rate = 10 ** random.uniform(0.5, 3)
    overlap = 10 ** random.uniform(-6, -1.5) * reach
    press = np.zeros(3)
    if shape == "sphere" and random.integers(4) == 0:  # exactly at the touch, and pressed from then on
        overlap, outward = 0.0, np.eye(3)[random.integers(3)]
        press = side * outward
    time = 10 ** random.uniform(-2, 0.3)
    fastest = rate if ratio == VISCOUS else rate * max(1.0, 2 * ratio)
    time = min(time, MOST_RADIANS / fastest)
    free, _ = ends_of(driven)
    values = {
        "source.motion": "free",
        "destination.motion": "fixed",
        "source.radius": small,
        "destination.radius": radius,
        "source.mass": mass,
        "destination.mass": other_mass,
        "source.center": ((reach + side * overlap) * outward).tolist(),
        "contact.location": "inside" if inside else "outside",
        "contact.method": "penalty_dynamic" if ratio > 0 else "penalty",
        "contact.dashpot": "unclamped",
        "contact.penalty_factor": reduced * rate**2,
        "contact.viscous_penalty_factor": fastest * reduced if ratio > 1 else 2 * ratio * rate * reduced,
        "gravity": [0.0, 0.0, 0.0],
    }
    if ratio == VISCOUS:
        values["contact.penalty_control"] = "viscous_only"
    if shape == "cylinder":
        values["destination.axis"] = axis.tolist()
    moved = 10 ** random.uniform(-2, 0) * reach  # about how far it is pushed in the time
    set_in_motion(values, driven, random, moved, time, press)
    if random.integers(3) == 0 and overlap > 0.0:  # on its way, across the contact too
        values[f"{free}.initial_velocity"] = (0.1 * moved / time * random.normal(size=3)).tolist()
    elif random.integers(3) == 0 and ratio != VISCOUS:
        values["contact.dashpot"] = "non_adhesive"
    return RampScene(shape, values, time, [1, 1, 3, 10][random.integers(4)])


@dataclass
class RampReference:
    end: float  # up to just before the bodies part or the dashpot is clipped, if that happens
    position: dict
    velocity: dict
    stored: float
    dissipated: float
    external_work: float


def polynomial(rows, t):
    """Of an input that is zero at the start: its value at t from the first and second derivatives."""
    return np.asarray(rows[0]) * t + np.asarray(rows[1]) * (t * t / 2)


def integral(rows, t):
    return np.asarray(rows[0]) * (t * t / 2) + np.asarray(rows[1]) * (t**3 / 6)


NONE = [[0.0] * 3, [0.0] * 3]


class Equations:
    """State: deviation of each body from its centre, velocities, dissipated energy, external work."""

    def __init__(self, scene):
        self.values = v = scene.values
        self.inside = v["contact.location"] == "inside"
        self.reach = v["destination.radius"] + (-1 if self.inside else 1) * v["source.radius"]
        self.sign = -1 if self.inside else 1
        self.stiffness = v["contact.penalty_factor"] if "contact.penalty_control" not in v else 0.0
        self.damping = v["contact.viscous_penalty_factor"] if v["contact.method"] != "penalty" else 0.0
        self.axis = np.array(v["destination.axis"]) if scene.shape == "cylinder" else np.zeros(3)
        self.start = -np.array(v["source.center"])  # c

    def led(self, body):
        return self.values.get(f"{body}.prescribed_velocity.derivatives", NONE)

    def bodies(self, t, y):
        """Displacements and velocities of source and destination."""
        u, w = y[0:6].reshape(2, 3).copy(), y[6:12].reshape(2, 3).copy()
        for i, body in enumerate(("source", "destination")):
            if self.values[f"{body}.motion"] == "prescribed":
                u[i], w[i] = integral(self.led(body), t), polynomial(self.led(body), t)
        return u, w

    def contact(self, u, w):
        """g, its rate, and n"""
        moved = u[1] - u[0]
        moved = moved - moved @ self.axis * self.axis
        start = self.start - self.start @ self.axis * self.axis
        rate = w[1] - w[0]
        first = math.sqrt(start @ start)
        c = start + moved
        d = math.sqrt(c @ c)
        grown = (2 * start + moved) @ moved / (d + first)
        n = c / d
        rate = rate - rate @ self.axis * self.axis
        return self.sign * ((first - self.reach) + grown), self.sign * (n @ rate), n

    def rates(self, t, y):
        u, w = self.bodies(t, y)
        gap, gap_rate, n = self.contact(u, w)
        force = -(self.stiffness * gap + self.damping * gap_rate)
        out = np.zeros(14)
        for i, (body, side) in enumerate((("source", -1), ("destination", 1))):
            push = side * self.sign * force * n
            kind = self.values[f"{body}.motion"]
            if kind == "free":
                outer = polynomial(self.values.get(f"{body}.external_force.derivatives", NONE), t)
                out[3 * i : 3 * i + 3] = w[i]
                out[6 + 3 * i : 9 + 3 * i] = (outer + push) / self.values[f"{body}.mass"]
                out[13] += outer @ w[i]
            elif kind == "prescribed":
                out[13] -= push @ w[i]
        out[12] = self.damping * gap_rate**2
        return out


def reference(scene):
    equations = Equations(scene)
    y = np.zeros(14)
    for i, body in enumerate(("source", "destination")):
        y[6 + 3 * i : 9 + 3 * i] = scene.values.get(f"{body}.initial_velocity", [0.0] * 3)

    clipped = scene.values["contact.dashpot"] == "non_adhesive"

    def overlap(t, y):
        """What is left of it [m], or of the force where that may not fall below zero"""
        gap, gap_rate, _ = equations.contact(*equations.bodies(t, y))
        pressed = -gap - equations.damping / max(equations.stiffness, 1.0) * gap_rate
        return (min(-gap, pressed) if clipped else -gap) if t > 0 else 1e-14

    overlap.terminal, overlap.direction = True, -1

    def solve(end):
        return solve_ivp(
            equations.rates,
            (0, end),
            y,
            "DOP853",
            rtol=3e-14,
            atol=1e-17,
            first_step=1e-6 * end,
            events=overlap,
        )

    solution = solve(scene.end)
    end = scene.end
    if solution.status == 1:
        end = 0.9 * float(solution.t[-1])
        solution = solve(end)
    u, w = equations.bodies(end, solution.y[:, -1])
    gap = equations.contact(u, w)[0]
    names = ("source", "destination")
    centres = (np.array(scene.values["source.center"]), np.zeros(3))
    return RampReference(
        end,
        {name: (centres[i] + u[i]) for i, name in enumerate(names)},
        {name: w[i] for i, name in enumerate(names)},
        equations.stiffness * gap * gap / 2,
        solution.y[12, -1],
        solution.y[13, -1],
    )
