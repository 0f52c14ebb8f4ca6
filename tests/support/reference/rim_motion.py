"""A reference for stiff contact at the rim of a capped cylinder: a ball on a fixed solid, in coordinates in
which the gap is a variable of its own.

With the azimuth p about the axis, the tilt t of the normal, the gap x, the distance r = r_s + x from the rim
and w = r_d + r cos t from the axis; n, u and b point along the normal, across and along the circle:

    x'' = r t'^2 + w p'^2 cos t + g.n + F/m
    t'' = (g.u - w p'^2 sin t - 2 x' t')/r
    p'' = (g.b - 2 w' p')/w,   w' = x' cos t - r t' sin t

The unknowns for x are parts of the depth at the start and of the speed with which its oscillation would have
that size: they stay of order 1 however stiff the contact is."""

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class RimMotion(NamedTuple):
    radius: float
    other_radius: float
    half_length: float
    gravity: tuple
    stiffness: float
    damping: float = 0.0  # p_nv, or chi
    hertz: bool = False
    mass: float = 1.0

    def force(self, gap, rate):
        if self.hertz:
            return self.stiffness * max(-gap, 0.0) ** 1.5 * (1 - self.damping * rate)
        return -self.stiffness * gap - self.damping * rate

    def slope(self, gap):
        return 1.5 * self.stiffness * sqrt(-gap) if self.hertz else self.stiffness

    def turning(self, gap, rate, tilt, tilt_rate, azimuth, azimuth_rate):
        """Returns x'' without the contact, t'', p''."""
        c, s, r = cos(tilt), sin(tilt), self.radius + gap
        w = self.other_radius + r * c
        gx, gy, gz = self.gravity
        outward, hoop = gx * cos(azimuth) + gy * sin(azimuth), gy * cos(azimuth) - gx * sin(azimuth)
        spin = w * azimuth_rate**2
        push = r * tilt_rate**2 + spin * c + outward * c + gz * s
        tilting = (gz * c - outward * s - spin * s - 2 * rate * tilt_rate) / r
        turning = (hoop - 2 * (rate * c - r * tilt_rate * s) * azimuth_rate) / w
        return push, tilting, turning

    def state(self, gap, rate, tilt, tilt_rate, azimuth, azimuth_rate):
        """Returns position and velocity in space."""
        r = self.radius + gap
        w = self.other_radius + r * cos(tilt)
        outward = np.array([cos(azimuth), sin(azimuth), 0.0])
        hoop, up = np.array([-sin(azimuth), cos(azimuth), 0.0]), np.array([0.0, 0.0, 1.0])
        position = w * outward + (self.half_length + r * sin(tilt)) * up
        velocity = (rate * cos(tilt) - r * tilt_rate * sin(tilt)) * outward + w * azimuth_rate * hoop
        return np.concatenate([position, velocity + (rate * sin(tilt) + r * tilt_rate * cos(tilt)) * up])


def run(motion, start, end, method="Radau", tolerance=1e-12):
    """`start`: gap, rate, tilt, its rate, azimuth, its rate; the same at `end`."""
    depth = -start[0]
    speed = depth * sqrt(motion.slope(-depth) / motion.mass)

    def rates(_time, y):
        gap, rate = -depth * y[0], -speed * y[1]
        push, tilting, turning = motion.turning(gap, rate, *y[2:])
        bend = push + motion.force(gap, rate) / motion.mass
        return [speed / depth * y[1], -bend / speed, y[3], tilting, y[5], turning]

    begin = [1.0, -start[1] / speed, *start[2:]]
    y = solve_ivp(rates, (0.0, end), begin, method, rtol=tolerance, atol=tolerance).y[:, -1]
    return np.array([-depth * y[0], -speed * y[1], *y[2:]])
