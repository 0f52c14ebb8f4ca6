"""References for stiff lasting contact: a ball let go at the wall of a hollow cylinder or sphere (problem P3
with any penalty factor), in coordinates in which the overlap is a variable of its own.

With the wall's radius for the centre R, the overlap s, the angle a from the lowest line and the latitude b
(0 in a cylinder, where y moves on by itself), x = r cos b sin a, y = r sin b, z = -r cos b cos a, r = R + s:

    s'' = r b'^2 + r cos^2 b a'^2 + g cos b cos a - (p_n s + p_nv s')/m
    b'' = -2 s' b'/r - sin b cos b a'^2 - g sin b cos a/r
    a'' = -2 s' a'/r + 2 tan b b' a' - g sin a/(r cos b)

The unknowns for s are the spring's force p_n s and sqrt(m p_n) s', which stay of order 1 however stiff it is.
"""

from math import cos, pi, sin, sqrt, tan

import numpy as np
from scipy.integrate import solve_ivp

MASS, GRAVITY, RADIUS, SPEED, ANGLE = 0.1, 9.81, 0.45, 0.1, pi / 3


def turning(r, s_rate, a, a_rate, b, b_rate):
    """a'', b''"""
    a_second = -2 * s_rate * a_rate / r + 2 * tan(b) * b_rate * a_rate - GRAVITY * sin(a) / (r * cos(b))
    b_second = -2 * s_rate * b_rate / r - sin(b) * cos(b) * a_rate**2 - GRAVITY * sin(b) * cos(a) / r
    return a_second, b_second


def outward(r, a, a_rate, b, b_rate):
    """s'' without the contact"""
    return r * b_rate**2 + r * (cos(b) * a_rate) ** 2 + GRAVITY * cos(b) * cos(a)


def start_angles(shape):
    return [ANGLE, 0.0, 0.0, SPEED / RADIUS if shape == "sphere" else 0.0]


def position(shape, r, a, b, end):
    return np.array(
        [r * cos(b) * sin(a), r * sin(b) if shape == "sphere" else SPEED * end, -r * cos(b) * cos(a)]
    )


def damped_motion(shape, penalty, damping, end, tolerance):
    """(position at the end, least spring force after the first quarter oscillation) by Radau IIA of scipy;
    `damping` as a part of the critical one."""
    frequency, mass_root = sqrt(penalty / MASS), sqrt(penalty * MASS)

    def rates(_time, y):
        r, s_rate = RADIUS + y[0] / penalty, y[1] / mass_root
        a_second, b_second = turning(r, s_rate, *y[2:])
        force = y[0] + 2 * damping * y[1]
        return [
            frequency * y[1],
            frequency * (MASS * outward(r, *y[2:]) - force),
            *(y[3], a_second, y[5], b_second),
        ]

    solution = solve_ivp(
        rates, (0.0, end), [0.0, 0.0, *start_angles(shape)], "Radau", rtol=tolerance, atol=tolerance
    )
    late = solution.t > 0.5 * pi / frequency
    y = solution.y[:, -1]
    return position(shape, RADIUS + y[0] / penalty, y[2], y[4], end), solution.y[0, late].min()
