"""A ball in a hollow, or on a solid, sphere or cylinder, in the plane x-z, by an independent integration.

Polar coordinates about the destination's centre, the overlap itself as an unknown, regime by regime with
scipy's integrators, each change of regime located on their dense output: the motion that an approach-only
dashpot truly makes, with every touch of the gap rate at zero.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.81
STIFF = 2.0  # of critical damping: beyond it explicit steps are far shorter than the motion asks for


@dataclass
class Scene:
    shape: str
    inside: bool
    stiffness: float
    ratio: float  # of critical damping
    mass: float
    angle: float  # of the start, from the lowest (inside) or highest point [rad]
    depth: float = 1.0  # of the start, in parts of that at which spring and load balance
    speed: float = 0.0  # of the start, along the wall [m/s]
    force: list = field(
        default_factory=lambda: [[0.0, 0.0]] * 3
    )  # in the plane: value, first, second derivative

    @property
    def damping(self):
        return 2.0 * self.ratio * math.sqrt(self.stiffness * self.mass)

    @property
    def reach(self):
        return 0.4 if self.inside else 0.6

    @property
    def side(self):
        return -1.0 if self.inside else 1.0

    def pull(self, time, angle):
        """Acceleration without the contact, outwards and along growing angle; the angle from the z axis"""
        f = [a + b * time + 0.5 * c * time * time for a, b, c in zip(*self.force, strict=True)]
        x, z = f[0] / self.mass, f[1] / self.mass - GRAVITY
        return x * math.sin(angle) + z * math.cos(angle), x * math.cos(angle) - z * math.sin(angle)

    def start(self):
        """Overlap, its rate, angle, its rate"""
        angle = math.pi - self.angle if self.inside else self.angle
        turn = self.speed / self.reach
        load = self.mass * -self.side * (self.pull(0.0, angle)[0] + self.reach * turn * turn)
        return [self.depth * max(load, 0.0) / self.stiffness, 0.0, angle, turn]

    def values(self):
        """For an FMU"""
        overlap, _, angle, turn = self.start()
        d = self.reach - self.side * overlap
        speed = d * turn
        values = {
            "contact.location": "inside" if self.inside else "outside",
            "contact.method": "penalty_dynamic",
            "contact.dashpot": "approach_only",
            "contact.penalty_factor": self.stiffness,
            "contact.viscous_penalty_factor": self.damping,
            "source.mass": self.mass,
            "source.center": [d * math.sin(angle), 0.0, d * math.cos(angle)],
            "source.initial_velocity": [speed * math.cos(angle), 0.0, -speed * math.sin(angle)],
            "gravity": [0.0, 0.0, -GRAVITY],
            "source.external_force": [self.force[0][0], 0.0, self.force[0][1]],
            "source.external_force.derivatives": [[f[0], 0.0, f[1]] for f in self.force[1:]],
        }
        if self.shape == "cylinder":
            values["destination.axis"] = [0.0, 1.0, 0.0]
        return values


@dataclass
class Motion:
    events: int
    onsets: int
    position: np.ndarray


def integrate(scene, end, accuracy=1e-12):
    """The true motion; every change between full law, spring alone and flight is an event"""
    k, c, m = scene.stiffness, scene.damping, scene.mass
    rate = math.sqrt(k / m)

    def motion(regime):
        def slope(time, y):
            overlap, closing, angle, turn = y
            d = scene.reach - scene.side * overlap
            push = 0.0 if regime == "apart" else k * overlap + (c * closing if regime == "full" else 0.0)
            outwards, along = scene.pull(time, angle)
            growth = -scene.side * closing  # of d
            bend = outwards + d * turn * turn + scene.side * push / m
            return [closing, -scene.side * bend, turn, (along - 2.0 * growth * turn) / d]

        return slope

    def crossing(index, direction):
        def value(_time, y):
            return y[index]

        value.terminal, value.direction = True, direction
        return value

    opens, closes = crossing(0, -1), crossing(0, 1)
    slows, approaches = crossing(1, -1), crossing(1, 1)
    watched = {"full": [slows, opens], "spring": [approaches, opens], "apart": [closes]}
    after = {slows: "spring", approaches: "full", opens: "apart", closes: "full"}
    time, y = 0.0, np.array(scene.start())
    small = 1e-4 * accuracy * max(scene.mass * GRAVITY / k, 1e-12)
    # At rest the acceleration tells.
    regime = "full" if motion("spring")(0.0, y)[1] > 0.0 else "spring"
    if not y[0] > 0.0:
        regime = "apart"
    events, onsets = 0, 0 if regime == "apart" else 1
    while time < end:
        implicit = regime == "full" and scene.ratio > STIFF
        found = solve_ivp(
            motion(regime),
            (time, end),
            y,
            "Radau" if implicit else "DOP853",
            events=watched[regime],
            rtol=max(accuracy, 3e-14),
            atol=[small, small * rate, accuracy, accuracy],
            max_step=math.inf if implicit or regime == "apart" else 0.3 / rate,
        )
        time, y = found.t[-1], found.y[:, -1]
        if found.status == 1:
            [event] = [w for w, t in zip(watched[regime], found.t_events, strict=True) if len(t)][:1]
            regime = after[event]
            y = y.copy()
            y[1 if event in (slows, approaches) else 0] = 0.0
            events += 1
            onsets += event is closes
    d = scene.reach - scene.side * y[0]
    return Motion(events, onsets, np.array([d * math.sin(y[2]), 0.0, d * math.cos(y[2])]))


def random_scene(seed):
    """Damping from half of critical to a hundred times; so soft that the reference gets there in seconds"""
    draw = np.random.default_rng(seed)
    inside = bool(draw.random() < 0.7)
    mass = 10.0 ** draw.uniform(-1.0, 1.0)
    force = np.zeros((3, 2))
    if draw.random() < 0.5:
        force = mass * draw.normal(size=(3, 2)) * [[2.0], [4.0], [8.0]]
    return Scene(
        shape=str(draw.choice(["sphere", "cylinder"])),
        inside=inside,
        stiffness=mass * 10.0 ** draw.uniform(4.0, 5.5),
        ratio=math.exp(draw.uniform(math.log(0.5), math.log(100.0))),
        mass=mass,
        angle=draw.uniform(0.2, 1.3) if inside else draw.uniform(0.02, 0.3),
        depth=float(draw.choice([0.0, 0.3, 1.0, 1.8])),
        speed=float(draw.choice([0.0, 0.3])),
        force=[[float(f) for f in row] for row in force],
    )
