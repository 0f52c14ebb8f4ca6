"""A ball pressed on a body by a force that fades and turns: it lets go once, when the closed form says,
whatever the stiffness and the dashpot.

With the force F0 - F1 t towards the body, at rest with s = F0 / k before, the penetration s obeys

    m s'' + c s' + k s = F0 - F1 t,
    s = (F0 - F1 t) / k + c F1 / k^2 + two exponentials

until s = 0 (unclamped) or until k s + c s' = 0 (non_adhesive), from where on the force alone acts."""

import math
from functools import cache

import numpy as np
import pytest
from mpmath import mp, mpf

from support.checks import FMU, check_close, run, start
from support.scenes.head_on import ACROSS, AXIS, GEOMETRIES, approach, head_on

mp.dps = 50
METHOD = "event_driven"
FORCE, RATE, END = 10.0, 20.0, 1.0  # N, N/s, s: it turns at half time
FACTOR = 10
STIFFNESSES = [1e5, 1e7, 1e9, 1e11, 1e13, 1e15]
SHARES = [0.1, 0.9, 1.5, 10.0]  # of the critical dashpot
WORK = 100_000


def bisected(value, low, high):
    """Returns the root of a function that is positive before it and negative after it."""
    for _ in range(150):
        middle = (low + high) / 2
        low, high = (middle, high) if value(middle) > 0 else (low, middle)
    return (low + high) / 2


@cache
def lift_off(dashpot, stiffness, share):
    """Returns when it lets go (s = 0), and how far and fast the ball of 1 kg is off the body at the end."""
    k, force, rate, end = mpf(stiffness), mpf(FORCE), mpf(RATE), mpf(END)
    c = mpf(damping(stiffness, share))
    root = mp.sqrt(mp.mpc(c * c / 4 - k))
    fast, slow = -c / 2 - root, -c / 2 + root
    # s(0) = F0 / k, s'(0) = 0
    first, second = -c * rate / k**2, rate / k
    weight_slow = (second - fast * first) / (slow - fast)
    weight_fast = first - weight_slow

    def depth(t):
        swing = weight_slow * mp.exp(slow * t) + weight_fast * mp.exp(fast * t)
        return (force - rate * t) / k + c * rate / k**2 + mp.re(swing)

    def speed(t):
        swing = weight_slow * slow * mp.exp(slow * t) + weight_fast * fast * mp.exp(fast * t)
        return -rate / k + mp.re(swing)

    if dashpot == "unclamped":
        loose = bisected(depth, force / rate / 2, end)
        away, velocity = mpf(0), -speed(loose)
    else:
        loose = bisected(lambda t: k * depth(t) + c * speed(t), force / rate / 2, end)
        away, velocity = -depth(loose), -speed(loose)
    pull = rate * loose - force  # outward at `loose`, growing by `rate`

    def distance(t):
        return away + velocity * t + pull * t**2 / 2 + rate * t**3 / 6

    apart = mpf(0) if away == 0 else bisected(lambda t: -distance(t), mpf(0), end)
    left = end - loose
    return loose + apart, distance(left), velocity + pull * left + rate * left**2 / 2


def damping(stiffness, share):
    return 2 * share * math.sqrt(stiffness)


def pressed(shape, location, dashpot, stiffness, share):
    inward = approach(location)
    values = head_on(shape, location, gap=0.0, speed=0.0)
    values |= {"source.initial_displacement": (FORCE / stiffness * inward).tolist()}
    values |= {"source.external_force": (FORCE * inward).tolist()}
    values |= {"source.external_force.derivatives": [(-RATE * inward).tolist()]}
    values |= {"contact.method": "penalty_dynamic", "contact.dashpot": dashpot}
    values |= {"contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": damping(stiffness, share)}
    return values


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("steps", [1, 97])
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("stiffness", STIFFNESSES)
@pytest.mark.parametrize("dashpot", ["unclamped", "non_adhesive"])
def test_a_fading_force_lets_go_once(opened, dashpot, stiffness, share, steps, tolerance):
    shape, location = GEOMETRIES[(SHARES.index(share) + STIFFNESSES.index(stiffness)) % len(GEOMETRIES)]
    values = pressed(shape, location, dashpot, stiffness, share)
    values["solver.max_internal_steps"] = WORK // steps
    fmu = run(opened(FMU[shape]), values, END, steps, tolerance, METHOD)
    loose, away, velocity = (float(x) for x in lift_off(dashpot, stiffness, share))
    assert fmu["contact.onsets"] == 1
    assert fmu["contact.active"] is False
    place = np.array(values["source.center"]) - away * approach(location)
    check_close("position", fmu["source.position"], place, FACTOR * tolerance)
    check_close("velocity", fmu["source.velocity"], -velocity * approach(location), FACTOR * tolerance)
    late = 16 * np.finfo(float).eps * stiffness / RATE  # until (F0 - F1 t) / k is a rounding of 1 m
    allowed = 1000 * tolerance + late  # the tolerance is one on the depth, which fades slowly
    check_close("last_duration", fmu["contact.last_duration"], loose, allowed)
    assert fmu["solver.steps"] <= 2000


@pytest.mark.parametrize("end", [1e-7, 2.5, 1000.0])
def test_a_body_drawn_off_leaves_its_small_impulse(opened, shape, end):
    """A spring pressed by s gives k s^2 / (2 V) until it lets go after s / V, which is small against a turn
    of its oscillation and against its tolerance."""
    stiffness, mass, speed, depth = 1e5, 75.0, 0.3, 2e-8
    values = head_on(shape, "outside", gap=-depth, speed=0.0, contact_penalty_factor=stiffness)
    values |= {"source.mass": mass, "destination.motion": "prescribed"}
    values["destination.prescribed_velocity"] = (-speed * ACROSS + 0.2 * AXIS).tolist()
    fmu = start(opened(FMU[shape]), values, 1e-9, METHOD)
    depth, energy = -fmu["contact.gap"], fmu["energy.total"]
    fmu.step(end)
    impulse = stiffness * depth**2 / (2 * speed)
    check_close("velocity", fmu["source.velocity"], impulse / mass * ACROSS, 1e-8 * impulse / mass)
    check_close("work", fmu["energy.external_work"], -energy, 1e-8 * energy)
    check_close("last_duration", fmu["contact.last_duration"], depth / speed, 1e-8 * depth / speed)


def test_a_load_takes_off_a_body_that_touches_at_1e_12_m_per_s(opened, shape):
    values = head_on(shape, "outside", gap=0.0, speed=1e-12, contact_penalty_factor=1e3)
    values |= {"source.mass": 1.0, "source.external_force": ACROSS.tolist()}
    fmu = run(opened(FMU[shape]), values, 0.1, 1, 1e-9, METHOD)
    check_close("velocity", fmu["source.velocity"], 0.1 * ACROSS, 1e-11)
    assert fmu["contact.last_duration"] < 1e-11
