"""Rates of the state of turning.py: Newton and Euler, the two laws of friction, and what is summed up.

`touching` and `sticking` say which side of its events the contact is on; they are remembered by who
integrates, not recomputed from a rounded gap.
"""

from types import SimpleNamespace

import numpy as np

from support.reference.turning import DISSIPATED, EACH, FRICTION, SIZE, SPRING, SUMS, TINY, WORK, ZERO
from support.reference.turning_vectors import add, cross, dot, minus, norm, quaternion_rate, times

SHORT = 1e-9  # m; below, its direction follows that of the slip within a thousandth of a degree


def along_spring(spring, slip, rate):
    """Unit vector of the spring; that of the slip while the bodies approach, at `rate`, and the spring is too
    short to have one of its own.
    """
    size = norm(spring)
    if size > (SHORT if rate < 0 else 0.0):
        return times(1 / size, spring)
    size = norm(slip)
    return times(1 / size, slip) if size > 0.0 else list(ZERO)


def friction_of(pair, place, force, slip, spring, sticking):
    """Friction force on the source, and the rate of the spring before it is turned with the normal; None
    where the spring is at its limit and its rate follows from the limit's.
    """
    if pair.friction == "none":
        return list(ZERO), list(ZERO)
    if pair.friction == "regularized":
        speed = norm(slip)
        if speed == 0.0:
            return list(ZERO), list(ZERO)
        return times(pair.limit(force) * np.expm1(-speed / pair.v_0) / speed, slip), list(ZERO)
    if sticking:
        return times(-1.0, pair.trial(place, spring)), slip
    limit = pair.limit(force)
    if pair.c_t == 0.0:
        if limit == 0.0:  # no force holds a spring
            return list(ZERO), list(ZERO)
        return times(-limit, along_spring(spring, slip, place.rate)), None
    trial = pair.trial(place, spring)
    size = norm(trial)
    pull = times(limit / size, trial) if size > 0.0 else list(ZERO)
    return times(-1.0, pull), times(1 / pair.c_t, minus(pull, times(pair.k_t(place.gap), spring)))


def resistance_of(pair, place, force):
    """Torque on the source that opposes its rolling and its spinning on the destination."""
    spin = minus(place.src.omega, place.dst.omega)
    along = times(dot(spin, place.n), place.n)
    total = list(ZERO)
    for kind, rate in (("rolling", minus(spin, along)), ("spinning", along)):
        speed = norm(rate)
        if kind in pair.resisted and force.real > 0.0 and speed.real > 0.0:
            lever, unit = pair.resisted[kind]
            total = add(total, times(lever * force * np.expm1(-speed / unit) / speed, rate))
    return total, spin


def forces(pair, y, touching, sticking):
    """Everything that acts at one instant."""
    place = pair.geometry(y)
    now = SimpleNamespace(
        place=place, force=0.0, friction=list(ZERO), spring_rate=list(ZERO), slip=list(ZERO)
    )
    now.on_source = now.source_torque = now.destination_torque = now.resistance = list(ZERO)
    if not touching:
        return now
    spring = y[SPRING:SUMS]
    now.force = pair.normal_force(place.gap, place.rate)
    now.slip, arm, other = pair.slip(place)
    now.friction, now.spring_rate = friction_of(pair, place, now.force, now.slip, spring, sticking)
    now.on_source = add(times(-pair.side * now.force, place.n), now.friction)
    now.resistance, now.spin = resistance_of(pair, place, now.force)
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
    place, spring = now.place, y[SPRING:SUMS]
    # The dashpot's part, F_n less the spring's, takes its power from the normal motion.
    kept = pair.stiffness * max(-place.gap, 0.0) ** 1.5 if pair.hertz else -pair.stiffness * place.gap
    out[DISSIPATED] = -(now.force - kept) * place.rate
    out[SUMS : SUMS + 9] = now.on_source + now.source_torque + now.destination_torque
    out[FRICTION] = -dot(now.friction, now.slip) - dot(now.resistance, now.spin)
    if pair.friction == "elastic":
        rate = now.spring_rate
        if rate is None:
            rate, _ = at_limit(pair, y, now, out)
        out[SPRING:SUMS] = minus(rate, times(dot(spring, place.n_rate), place.n))
    return out


def longest_rate(pair, y, out):
    """Rate of L / k_t along the motion `out`, by the imaginary part."""
    moved = [complex(a, TINY * b) for a, b in zip(y[:SPRING], out[:SPRING], strict=True)]
    place = pair.geometry(moved)
    force = pair.normal_force(place.gap, place.rate)
    if force.real <= 0:
        return 0.0
    limit, k_t = pair.limit(force), pair.k_t(place.gap)
    return (limit.imag - limit.real * k_t.imag / k_t.real) / TINY / k_t.real


def growth_of_limit(pair, y):
    """The same while nothing rubs yet."""
    out = [0.0] * SIZE
    body_rates(pair, y, forces(pair, y, True, False), out)
    moved = [complex(a, TINY * b) for a, b in zip(y[:SPRING], out[:SPRING], strict=True)]
    place = pair.geometry(moved)
    return pair.mu_static * pair.law_force(place.gap, place.rate).imag / TINY


def at_limit(pair, y, now, out):
    """Rate of a spring without dashpot that slides at its limit, and how fast the contact slides along it."""
    unit = along_spring(y[SPRING:SUMS], now.slip, now.place.rate)
    grows = longest_rate(pair, y, out)
    along = dot(now.slip, unit)
    if norm(y[SPRING:SUMS]) < SHORT:  # keeps its direction up to the release, which costs no steps
        return times(grows, unit), norm(now.slip)
    across = minus(now.slip, times(along, unit))
    return add(across, times(grows, unit)), along - grows


def sliding_rate(pair, y):
    """lambda of the definitions: while it is positive the contact slides."""
    out = [0.0] * SIZE
    now = forces(pair, y, True, False)
    if now.spring_rate is not None:
        return norm(now.slip)
    body_rates(pair, y, now, out)
    return at_limit(pair, y, now, out)[1]
