"""A compound body on a plane or in a hole from first principles, apart from the FMU: numpy alone, with
rotation matrices, and scipy's integration of the six degrees of freedom.

Each part is a sphere of radius r at R o from the centre of mass x. With the outward normal n of a plane
through the origin, or the one to the axis z of a hole of radius r_d, from which the sphere's centre has the
distance rho,

    plane: g = n.(x + R o) - r,   hole: g = r_d - r - rho,   g' = n.(v + omega x R o),   p = x + R o - r n
    u = v + omega x (p - x), its part across n is the slip
    F_n = max(-p_n g - p_nv g', 0) while g < 0,   F_t = -mu F_n (1 - exp(-|u_t|/v_0)) u_t/|u_t|
    F = F_n n + F_t,   tau = (p - x) x F

The functions are analytic where they are not cut off, so that a complex step gives derivatives."""

import numpy as np
from scipy.integrate import solve_ivp

from support.reference.kept import kept


def matrix(q):
    """Returns the rotation matrix of a quaternion w, x, y, z of any length."""
    w, x, y, z = q / np.sqrt(np.sum(q * q))
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


class Foot:
    """Parts as (radius, centre in the body's frame), and one law for all of them"""

    def __init__(self, parts, p_n, p_nv=0.0, mu=0.0, v_0=1.0, normal=(0.0, 0.0, 1.0)):
        self.parts = [(radius, np.array(center)) for radius, center in parts]
        self.p_n, self.p_nv, self.mu, self.v_0, self.normal = p_n, p_nv, mu, v_0, np.array(normal)

    def surface(self, place):
        """Returns the height of a sphere's centre above the surface, and the normal there."""
        return self.normal @ place, self.normal

    def gap(self, k, x, rotation):
        radius, center = self.parts[k]
        return self.surface(x + rotation @ center)[0] - radius

    def contact(self, k, x, v, q, omega):
        """Returns gap, force and torque about the centre of mass."""
        radius, center = self.parts[k]
        rotation = matrix(q)
        height, n = self.surface(x + rotation @ center)
        gap = height - radius
        gap_rate = n @ (v + np.cross(omega, rotation @ center))
        arm = rotation @ center - radius * n
        slip = v + np.cross(omega, arm)
        slip = slip - (n @ slip) * n
        force = -self.p_n * gap - self.p_nv * gap_rate
        if np.real(gap) >= 0.0 or np.real(force) <= 0.0:
            return gap, np.zeros(3), np.zeros(3)
        speed = np.sqrt(np.sum(slip * slip))
        rubbing = 0.0 * slip
        if np.real(speed) > 0.0:
            rubbing = -self.mu * force * (1.0 - np.exp(-speed / self.v_0)) * slip / speed
        total = force * n + rubbing
        return gap, total, np.cross(arm, total)

    def total(self, x, v, q, omega):
        """Returns force and torque of all parts."""
        all_of_them = [self.contact(k, x, v, q, omega)[1:] for k in range(len(self.parts))]
        return sum(force for force, _ in all_of_them), sum(torque for _, torque in all_of_them)


class Pin(Foot):
    """Parts in a hole of radius `hole` about z"""

    def __init__(self, hole, *more):
        super().__init__(*more)
        self.hole = hole

    def surface(self, place):
        rho = np.sqrt(place[0] ** 2 + place[1] ** 2)
        return self.hole - rho, -np.array([place[0], place[1], 0.0]) / rho


class FreeBody:
    """Newton's and Euler's equations of a body with the mass m and three moments of inertia on `foot`"""

    def __init__(self, foot, mass, inertia, gravity=(0.0, 0.0, -9.81)):
        self.foot, self.mass, self.inertia, self.gravity = foot, mass, np.array(inertia), np.array(gravity)

    def rates(self, _t, y):
        x, v, q, omega = y[:3], y[3:6], y[6:10], y[10:]
        force, torque = self.foot.total(x, v, q, omega)
        rotation = matrix(q)
        inverse = rotation @ np.diag(1.0 / self.inertia) @ rotation.T
        momentum = rotation @ (self.inertia * (rotation.T @ omega))
        w, p = q[0], q[1:]
        turned = np.array([-omega @ p, *(w * omega + np.cross(omega, p))]) / 2.0
        spun = inverse @ (torque - np.cross(omega, momentum))
        return np.concatenate([v, self.gravity + force / self.mass, turned, spun])

    def run(self, y, end):
        """Returns the state at `end`."""
        scene = [vars(self.foot), self.mass, self.inertia, self.gravity, y, end]
        return kept(scene, lambda: self.integrated(y, end))

    def integrated(self, y, end):
        """Returns the state at `end`. Steps go from touch to touch, so that none crosses a change of the law.
        The dense output that finds a touch is coarser than a step, so that Newton's method ends there."""

        def gap_of(k):
            def gap(_t, y):
                return self.foot.gap(k, y[:3], matrix(y[6:10]))

            gap.terminal = True
            return gap

        options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15, "max_step": 1e-3}
        gaps = [gap_of(k) for k in range(len(self.foot.parts))]
        y, time = np.array(y, float), 0.0
        while time < end:
            found = solve_ivp(self.rates, (time, end), y, events=gaps, **options)
            if not any(map(len, found.t_events)):
                return found.y[:, -1]
            gap = next(gap for gap, times in zip(gaps, found.t_events, strict=True) if len(times))
            touch = found.t[-1]
            y = solve_ivp(self.rates, (time, touch), y, **options).y[:, -1]
            for _ in range(3):
                rates = self.rates(touch, y)
                late = 1e-7 * gap(0.0, y) / (gap(0.0, y + 1e-7 * rates) - gap(0.0, y))
                y, touch = y - late * rates, touch - late
            beyond = 1e-13 * max(touch, 1e-3)  # so short that it changes nothing
            y, time = y + beyond * self.rates(touch, y), touch + beyond
        return y

    def energy(self, y):
        rotation = matrix(y[6:10])
        turning = 0.5 * np.sum(self.inertia * (rotation.T @ y[10:]) ** 2)
        height = self.mass * (self.gravity @ y[:3])
        gaps = [min(self.foot.gap(k, y[:3], rotation), 0.0) for k in range(len(self.foot.parts))]
        moving = 0.5 * self.mass * (y[3:6] @ y[3:6]) + turning
        return moving - height + 0.5 * self.foot.p_n * (np.array(gaps) @ gaps)
