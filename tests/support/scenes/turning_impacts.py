"""Impacts and flights of bodies that turn whose end has a closed form, as turning_cases.py has rolling."""

import math

import numpy as np

from support.scenes.turning_cases import RADIUS, Case, ball, rubbing


def oblique_impact(velocity=(1.0, 0.3, -2.0), spin=(2.0, 5.0, 3.0), stiffness=7e5, mu=1.0):
    """Elastic springs with k_t = 2/7 k_n on a plane: both half periods are the same, the contact point
    comes back with the opposite velocity while it sticks throughout, where v_c <= 7/2 mu v_n. Exact."""
    v, omega = np.array(velocity), np.array(spin)
    arm = np.array([0.0, 0.0, -RADIUS])
    slip = v + np.cross(omega, arm)
    slip[2] = 0.0
    kick = -4 / 7 * slip
    expected = {
        "source.velocity": v + kick - 2 * np.array([0.0, 0.0, v[2]]),
        "source.angular_velocity": omega + np.cross(arm, kick) / (0.4 * RADIUS**2),
        "energy.friction": 0.0,
        "contact.onsets": 1,
        "contact.last_duration": math.pi / math.sqrt(stiffness),
    }
    values = ball(
        stiffness,
        **{"source.center": [0.0, 0.0, 0.2], "source.initial_velocity": list(velocity),
            "source.initial_angular_velocity": list(spin), "gravity": [0.0, 0.0, 0.0],
            "contact.friction": "elastic", "contact.friction_coefficient": mu,
            "contact.static_friction_coefficient": mu, "contact.tangential_stiffness": 2 / 7 * stiffness},
    )  # fmt: skip
    return Case("plane", values, 0.1, expected)


def opposite_spin(mu=0.4, speed=0.2, spin=25.0):
    """Chung and Ooi 7: two equal balls meet head-on with opposite spins, their surfaces move alike: nothing
    rubs."""
    values = ball(
        1e7,
        **{"destination.motion": "free", "destination.rotation": "free", "destination.radius": RADIUS,
            "source.center": [0.0, 0.0, 0.21], "source.initial_velocity": [0.0, 0.0, -speed],
            "destination.initial_velocity": [0.0, 0.0, speed],
            "source.initial_angular_velocity": [0.0, spin, 0.0],
            "destination.initial_angular_velocity": [0.0, -spin, 0.0], "gravity": [0.0, 0.0, 0.0],
            "contact.location": "outside", **rubbing(1e-3, mu)},
    )  # fmt: skip
    expected = {
        "source.velocity": np.array([0.0, 0.0, speed]),
        "destination.velocity": np.array([0.0, 0.0, -speed]),
        "source.angular_velocity": np.array([0.0, spin, 0.0]),
        "destination.angular_velocity": np.array([0.0, -spin, 0.0]),
        "contact.onsets": 1,
    }
    return Case("sphere", values, 0.1, expected)


def rotor(end, spin=(3.0, -4.0, 12.0), axis=(0.6, 0.0, 0.8), length=0.7, radius=0.2, mass=2.0):
    """A cylinder that flies and tumbles: R(t) = Rot(L, |L| t/I_1) R_0 Rot(e_3, (1 - I_3/I_1) omega_3 t).
    Exact."""
    along, across = 0.5 * mass * radius**2, mass * (3 * radius**2 + length**2) / 12
    e, omega = np.array(axis), np.array(spin)
    momentum = across * omega + (along - across) * (omega @ e) * e
    first = turn(momentum, np.linalg.norm(momentum) * end / across)
    q_0 = np.array([1 + e[2], -e[1], e[0], 0.0]) / math.sqrt(2 * (1 + e[2]))
    last = turn(np.array([0.0, 0.0, 1.0]), (1 - along / across) * (omega @ e) * end)
    q = product(first, product(q_0, last))
    e = rotated(first, e)
    values = {
        "source.motion": "fixed", "source.center": [5.0, 0.0, 0.0], "destination.motion": "free",
        "destination.rotation": "free", "destination.radius": radius, "destination.mass": mass,
        "destination.finite_length": True, "destination.length": length, "destination.axis": list(axis),
        "destination.initial_angular_velocity": list(spin), "gravity": [0.0, 0.0, 0.0],
        "contact.location": "outside",
    }  # fmt: skip
    expected = {
        "destination.orientation": q,
        "destination.current_axis": e,
        "destination.angular_velocity": momentum / across + (1 / along - 1 / across) * (momentum @ e) * e,
    }
    return Case("cylinder", values, end, expected)


def turn(axis, angle):
    axis = np.array(axis) / np.linalg.norm(axis)
    return np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)])


def product(p, q):
    w = p[0] * q[0] - p[1:] @ q[1:]
    return np.array([w, *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def rotated(q, v):
    return v + 2 * np.cross(q[1:], np.cross(q[1:], v) + q[0] * v)


def shell(friction="regularized"):
    """A free ball that goes to and fro in a free hollow sphere, without damping and gravity."""
    values = ball(
        1e5,
        **{
            "source.rotation": "free",
            "destination.motion": "free",
            "destination.rotation": "free",
            "destination.mass": 2.0,
            "source.center": [0.1, 0.05, 0.0],
            "source.initial_velocity": [3.0, -4.0, 5.0],
            "destination.initial_velocity": [-1.5, 2.0, -2.5],  # their middle rests
            "source.initial_angular_velocity": [5.0, -9.0, 2.0],
            "destination.initial_angular_velocity": [-1.0, 2.0, 3.0],
            "gravity": [0.0, 0.0, 0.0],
            **rubbing(1e-2, 0.3),
            "contact.friction": friction,
            "contact.location": "inside",
        },
    )
    if friction == "elastic":
        values["contact.tangential_stiffness"] = 4e4
    return Case("sphere", values, 40.0, {})


def momenta(figures, values):
    """Linear and angular momentum of two free spheres about the origin."""
    linear, angular = np.zeros(3), np.zeros(3)
    for body, radius in (("source", RADIUS), ("destination", values.get("destination.radius", 0.5))):
        mass = values[f"{body}.mass"]
        linear += mass * figures[f"{body}.velocity"]
        angular += mass * np.cross(figures[f"{body}.position"], figures[f"{body}.velocity"])
        angular += 0.4 * mass * radius**2 * figures[f"{body}.angular_velocity"]
    return linear, angular
