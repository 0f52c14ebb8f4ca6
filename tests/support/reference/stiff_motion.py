"""Lasting contact with a very stiff wall: an asymptotic expansion in 1/p_n, beyond the reach of integrators.

Let x be the source's centre seen from the destination's (across the axis of a cylinder), d = |x|,
n = x / d, R = r_d - r_s (inside) or r_d + r_s (outside), s = d - R, L = x cross x', a the constant
acceleration of x without the contact and m the effective mass. With w^2 = p_n / m and
2 zeta w = p_nv / m the motion in contact is

    n' = L cross n / d^2,    L' = d n cross a,    s'' = A - w^2 s - 2 zeta w s',    A = |L|^2 / d^3 + a.n

Off its fast oscillation, s is a series in 1/w of quantities of the slow motion (s' and s'' follow from A):

    s_0 = A(R) / w^2,    s_1 = A(R + s_0) / w^2 - 2 zeta A' / w^3 - A'' / w^4,
    A' = 3 L.(n cross a) / R^2,    A'' = 3 (|n cross a|^2 - |L|^2 a.n / R^3) / R

(order 0: a bead on a circle or sphere of radius R + s_0). The oscillation s(0) - s_1(0) dies or goes on with
the angle w t and, because only the curvature of the path changes w, with constant amplitude. It moves n and L
by its integral, amplitude / w. What is left out is smaller than the step from order 0 to order 1, times (2
zeta + 1) / w per second of the slow motion's time scale, and the integral of the oscillation."""

from math import cos, pi, sin, sqrt, tan
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from support.reference.law import ReferenceContact, complete, start_motion

EXACT = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-15}


class End(NamedTuple):
    position: np.ndarray  # of the source [m]
    destination: np.ndarray  # of the destination [m]
    left_out: float  # what the next order could change, generously [m]
    least_push: float  # the smallest A on the way, positive towards the wall [m/s^2]


class StiffContact:
    """Configuration of a ReferenceContact; a destination is fixed, free, or prescribed at one acceleration"""

    def __init__(self, configuration, shape):
        given = {k: v for k, v in configuration.items() if not k.endswith(".derivatives")}
        law, values = ReferenceContact(given, shape), complete(given)
        start = start_motion(values)
        free = values["destination.motion"] == "free"
        self.mass = np.array([values["source.mass"], values["destination.mass"] if free else np.inf])
        self.effective = 1 / np.sum(1 / self.mass)
        self.side = 1.0 if law.location == "inside" else -1.0
        self.reach = float(law.destination_radius - self.side * law.source_radius)
        self.angular = np.sqrt(float(law.penalty) / self.effective)
        self.share = float(law.viscous) / (2 * self.effective * self.angular)
        self.axis = np.zeros(3) if law.axis is None else np.float64(law.axis)
        centers = [np.array(values[f"{body}.center"]) for body in ("source", "destination")]
        moved = [np.float64(start.source_displacement), np.float64(start.destination_displacement)]
        self.speed = [np.float64(start.source_velocity), np.float64(start.destination_velocity)]
        self.place = [center + shift for center, shift in zip(centers, moved, strict=True)]
        gravity, moved_by = np.array(values["gravity"]), np.zeros(3)
        if values["destination.motion"] == "prescribed":
            rates = configuration.get("destination.prescribed_velocity.derivatives", [[0.0] * 3])
            moved_by = np.array(rates[0])
        pushes = [np.array(values[f"{body}.external_force"]) for body in ("source", "destination")]
        self.pull = [
            gravity + pushes[0] / self.mass[0],
            gravity + pushes[1] / self.mass[1] if free else moved_by,
        ]
        self.acceleration = self.across(self.pull[0] - self.pull[1])

    def across(self, vector):
        return vector - (vector @ self.axis) * self.axis

    def penetration(self, n, turn, order):
        """s and s' of the slow motion"""
        w, R, a = self.angular, self.reach, self.acceleration
        first = (turn @ turn / R**3 + a @ n) / w**2
        twist = np.cross(n, a)
        rate, bend = 3 * turn @ twist / R**2, 3 * (twist @ twist - (turn @ turn) * (a @ n) / R**3) / R
        if order == 0:
            return first, 0.0
        push = turn @ turn / (R + first) ** 3 + a @ n
        return push / w**2 - 2 * self.share * rate / w**3 - bend / w**4, rate / w**2

    def slow(self, state, order):
        n, turn = state[:3] / np.linalg.norm(state[:3]), state[3:]
        distance = self.reach + self.penetration(n, turn, order)[0]
        return np.concatenate([np.cross(turn, n) / distance**2, distance * np.cross(n, self.acceleration)])

    def relative_end(self, end, order):
        """x across the axis at the end, the least push, and the share of the curvature's part in w"""
        apart = self.across(self.place[0] - self.place[1])
        speed = self.across(self.speed[0] - self.speed[1])
        distance = np.linalg.norm(apart)
        n = apart / distance
        start = np.concatenate([n, np.cross(apart, speed)])
        solution = solve_ivp(lambda t, y: self.slow(y, order), (0, end), start, **EXACT)
        inwards = [y[3:] @ y[3:] / self.reach**3 + self.acceleration @ y[:3] for y in solution.y.T]
        depth, rate = self.penetration(n, start[3:], order)
        last = solution.y[:3, -1] / np.linalg.norm(solution.y[:3, -1])
        final = self.penetration(last, solution.y[3:, -1], order)[0]
        shift = distance - self.reach - depth
        swing = self.oscillation(shift, speed @ n - rate, end)
        fastest = max(y[3:] @ y[3:] for y in solution.y.T) / self.reach**4
        late = abs(shift) * np.exp(-self.share * self.angular * end) * 3 * fastest * end / (2 * self.angular)
        return (self.reach + final + swing) * last, min(self.side * np.array(inwards)), late

    def oscillation(self, shift, rate, end):
        """Returns the free oscillation s'' + 2 zeta w s' + w^2 s = 0 from s = shift, s' = rate."""
        w, zeta = self.angular, self.share
        damped = w * np.sqrt(1 - zeta**2)
        first = (rate + zeta * w * shift) / damped
        return np.exp(-zeta * w * end) * (shift * np.cos(damped * end) + first * np.sin(damped * end))

    def end(self, time):
        gap = self.place[0] - self.place[1]
        coarse, _, _ = self.relative_end(time, 0)
        fine, push, late = self.relative_end(time, 1)
        along = (gap + (self.speed[0] - self.speed[1]) * time) @ self.axis
        along += (self.pull[0] - self.pull[1]) @ self.axis * time**2 / 2
        apart = fine + along * self.axis
        motions = zip(self.place, self.speed, self.pull, strict=True)
        alone = [x + v * time + a * time**2 / 2 for x, v, a in motions]
        destination = alone[1]
        if np.isfinite(self.mass[1]):  # the centre of mass moves as if nothing touched
            middle = (self.mass @ np.array(alone)) / self.mass.sum()
            destination = middle - apart * self.mass[0] / self.mass.sum()
        depth = max(abs(np.linalg.norm(x) - self.reach) for x in (coarse, fine))
        left_out = 5 * (np.linalg.norm(fine - coarse) + depth) * (2 * self.share + 1) / self.angular
        return End(destination + apart, destination, left_out + late + 1e-13, push)

    def settled(self):
        """Displacement and velocity to add to the source, so that nothing oscillates"""
        apart = self.across(self.place[0] - self.place[1])
        n = apart / np.linalg.norm(apart)
        turn = np.cross(apart, self.across(self.speed[0] - self.speed[1]))
        depth, rate = self.penetration(n, turn, 1)
        return depth * n, rate * n


# References for stiff lasting contact: a ball let go at the wall of a hollow cylinder or sphere (problem P3
# with any penalty factor), in coordinates in which the overlap is a variable of its own.
#
# With the wall's radius for the centre R, the overlap s, the angle a from the lowest line and the latitude b
# (0 in a cylinder, where y moves on by itself), x = r cos b sin a, y = r sin b, z = -r cos b cos a,
# r = R + s:
#
#     s'' = r b'^2 + r cos^2 b a'^2 + g cos b cos a - (p_n s + p_nv s')/m
#     b'' = -2 s' b'/r - sin b cos b a'^2 - g sin b cos a/r
#     a'' = -2 s' a'/r + 2 tan b b' a' - g sin a/(r cos b)
#
# The unknowns for s are the spring's force p_n s and sqrt(m p_n) s', of order 1 however stiff it is.

MASS, GRAVITY, RADIUS, SPEED, ANGLE = 0.1, 9.81, 0.45, 0.1, pi / 3


def turning(r, s_rate, a, a_rate, b, b_rate):
    """Returns a'', b''."""
    a_second = -2 * s_rate * a_rate / r + 2 * tan(b) * b_rate * a_rate - GRAVITY * sin(a) / (r * cos(b))
    b_second = -2 * s_rate * b_rate / r - sin(b) * cos(b) * a_rate**2 - GRAVITY * sin(b) * cos(a) / r
    return a_second, b_second


def outward(r, a, a_rate, b, b_rate):
    """s'' without the contact"""
    return r * b_rate**2 + r * (cos(b) * a_rate) ** 2 + GRAVITY * cos(b) * cos(a)


def start_angles(shape):
    return [ANGLE, 0.0, 0.0, SPEED / RADIUS if shape == "sphere" else 0.0]


def position(shape, r, a, b, end):
    y = r * sin(b) if shape == "sphere" else SPEED * end
    return np.array([r * cos(b) * sin(a), y, -r * cos(b) * cos(a)])


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

    begin = [0.0, 0.0, *start_angles(shape)]
    solution = solve_ivp(rates, (0.0, end), begin, "Radau", rtol=tolerance, atol=tolerance)
    late = solution.t > 0.5 * pi / frequency
    y = solution.y[:, -1]
    return position(shape, RADIUS + y[0] / penalty, y[2], y[4], end), solution.y[0, late].min()
