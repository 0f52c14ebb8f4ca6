"""What the references of two cylinders and of a torus share. A scene `one` has stiffness, damping,
friction and slip velocity of its contact, and the masses and radii of source and destination."""

from dataclasses import asdict, dataclass

import numpy as np
from scipy.integrate import solve_ivp

from support.reference.kept import kept
from support.scenes.random_scenes import touching_values

GRAVITY = np.array([0.0, 0.0, -9.81])
SMALL = 1e-12  # s, past an event, so that the next integration starts beyond it


def unit(a) -> np.ndarray:
    return np.asarray(a, float) / np.linalg.norm(a)


def pressed(one, depth, velocity, push, slip) -> np.ndarray:
    """Returns the force on the source, pushed along `push`, with a linear law and regularized friction. The
    destination sees the source's `velocity` and its surface's `slip`."""
    normal = max(one.stiffness * depth - one.damping * velocity @ push, 0.0)
    slip = slip - (slip @ push) * push
    speed = np.linalg.norm(slip)
    rubs = one.friction and speed > 0.0
    along = one.friction * np.expm1(-speed / one.slip) * slip / speed if rubs else np.zeros(3)
    return normal * (push + along)


def first_state(one) -> np.ndarray:
    """Of two cylinders, the destination at rest in the origin"""
    return np.concatenate([one.place, one.velocity, np.zeros(6), one.rates if one.turns else (0.0, 0.0)])


def state_of(fmu, axes) -> np.ndarray:
    """The same of an FMU"""
    bodies = ("source", "destination")
    parts = [fmu[f"{body}.{what}"] for body in bodies for what in ("position", "velocity")]
    rates = [fmu[f"{body}.angular_velocity"] @ e for body, e in zip(bodies, axes, strict=True)]
    return np.concatenate([*parts, rates])


def ended(one, rates, y, events, **options) -> np.ndarray:
    """Returns the state of a scene at its end, by Dormand and Prince's method, begun anew at every event."""

    def find():
        time, now = 0.0, y
        for event in events:
            event.terminal = True
        while time < one.end - 1e-15:
            found = solve_ivp(rates, (time, one.end), now, "DOP853", events=events, **options)
            time, now = found.t[-1], found.y[:, -1]
            if found.status == 1:
                now, time = now + SMALL * rates(time, now), time + SMALL
        return now

    return kept([type(one).__module__.rpartition(".")[2], asdict(one)], find)


@dataclass
class CylinderPair:
    """A scene of two cylinders that turn about their own axes alone; the destination's centre starts at the
    origin. `forces` of a state are the force on the source, the torques about both axes, the gap, and more.
    """

    axes: tuple[np.ndarray, np.ndarray]  # unit vectors of source and destination
    radius: tuple[float, float]
    mass: tuple[float, float]
    length: tuple[float, float]  # infinite where they have no ends
    place: np.ndarray  # of the source
    velocity: np.ndarray
    rates: tuple[float, float]  # about their axes, rad/s
    stiffness: float
    damping: float
    friction: float  # coefficient; 0: none
    turns: bool
    both: bool  # whether the destination is free too
    inside: bool = False
    slip: float = 1e-2
    end: float = 0.12

    def values(self) -> dict:
        values = touching_values(self)
        for i, body in enumerate(("source", "destination")):
            values |= {f"{body}.radius": self.radius[i], f"{body}.mass": self.mass[i]}
            values |= {f"{body}.axis": (2.0 - 3.0 * i) * self.axes[i]}
            if np.isfinite(self.length[i]):
                values |= {f"{body}.finite_length": True, f"{body}.length": self.length[i]}
            if self.turns:
                values |= {
                    f"{body}.rotation": "free",
                    f"{body}.initial_angular_velocity": self.rates[i] * self.axes[i],
                }
        return values

    def rates_of(self, _t, y) -> np.ndarray:
        """Of places and velocities of source and destination, and of both angular velocities"""
        force, *torques = self.forces(y)[:3]
        rates = np.zeros(14)
        rates[0:3], rates[3:6] = y[3:6], GRAVITY + force / self.mass[0]
        if self.both:
            rates[6:9], rates[9:12] = y[9:12], GRAVITY - force / self.mass[1]
        if self.turns:
            rates[12:14] = 2.0 * np.array(torques) / (np.array(self.mass) * np.square(self.radius))
        return rates

    def events(self) -> list:
        return [lambda _t, y: self.forces(y)[3]]

    def ended(self) -> np.ndarray:
        # A step across the end of the dashpot's force may be 2e-7 off at 1e-12, and its estimate misses it.
        options = {"rtol": 1e-13, "atol": 1e-13, "max_step": 2e-4}
        return ended(self, self.rates_of, first_state(self), self.events(), **options)
