"""Scenes with friction and rotation whose end has a closed form: values, end, and what is then true.

A solid ball has I = 2/5 m a^2, so its surface answers a tangential force with 7/2 of its mass. Where a form
is exact for the regularized law at any v_0 it is given so; of a limit the order in v_0 or 1/p_n is said."""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import ellipk

G = 9.81
RADIUS = 0.1


class Case(NamedTuple):
    shape: str
    values: dict
    end: float
    expected: dict  # FMI output -> value


def rubbing(v_0, mu, **more):
    values = {"contact.friction": "regularized", "contact.friction_coefficient": mu}
    values |= {"contact.static_friction_coefficient": mu, "contact.slip_velocity_control": "user_defined"}
    values |= {"contact.characteristic_slip_velocity": v_0, **more}
    return values


def ball(stiffness, **more):
    """A free ball of 1 kg turns, without damping."""
    values = {"source.radius": RADIUS, "source.mass": 1.0, "source.motion": "free"}
    values |= {"destination.motion": "fixed", "source.rotation": "free", "contact.method": "penalty"}
    values |= {"contact.penalty_factor": stiffness, "gravity": [0.0, 0.0, -G], **more}
    return values


def excess(u):
    """Integral of ln(1 + e^-x) from u to infinity: what is slipped beyond the limit of v_0 = 0."""
    from mpmath import polylog

    return -float(polylog(2, -math.exp(-u))) if u > -30 else 0.5 * u * u + math.pi**2 / 6


def slide_to_roll(v_0, speed=2.0, spin=0.0, mu=0.2, end=None, stiffness=1e6):
    """Set down on a plane with `speed` along x and `spin` about y, in balance with its weight: slip s obeys
    s' = -(7/2) mu g (1 - exp(-s/v_0)), v = v(0) - 2/7 (s(0) - s), or
    the mirror image of that. In the limit v_0 = 0 it rolls from t = 2
    s(0)/(7 mu g) on; the way is longer than then by (pi^2/21) v_0^2/((7/2) mu g)."""
    begin, rate = speed - RADIUS * spin, 3.5 * mu * G
    slip, forwards = abs(begin), math.copysign(1.0, begin)
    end = end or 1.5 * slip / rate
    # e^(s/v_0) - 1 falls as exp(-rate t/v_0); u = (rate t - s(0))/v_0 counts from where rolling begins.
    u = (rate * end - slip) / v_0
    left = v_0 * (math.log1p(math.exp(-u)) if u > -700 else -u)  # e^(-s(0)/v_0) is below rounding
    velocity = speed - 2 / 7 * forwards * (slip - left)
    area = v_0**2 / rate * (excess(-slip / v_0) - excess(u))  # of s over time
    way = speed * end - 2 / 7 * forwards * (slip * end - area)
    values = ball(stiffness) | {"source.center": [0.0, 0.0, RADIUS - G / stiffness]}
    values |= {"source.initial_velocity": [speed, 0.0, 0.0]}
    values |= {"source.initial_angular_velocity": [0.0, spin, 0.0], **rubbing(v_0, mu)}
    turning = spin + 2.5 * (speed - velocity) / RADIUS
    expected = {
        "source.position": np.array([way, 0.0, RADIUS - G / stiffness]),
        "source.velocity": np.array([velocity, 0.0, 0.0]),
        "source.angular_velocity": np.array([0.0, turning, 0.0]),
        "contact.slip_velocity": np.array([forwards * left, 0.0, 0.0]),
        "energy.friction": 0.5 * speed**2 + 0.2 * (RADIUS * spin) ** 2 - 0.5 * velocity**2
        - 0.2 * (RADIUS * turning) ** 2,
    }  # fmt: skip
    return Case("plane", values, end, expected)


def incline(v_0, slope, mu=0.3, end=1.0, stiffness=1e6):
    """From rest down a plane that slopes along x. s' = g sin - (7/2) mu g cos (1 - exp(-s/v_0)) has a
    closed form, and v = 5/7 g sin t + 2/7 s. It rolls, up to order v_0, where tan <= 7 mu/2."""
    sine, cosine = math.sin(slope), math.cos(slope)
    a, b = G * sine, 3.5 * mu * G * cosine
    power = (a - b) * end / v_0
    if a < b:  # e^(s/v_0) = (b - a e^power)/(b - a)
        slip = v_0 * (math.log(b - a * math.exp(power)) - math.log(b - a))
    else:
        slip = (a - b) * end + v_0 * math.log((a - b * math.exp(-power)) / (a - b))
    velocity = 5 / 7 * a * end + 2 / 7 * slip
    down, normal = np.array([cosine, 0.0, -sine]), np.array([sine, 0.0, cosine])
    values = ball(stiffness) | {
        "source.center": ((RADIUS - G * cosine / stiffness) * normal).tolist(),
        "destination.axis": normal.tolist(),
        **rubbing(v_0, mu),
    }
    expected = {"source.velocity": velocity * down, "contact.slip_velocity": slip * down}
    expected |= {"source.angular_velocity": np.array([0.0, (velocity - slip) / RADIUS, 0.0])}
    return Case("plane", values, end, expected)


def golfers_tube(v_0, mu=1.0, tube=0.5, rate=8.0, stiffness=1e5, turns=2.0, **more):
    """A ball rolls round a vertical tube, falls and comes up again; exact in the limit v_0 = 0 (first order),
    at any penetration. `rate` is that of the orbit, z = -(5 g/(2 rate^2)) (1 - cos sqrt(2/7) rate t)."""
    # p_n delta = m rate^2 rho with rho = tube - a + delta
    rho = stiffness * (tube - RADIUS) / (stiffness - rate**2)
    values = ball(stiffness) | {"destination.radius": tube, "destination.axis": [0.0, 0.0, 1.0]}
    values |= {"source.center": [rho, 0.0, 0.0], "source.initial_velocity": [0.0, rate * rho, 0.0]}
    values |= {"source.initial_angular_velocity": [0.0, 0.0, -rate * rho / RADIUS], **rubbing(v_0, mu)}
    values |= {"contact.location": "inside", **more}
    end = turns * 2 * math.pi / rate
    slow = math.sqrt(2 / 7) * rate
    depth = 2.5 * G / rate**2
    phase = rate * end
    expected = {
        "source.position": np.array([rho * math.cos(phase), rho * math.sin(phase),
            -depth * (1 - math.cos(slow * end))]),
        "source.velocity": np.array([-rate * rho * math.sin(phase), rate * rho * math.cos(phase),
            -depth * slow * math.sin(slow * end)]),
    }  # fmt: skip
    return Case("cylinder", values, end, expected)


def turntable(v_0, mu=0.5, rate=3.0, way=(0.4, 0.1), velocity=(0.1, -0.2), stiffness=1e6, end=5.0):
    """A ball rolls on a plane that turns about z: it goes round at 2/7 of its rate, about a point that
    follows from the start. First order in v_0."""
    at, v, orbit = np.array(way), np.array(velocity), 2 / 7 * rate
    # No slip: v + omega x (-a e_z) = rate e_z x at
    wanted = rate * np.array([-at[1], at[0]]) - v
    spin = [wanted[1] / RADIUS, -wanted[0] / RADIUS, 0.7]
    middle = at + np.array([-v[1], v[0]]) / orbit
    c, s = math.cos(orbit * end), math.sin(orbit * end)
    turned = np.array([[c, -s], [s, c]])
    values = ball(stiffness) | {"source.center": [*way, RADIUS - G / stiffness]}
    values |= {"source.initial_velocity": [*velocity, 0.0], "source.initial_angular_velocity": spin}
    values |= {"destination.rotation": "prescribed"}
    values |= {"destination.prescribed_angular_velocity": [0.0, 0.0, rate]}
    values |= {"destination.prescribed_axis": [0.0, 0.0, 1.0], **rubbing(v_0, mu)}
    expected = {
        "source.position": np.array([*(middle + turned @ (at - middle)), RADIUS - G / stiffness]),
        "source.velocity": np.array([*(turned @ v), 0.0]),
    }
    return Case("plane", values, end, expected)


def bowl(v_0, stiffness, shape="sphere", angle=1.0, wide=0.5, mu=2.0, quarters=1):
    """A ball rolls in a bowl, or across a lying tube, from rest at `angle`. To order v_0 and 1/p_n it
    is at the lowest point after each odd quarter of 4 sqrt(7 rho/(5 g)) K(sin angle/2)."""
    rho = wide - RADIUS
    quarter = math.sqrt(7 * rho / (5 * G)) * float(ellipk(math.sin(angle / 2) ** 2))
    speed = math.sqrt(10 / 7 * G * rho * (1 - math.cos(angle)))
    deeper = rho + G * math.cos(angle) / stiffness
    values = ball(stiffness) | {"destination.radius": wide}
    values |= {"source.center": [deeper * math.sin(angle), 0.0, -deeper * math.cos(angle)]}
    values |= {**rubbing(v_0, mu), "contact.location": "inside"}
    if shape == "cylinder":
        values["destination.axis"] = [0.0, 1.0, 0.0]
    sign = -1 if quarters % 4 == 1 else 1
    expected = {
        "source.position": np.array([0.0, 0.0, -rho]),
        "source.velocity": np.array([sign * speed, 0.0, 0.0]),
    }
    return Case(shape, values, quarters * quarter, expected)


def leaving(stiffness, mu, v_0=1e-6, angle=0.3, wide=0.5):
    """A ball set on a sphere at `angle` from the top leaves it at cos = 10/17 cos(angle) where it rolls to
    the end, at 2/3 cos(angle) where mu = 0; limits of p_n infinite and mu infinite."""
    deep = wide + RADIUS - G * math.cos(angle) / stiffness
    friction = rubbing(v_0, mu) if mu else {"contact.friction": "none"}
    values = ball(stiffness) | {"destination.radius": wide}
    values |= {"source.center": [deep * math.sin(angle), 0.0, deep * math.cos(angle)]}
    values |= {"contact.location": "outside", **friction}
    return Case("sphere", values, 1.0, {"cosine": (10 / 17 if mu else 2 / 3) * math.cos(angle)})


def left_at(figures, end):
    """cos of the angle at which a ball has left the sphere at the origin: its fall, back to the release."""
    since = end - figures["contact.last_onset_time"] - figures["contact.last_duration"]
    fall = np.array([0.0, 0.0, -G])
    place = figures["source.position"] - since * figures["source.velocity"] + 0.5 * since**2 * fall
    return place[2] / np.linalg.norm(place)


# Impacts and flights of bodies that turn whose end has a closed form, as turning_cases.py has rolling.


def oblique_impact(velocity=(1.0, 0.3, -2.0), spin=(2.0, 5.0, 3.0), stiffness=7e5, mu=1.0):
    """Elastic springs with k_t = 2/7 k_n on a plane: both half periods are the same, the contact point
    comes back with the opposite velocity while it sticks throughout, where v_c <= 7/2 mu v_n. Exact."""
    v, omega = np.array(velocity), np.array(spin)
    arm = np.array([0.0, 0.0, -RADIUS])
    slip = v + np.cross(omega, arm)
    slip[2] = 0.0
    kick = -4 / 7 * slip
    expected = {"source.velocity": v + kick - 2 * np.array([0.0, 0.0, v[2]])}
    expected |= {"source.angular_velocity": omega + np.cross(arm, kick) / (0.4 * RADIUS**2)}
    expected |= {"energy.friction": 0.0, "contact.onsets": 1}
    expected |= {"contact.last_duration": math.pi / math.sqrt(stiffness)}
    values = ball(stiffness) | {"source.center": [0.0, 0.0, 0.2], "source.initial_velocity": list(velocity)}
    values |= {"source.initial_angular_velocity": list(spin), "gravity": [0.0, 0.0, 0.0]}
    values |= {"contact.friction": "elastic", "contact.friction_coefficient": mu}
    values |= {"contact.static_friction_coefficient": mu, "contact.tangential_stiffness": 2 / 7 * stiffness}
    return Case("plane", values, 0.1, expected)


def opposite_spin(mu=0.4, speed=0.2, spin=25.0):
    """Chung and Ooi 7: equal balls meet head-on with opposite spins; surfaces move alike: nothing rubs."""
    values = ball(1e7) | {"destination.motion": "free", "destination.rotation": "free"}
    values |= {"destination.radius": RADIUS, "source.center": [0.0, 0.0, 0.21]}
    values |= {"source.initial_velocity": [0.0, 0.0, -speed]}
    values |= {"destination.initial_velocity": [0.0, 0.0, speed]}
    values |= {"source.initial_angular_velocity": [0.0, spin, 0.0]}
    values |= {"destination.initial_angular_velocity": [0.0, -spin, 0.0], "gravity": [0.0, 0.0, 0.0]}
    values |= {"contact.location": "outside", **rubbing(1e-3, mu)}
    expected = {"source.velocity": np.array([0.0, 0.0, speed])}
    expected |= {"destination.velocity": np.array([0.0, 0.0, -speed])}
    expected |= {"source.angular_velocity": np.array([0.0, spin, 0.0])}
    expected |= {"destination.angular_velocity": np.array([0.0, -spin, 0.0]), "contact.onsets": 1}
    return Case("sphere", values, 0.1, expected)


def rotor(end, spin=(3.0, -4.0, 12.0), axis=(0.6, 0.0, 0.8), length=0.7, radius=0.2, mass=2.0):
    """A cylinder flies and tumbles: R(t) = Rot(L, |L| t/I_1) R_0 Rot(e_3, (1 - I_3/I_1) omega_3 t). Exact."""
    along, across = 0.5 * mass * radius**2, mass * (3 * radius**2 + length**2) / 12
    e, omega = np.array(axis), np.array(spin)
    momentum = across * omega + (along - across) * (omega @ e) * e
    first = turn(momentum, np.linalg.norm(momentum) * end / across)
    q_0 = np.array([1 + e[2], -e[1], e[0], 0.0]) / math.sqrt(2 * (1 + e[2]))
    last = turn(np.array([0.0, 0.0, 1.0]), (1 - along / across) * (omega @ e) * end)
    q = product(first, product(q_0, last))
    e = rotated(first, e)
    values = {"source.motion": "fixed", "source.center": [5.0, 0.0, 0.0], "destination.motion": "free"}
    values |= {"destination.rotation": "free", "destination.radius": radius, "destination.mass": mass}
    values |= {"destination.finite_length": True, "destination.length": length}
    values |= {"destination.axis": list(axis), "destination.initial_angular_velocity": list(spin)}
    values |= {"gravity": [0.0, 0.0, 0.0], "contact.location": "outside"}
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
    """A free ball goes to and fro in a free hollow sphere, without damping or gravity. Their middle rests."""
    values = ball(1e5) | {"source.rotation": "free", "destination.motion": "free"}
    values |= {"destination.rotation": "free", "destination.mass": 2.0, "source.center": [0.1, 0.05, 0.0]}
    values |= {"source.initial_velocity": [3.0, -4.0, 5.0], "destination.initial_velocity": [-1.5, 2.0, -2.5]}
    values |= {"source.initial_angular_velocity": [5.0, -9.0, 2.0]}
    values |= {"destination.initial_angular_velocity": [-1.0, 2.0, 3.0], "gravity": [0.0, 0.0, 0.0]}
    values |= {**rubbing(1e-2, 0.3), "contact.friction": friction, "contact.location": "inside"}
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
