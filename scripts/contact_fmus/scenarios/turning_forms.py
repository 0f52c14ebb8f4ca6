"""What theory says about solid balls that roll and slide, and a cylinder that is hit. SI units; every
function is checked numerically in tests/scenarios.

A solid ball has I = 2/5 m a^2: where a force at its surface moves its centre by 1, it moves the surface by
7/2. All forms are limits: friction that needs no slip to hold (v_0 = 0), surfaces that do not yield (p_n
infinite).
"""

from __future__ import annotations

import math

import numpy as np

BALL = 2.0 / 5.0


def slide_to_roll(
    time: np.ndarray, speed: float, slip: float, friction: float, g: float
) -> tuple[np.ndarray, np.ndarray]:
    """Way and speed of a ball set down on a plane with `speed`, its surface slipping by `slip` (speed - a
    omega): slowed by mu g until t = 2 slip/(7 mu g), and rolling evenly from then on.
    """
    slowing = math.copysign(friction * g, slip)
    sliding = np.minimum(time, slip / (3.5 * slowing))
    velocity = speed - slowing * sliding
    return speed * sliding - 0.5 * slowing * sliding**2 + velocity * (time - sliding), velocity


def vertical_tube(time: np.ndarray, rate: float, g: float) -> np.ndarray:
    """Height of a ball that rolls round a vertical tube `rate` rad/s, from rest in height, without spin
    about the radius: a harmonic motion of sqrt(2/7) of the rate, down by 5 g/rate^2 and up again.
    """
    return -2.5 * g / rate**2 * (1.0 - np.cos(math.sqrt(2.0 / 7.0) * rate * time))


def turntable(
    time: np.ndarray, start: np.ndarray, velocity: np.ndarray, rate: float
) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity in the plane of a ball that rolls on a plane which turns about the origin: a
    circle, gone round at 2/7 of the rate, since v' = (2/7) rate e_z x v.
    """
    orbit = rate * BALL / (1.0 + BALL)
    middle = start + np.array([-velocity[1], velocity[0]]) / orbit
    cosine, sine = np.cos(orbit * time), np.sin(orbit * time)

    def turned(v: np.ndarray) -> np.ndarray:
        return np.stack([cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]], axis=-1)

    return middle + turned(start - middle), turned(velocity)


def moment_across(mass: float, radius: float, length: float) -> float:
    """Of a solid cylinder, about a line across its axis through its middle"""
    return mass * (3.0 * radius**2 + length**2) / 12.0


def hit_beside(speed: float, ball: float, cylinder: float, inertia: float, lever: float) -> tuple[float, ...]:
    """Speeds of ball and cylinder and the cylinder's angular velocity after an elastic impact across its
    axis, `lever` from its middle: an impulse 2 v/(1/m_1 + 1/m_2 + h^2/I).
    """
    impulse = 2.0 * speed / (1.0 / ball + 1.0 / cylinder + lever**2 / inertia)
    return speed - impulse / ball, impulse / cylinder, lever * impulse / inertia
