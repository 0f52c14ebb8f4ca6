"""Checks of bodies that turn: as in claims.py, the expected values come from closed forms
(turning_forms.py).
"""

from __future__ import annotations

import numpy as np

from . import turning_forms
from .claims import Outcome, _gravity, _mass, _worst_point, check
from .experiment import Recording


@check
def slides_then_rolls(run: Recording) -> Outcome:
    """Place of a ball along x at every communication point, on a level plane"""
    speed, spin = run.value("source.velocity")[0], run.value("source.angular_velocity")[1]
    slip = speed - run.value("source.radius") * spin
    friction = run.value("contact.friction_coefficient")
    way, _ = turning_forms.slide_to_roll(run.time, speed, slip, friction, _gravity(run))
    expected = run.series["source.position"].copy()
    expected[:, 0] = run.value("source.position")[0] + way
    return _worst_point(run, "source.position", expected, "m")


@check
def rolls_at_last(run: Recording) -> Outcome:
    """Velocity of that ball at the end"""
    speed, spin = run.value("source.velocity")[0], run.value("source.angular_velocity")[1]
    slip = speed - run.value("source.radius") * spin
    friction = run.value("contact.friction_coefficient")
    _, final = turning_forms.slide_to_roll(run.time[-1:], speed, slip, friction, _gravity(run))
    return Outcome(run.final["source.velocity"], [float(final[0]), 0.0, 0.0], "m/s")


@check
def rolls_round_a_tube(run: Recording) -> Outcome:
    """Place of a ball in a vertical tube at every communication point"""
    x, speed = run.value("source.position")[0], run.value("source.velocity")[1]
    rate = speed / x
    height = turning_forms.vertical_tube(run.time, rate, _gravity(run))
    angle = rate * run.time
    expected = np.stack([x * np.cos(angle), x * np.sin(angle), height], axis=-1)
    return _worst_point(run, "source.position", expected, "m")


@check
def rolls_on_a_turntable(run: Recording) -> Outcome:
    """Place of a ball on a plane that turns about z, at every communication point"""
    rate = run.value("destination.prescribed_angular_velocity")[2]
    start, velocity = run.value("source.position"), run.value("source.velocity")
    place, _ = turning_forms.turntable(run.time, start[:2], velocity[:2], rate)
    expected = np.concatenate([place, np.full((len(place), 1), start[2])], axis=1)
    return _worst_point(run, "source.position", expected, "m")


@check
def tumbles(run: Recording) -> Outcome:
    """Speeds along y of ball and cylinder and the cylinder's angular velocity about x, at the end: the ball
    came along y, the cylinder lay along z
    """
    inertia = _moment(run)
    lever = run.value("source.position")[2] - run.value("destination.position")[2]
    speed = run.value("source.velocity")[1]
    expected = turning_forms.hit_beside(
        speed, _mass(run, "source"), _mass(run, "destination"), inertia, lever
    )
    found = run.final["source.velocity"][1], run.final["destination.velocity"][1]
    return Outcome([*found, -run.final["destination.angular_velocity"][0]], expected, "m/s")


@check
def angular_momentum(run: Recording) -> Outcome:
    """Largest change of the angular momentum about the origin of a ball that does not turn and a free
    cylinder, gravity off, against the bodies' own
    """
    parts = [
        _mass(run, body) * np.cross(run.series[f"{body}.position"], run.series[f"{body}.velocity"])
        for body in ("source", "destination")
    ]
    axis, spin = run.series["destination.current_axis"], run.series["destination.angular_velocity"]
    along = 0.5 * _mass(run, "destination") * run.value("destination.radius") ** 2
    turning = np.sum(spin * axis, axis=1, keepdims=True) * axis
    parts.append(_moment(run) * (spin - turning) + along * turning)
    total = np.sum(parts, axis=0)
    largest = float(max(np.max(np.abs(part)) for part in parts))
    return Outcome(float(np.max(np.abs(total - total[0]))), 0.0, "kg.m2/s", largest)


def _moment(run: Recording) -> float:
    values = (run.value(f"destination.{name}") for name in ("mass", "radius", "length"))
    return turning_forms.moment_across(*values)
