"""Head-on contacts without gravity: how they are set up, and what the linear oscillator says about them.

While the bodies overlap, the penetration s = -g obeys m s'' + c s' + k s = 0, s(0) = 0, s'(0) = v, with m
the effective mass. With zeta = c / (2 sqrt(k m)) = sin(phi), omega = sqrt(k/m), theta = omega t cos(phi):

    s   =  v / (omega cos phi) exp(-theta tan phi) sin(theta)
    s'  =  v / cos phi         exp(-theta tan phi) cos(theta + phi)
    F   = -m s'' = m omega v / cos phi exp(-theta tan phi) sin(theta + 2 phi)

(each derivative turns the phase by phi). phi is complex for zeta > 1, with real results."""

import cmath
import math
from typing import NamedTuple

import numpy as np

GEOMETRIES = [(shape, location) for shape in ("sphere", "cylinder") for location in ("outside", "inside")]
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
ACROSS = np.array([1.0, 2.0, 0.0]) / math.sqrt(5.0)  # perpendicular to AXIS
GAP, SPEED = 0.05, 1.0
RADII = {"source.radius": 0.1, "destination.radius": 0.5}


def head_on(shape, location, gap=GAP, speed=SPEED, **more):
    """The source comes along ACROSS and closes `gap` with `speed`; `more` has _ for dots of names"""
    inside = location == "inside"
    distance = 0.4 - gap if inside else 0.6 + gap
    values = {
        **RADII, "source.motion": "free", "destination.motion": "fixed",
        "source.center": (distance * ACROSS).tolist(),
        "source.initial_velocity": ((1 if inside else -1) * speed * ACROSS).tolist(),
        "contact.location": location, "contact.method": "penalty", "contact.penalty_factor": 1e6,
        "gravity": [0.0, 0.0, 0.0],
    }  # fmt: skip
    if shape == "cylinder":
        values["destination.axis"] = AXIS.tolist()
    values.update({name.replace("_", ".", 1): value for name, value in more.items()})
    return values


def of_size(shape, location, radius, gap, speed):
    """head_on with a source of this radius and a destination five times as large."""
    values = head_on(shape, location, speed=speed)
    distance = 4 * radius - gap if location == "inside" else 6 * radius + gap
    found = values | {"source.radius": radius, "destination.radius": 5 * radius}
    found |= {"source.center": (distance * ACROSS).tolist()}
    return found


def shared_out(values, source, destination, m_s, m_d):
    """Returns motions and masses. The pair closes at one speed whoever moves."""
    share = m_d / (m_s + m_d) if source == destination == "free" else float(source == "free")
    speed = np.array(values["source.initial_velocity"])
    return values | {
        "source.motion": source, "destination.motion": destination, "source.mass": m_s,
        "destination.mass": m_d,
        "source.initial_velocity": (share * speed).tolist(),
        "destination.initial_velocity": ((share - 1.0) * speed).tolist(),
    }  # fmt: skip


def speed_after(fmu, location):
    """At which the pair parts"""
    return (fmu["destination.velocity"] - fmu["source.velocity"]) @ approach(location)


def approach(location):
    """Returns the unit vector of the source's velocity before the contact."""
    return ACROSS if location == "inside" else -ACROSS


class Impact(NamedTuple):
    """What the oscillator says: speed after / before, how long g < 0, and the peaks."""

    restitution: float
    duration: float
    peak_penetration: float
    peak_force: float


def oscillator(dashpot, mass, stiffness, damping, speed=SPEED):
    omega = math.sqrt(stiffness / mass)
    zeta = damping / (2 * math.sqrt(stiffness * mass))
    phi = cmath.asin(zeta)
    slope, rate = cmath.tan(phi), omega * cmath.cos(phi)
    turned = math.pi / 2 - phi  # theta where s' = 0
    deepest = speed / omega * cmath.exp(-slope * turned)
    if dashpot == "unclamped":  # until s = 0
        restitution, duration = cmath.exp(-slope * math.pi), math.pi / rate
    elif dashpot == "non_adhesive":  # F = 0 at theta = pi - 2 phi, where s / s' is 2 zeta / omega; then on
        restitution, duration = cmath.exp(-slope * 2 * turned), 2 * turned / rate + 2 * zeta / omega
    else:  # from the deepest point on undamped
        restitution, duration = cmath.exp(-slope * turned), turned / rate + math.pi / (2 * omega)
    force = mass * omega * speed * cmath.exp(-slope * (turned - 2 * phi)) if zeta < 0.5 else damping * speed
    return Impact(*(complex(x).real for x in (restitution, duration, deepest, force)))


def passing(shape, miss, speed=3.0):
    """The source passes straight, without gravity, and misses a touch by `miss` (negative: overlap)."""
    values = head_on(shape, "outside")
    across = np.cross(AXIS, ACROSS)
    along = 0.3 * AXIS if shape == "cylinder" else 0.0
    values["source.center"] = ((0.6 + miss) * ACROSS - 2.0 * across + along).tolist()
    values["source.initial_velocity"] = (speed * across).tolist()
    return values
