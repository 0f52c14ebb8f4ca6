"""What the references of two cylinders and of a torus share. A scene `one` has stiffness, damping,
friction and slip velocity of its contact, and the masses and radii of source and destination.
"""

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = np.array([0.0, 0.0, -9.81])
SMALL = 1e-12  # s, past an event, so that the next integration starts beyond it


def unit(a) -> np.ndarray:
    return np.asarray(a, float) / np.linalg.norm(a)


def pressed(one, depth, velocity, push, slip) -> np.ndarray:
    """Force on the source, which the destination pushes along `push`; `velocity` is the source's as the
    destination sees it, `slip` that of its surface. Linear law, regularized friction."""
    normal = max(one.stiffness * depth - one.damping * velocity @ push, 0.0)
    slip = slip - (slip @ push) * push
    speed = np.linalg.norm(slip)
    rubs = one.friction and speed > 0.0
    along = one.friction * np.expm1(-speed / one.slip) * slip / speed if rubs else np.zeros(3)
    return normal * (push + along)


def cylinder_rates(one, y, force, torque, other) -> np.ndarray:
    """Rates of two cylinders that turn about their own axes: of places and velocities of source and
    destination, and of both angular velocities. The force acts on the source, the torques about both axes."""
    rates = np.zeros(14)
    rates[0:3], rates[3:6] = y[3:6], GRAVITY + force / one.mass[0]
    if one.both:
        rates[6:9], rates[9:12] = y[9:12], GRAVITY - force / one.mass[1]
    if one.turns:
        rates[12:14] = [
            2.0 * t / (m * r * r) for t, m, r in zip((torque, other), one.mass, one.radius, strict=True)
        ]
    return rates


def first_state(one) -> np.ndarray:
    """Of two cylinders, the destination at rest in the origin"""
    return np.concatenate([one.place, one.velocity, np.zeros(6), one.rates if one.turns else (0.0, 0.0)])


def state_of(fmu, axes) -> np.ndarray:
    """The same of an FMU"""
    bodies = ("source", "destination")
    parts = [fmu[f"{body}.{what}"] for body in bodies for what in ("position", "velocity")]
    rates = [fmu[f"{body}.angular_velocity"] @ e for body, e in zip(bodies, axes, strict=True)]
    return np.concatenate([*parts, rates])


def ended(rates, y, end, events, **options) -> np.ndarray:
    """The state at `end`, by Dormand and Prince's method, begun anew at every event"""
    time = 0.0
    for event in events:
        event.terminal = True
    while time < end - 1e-15:
        found = solve_ivp(rates, (time, end), y, "DOP853", events=events, **options)
        time, y = found.t[-1], found.y[:, -1]
        if found.status == 1:
            y, time = y + SMALL * rates(time, y), time + SMALL
    return y
