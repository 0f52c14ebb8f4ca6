"""Vectors of three numbers and quaternions (w, x, y, z) for turning.py, of real or complex numbers: an
imaginary part of 1e-30 carries a derivative along."""

import cmath
import math


def add(a, b):
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def times(factor, a):
    return [factor * a[0], factor * a[1], factor * a[2]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def root(x):
    return cmath.sqrt(x) if isinstance(x, complex) else math.sqrt(x)


def norm(a):
    return root(dot(a, a))


def unit(a):
    return times(1 / norm(a), a)


def first_orientation(axis):
    """The smallest rotation that takes e_z to the axis; about x where it is -e_z."""
    w = 1 + axis[2]
    if w.real < 1e-15:
        return [0.0, 1.0, 0.0, 0.0]
    size = root(w * w + axis[0] ** 2 + axis[1] ** 2)
    return [w / size, -axis[1] / size, axis[0] / size, 0.0]


def turned_axis(q):
    """Third column of the rotation matrix of q, which need not be of unit length."""
    w, x, y, z = q
    size = w * w + x * x + y * y + z * z
    return [2 * (x * z + w * y) / size, 2 * (y * z - w * x) / size, (w * w - x * x - y * y + z * z) / size]


def quaternion_rate(q, omega):
    """q' = (0, omega) q / 2, omega in the world."""
    w, x, y, z = q
    a, b, c = omega
    return [
        -0.5 * (a * x + b * y + c * z),
        0.5 * (a * w + b * z - c * y),
        0.5 * (b * w + c * x - a * z),
        0.5 * (c * w + a * y - b * x),
    ]
