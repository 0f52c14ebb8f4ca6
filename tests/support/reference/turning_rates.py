"""Rates of the state of turning.py: Newton and Euler, the two laws of friction, and what is summed up.

`touching` says which side of its events the contact is on, and `sticking` names the opposed motions that
stick; they are remembered by who integrates, not recomputed from a rounded gap.
"""

from types import SimpleNamespace

import numpy as np

from support.reference.turning import (
    DISSIPATED,
    EACH,
    FRICTION,
    KINDS,
    SIZE,
    SPRING,
    SPRINGS,
    SUMS,
    TINY,
    WORK,
    ZERO,
)
from support.reference.turning_vectors import add, cross, dot, minus, norm, quaternion_rate, times

SHORT = 1e-9  # m or rad; below, its direction follows that of the slip within a thousandth of a degree


def along_spring(spring, slip, rate):
    """Unit vector of the spring; that of the slip while the bodies approach, at `rate`, and the spring is too
    short to have one of its own."""
    size = norm(spring)
    if size > (SHORT if rate < 0 else 0.0):
        return times(1 / size, spring)
    size = norm(slip)
    return times(1 / size, slip) if size > 0.0 else list(ZERO)


def friction_of(pair, one, place, force, motion, spring, sticking):
    """Force or torque that opposes a motion by the law `one`, and the rate of the spring before it is turned
    with the normal; None where the spring is at its limit and its rate follows from the limit's."""
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
    """Everything that acts at one instant."""
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
    """Rate of L / k along the motion `out`, by the imaginary part."""
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
    """Rate of a spring without dashpot that slides at its limit, and how fast the contact slides along it."""
    one, spring, motion = pair.opposed[kind], y[SPRINGS[kind]], now.motion[kind]
    unit = along_spring(spring, motion, now.place.rate)
    grows = longest_rate(pair, one, y, out)
    along = dot(motion, unit)
    if norm(spring) < SHORT:  # keeps its direction up to the release, which costs no steps
        return times(grows, unit), norm(motion)
    across = minus(motion, times(along, unit))
    return add(across, times(grows, unit)), along - grows


def sliding_rate(pair, kind, y, sticking):
    """lambda of the definitions: while it is positive the contact slides."""
    out = [0.0] * SIZE
    now = forces(pair, y, True, [one for one in sticking if one != kind])
    if now.spring_rate[kind] is not None:
        return norm(now.motion[kind])
    body_rates(pair, y, now, out)
    return at_limit(pair, kind, y, now, out)[1]
