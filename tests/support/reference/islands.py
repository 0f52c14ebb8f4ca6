"""An independent reference for several contacts at once: balls and fixed planes, each pair with its laws.

Between two changes of a regime the motion is integrated by DOP853 of scipy; a change is located on its
dense output. Everything is in the world frame; arrays have a row for each ball or contact. The elastic
friction needs a dashpot (DESIGN sections 1 and 7)."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

APART, FULL, CLIPPED, SPRING_ONLY = range(4)  # regimes of the normal force
TOUCH, DASHPOT, STICK = range(3)  # kinds of events
LONGEST = 4e-3  # s; a shorter graze between the samples of a step could be missed
SAMPLES = 8  # of the events in a step


@dataclass
class Regimes:
    normal: np.ndarray
    sticks: np.ndarray


class Islands:
    """`balls` and `contacts` are lists of dicts; a contact's destination is a ball, or plane -1 or -2"""

    def __init__(self, balls, planes, contacts, gravity):
        def of(items, name):
            return np.array([one[name] for one in items], float)

        self.radius, mass = of(balls, "radius"), of(balls, "mass")
        free = np.array([one["motion"] == "free" for one in balls])
        turns = np.array([one["rotation"] == "free" for one in balls])
        self.by_mass = np.where(free, 1.0 / mass, 0.0)[:, None]
        self.by_inertia = np.where(turns, 2.5 / (mass * self.radius**2), 0.0)[:, None]
        self.bare = free[:, None] * np.array(gravity, float) + self.by_mass * of(balls, "force")
        self.i, self.j = (np.array([one[name] for one in contacts]) for name in ("source", "destination"))
        self.flat = (self.j < 0)[:, None]
        rows = [planes[-1 - j] if j < 0 else np.zeros((2, 3)) for j in self.j]
        self.normals, self.places = (np.array([row[k] for row in rows]) for k in (0, 1))
        self.ball = np.where(self.j < 0, 0, self.j)
        self.k, self.c, self.mu, self.mu_static, self.v_0, self.k_t, self.c_t = (
            of(contacts, name) for name in ("k", "c", "mu", "mu_static", "v_0", "k_t", "c_t")
        )
        self.hertz = np.array([one["law"] == "hertz" for one in contacts])
        self.friction = np.array([one["friction"] for one in contacts])
        damped = self.c > 0.0
        self.clips = damped & np.array([one["dashpot"] == "non_adhesive" for one in contacts])
        self.halves = damped & np.array([one["dashpot"] == "approach_only" for one in contacts])
        self.start = np.concatenate(
            [
                *(of(balls, name).ravel() for name in ("center", "velocity", "spin")),
                np.zeros(3 * len(contacts)),
            ]
        )

    def parts(self, y):
        """Returns places, velocities, spins, springs."""
        n = 3 * len(self.radius)
        return (part.reshape(-1, 3) for part in (y[:n], y[n : 2 * n], y[2 * n : 3 * n], y[3 * n :]))

    def geometry(self, y):
        """Returns gaps, their rates, the normals from the sources, and how they turn."""
        x, v, _, _ = self.parts(y)
        apart = np.where(self.flat, self.places, x[self.ball]) - x[self.i]
        moving = np.where(self.flat, 0.0, v[self.ball]) - v[self.i]
        distance = np.where(self.flat[:, 0], -dots(apart, self.normals), np.sqrt(dots(apart, apart)))
        normal = np.where(self.flat, -self.normals, apart / distance[:, None])
        rate = dots(normal, moving)
        turning = np.where(self.flat, 0.0, (moving - rate[:, None] * normal) / distance[:, None])
        reach = self.radius[self.i] + np.where(self.flat[:, 0], 0.0, self.radius[self.ball])
        return distance - reach, rate, normal, turning

    def law(self, gap, rate, regimes):
        """Normal force before it is clipped"""
        rate = np.where(regimes.normal == SPRING_ONLY, 0.0, rate)
        hertz = self.k * np.maximum(-gap, 0.0) ** 1.5 * (1.0 - self.c * rate)
        return np.where(self.hertz, hertz, -self.k * gap - self.c * rate)

    def forces(self, y, regimes):
        """Of all contacts: normal and friction forces, |F*|, rates of the springs, and lever arms"""
        x, v, spin, spring = self.parts(y)
        gap, rate, normal, turning = self.geometry(y)
        acts = (regimes.normal == FULL) | (regimes.normal == SPRING_ONLY)
        force = np.where(acts, self.law(gap, rate, regimes), 0.0)
        arm = self.radius[self.i][:, None] * normal
        other = x[self.i] + arm - np.where(self.flat, 0.0, x[self.ball])
        surface = np.where(self.flat, 0.0, v[self.ball] + np.cross(spin[self.ball], other))
        slip = v[self.i] + np.cross(spin[self.i], arm) - surface
        slip = slip - dots(slip, normal)[:, None] * normal
        limit, speed = self.mu * np.maximum(force, 0.0), np.sqrt(dots(slip, slip))
        smooth = limit * np.expm1(-speed / self.v_0) / np.where(speed > 0.0, speed, 1.0)
        trial = self.k_t[:, None] * spring + self.c_t[:, None] * slip
        size = np.sqrt(dots(trial, trial))
        lifted = (force <= 0.0)[:, None]
        pull = np.where(lifted, 0.0, (limit / np.where(size > 0.0, size, 1.0))[:, None] * trial)
        sticks = regimes.sticks[:, None] & ~lifted
        elastic = np.where(sticks, -trial, -pull)
        friction = np.where((self.friction == "elastic")[:, None], elastic, smooth[:, None] * slip)
        friction = np.where((acts & (self.friction != "none"))[:, None], friction, 0.0)
        stretched = np.where(sticks, slip, (pull - self.k_t[:, None] * spring) / self.c_t[:, None])
        stretched -= dots(spring, turning)[:, None] * normal
        stretched[(self.friction != "elastic") | (regimes.normal == APART)] = 0.0
        return force, friction, size, stretched, normal, arm, other

    def rates(self, y, regimes):
        _, v, _, _ = self.parts(y)
        force, friction, _, stretched, normal, arm, other = self.forces(y, regimes)
        on_source = friction - force[:, None] * normal
        pushed, turned = np.zeros_like(v), np.zeros_like(v)
        np.add.at(pushed, self.i, on_source)
        np.add.at(turned, self.i, np.cross(arm, on_source))
        balls = ~self.flat[:, 0]
        np.subtract.at(pushed, self.j[balls], on_source[balls])
        np.subtract.at(turned, self.j[balls], np.cross(other, on_source)[balls])
        accelerations = self.bare + self.by_mass * pushed
        return np.concatenate([x.ravel() for x in (v, accelerations, self.by_inertia * turned, stretched)])

    def events(self, y, regimes):
        """[kind, contact]: positive within the regimes, 1 where there is no event"""
        gap, rate, _, _ = self.geometry(y)
        touching = regimes.normal != APART
        found = np.ones((3, len(gap)))
        found[TOUCH] = np.where(touching, -gap, gap)
        push = np.where(self.hertz, 1.0 - self.c * rate, self.law(gap, rate, regimes))
        clip = np.where(regimes.normal == CLIPPED, -push, push)
        half = np.where(regimes.normal == SPRING_ONLY, rate, -rate)
        found[DASHPOT] = np.where(touching & self.clips, clip, np.where(touching & self.halves, half, 1.0))
        if (self.friction == "elastic").any():
            force, _, size, *_ = self.forces(y, regimes)
            stick = np.where(regimes.sticks, self.mu_static * force - size, size - self.mu * force)
            found[STICK] = np.where((self.friction == "elastic") & touching & (force > 0.0), stick, 1.0)
        return found

    def first_regimes(self, y):
        gap, rate, _, _ = self.geometry(y)
        regimes = Regimes(np.where(gap < 0.0, FULL, APART), np.ones(len(gap), bool))
        regimes.normal[(gap < 0.0) & self.halves & (rate > 0.0)] = SPRING_ONLY
        pulls = (regimes.normal == FULL) & self.clips & (self.law(gap, rate, regimes) < 0.0)
        regimes.normal[pulls] = CLIPPED
        force, _, size, *_ = self.forces(y, regimes)
        regimes.sticks = self.mu_static * force > size
        return regimes

    def change(self, y, regimes, kind, contact):
        """Returns the regimes after an event."""
        normal = regimes.normal[contact]
        if kind == STICK:
            regimes.sticks[contact] = not regimes.sticks[contact]
        elif kind == DASHPOT:
            other = SPRING_ONLY if self.halves[contact] else CLIPPED
            regimes.normal[contact] = other if normal == FULL else FULL
            regimes.sticks[contact] &= self.halves[contact]  # F_n has no jump where the dashpot alone ends
        elif normal == APART:
            regimes.normal[contact] = FULL
            regimes.sticks[contact] = True
            force, _, size, *_ = self.forces(y, regimes)
            regimes.sticks[contact] = self.mu_static[contact] * force[contact] > size[contact]
        else:
            regimes.normal[contact] = APART
            list(self.parts(y))[3][contact] = 0.0

    def run(self, end, tolerance, longest=LONGEST):
        """Returns places, velocities and spins at the end, and how many contacts began. `longest` is a
        step."""
        time, y, onsets = 0.0, self.start.copy(), 0
        regimes = self.first_regimes(y)
        while time < end:
            found, time, y = self.up_to_event(time, y, end, regimes, tolerance, longest)
            if found:
                onsets += found[0] == TOUCH and regimes.normal[found[1]] == APART
                self.change(y, regimes, *found)
        return np.hstack(list(self.parts(y))[:3]), onsets

    def up_to_event(self, time, y, end, regimes, tolerance, longest):
        solver = DOP853(
            lambda _, y: self.rates(y, regimes), time, y, end, rtol=tolerance, atol=1e-14, max_step=longest,
            first_step=min(1e-6, end - time),
        )  # fmt: skip
        while solver.status == "running":
            solver.step()
            dense = solver.dense_output()
            places = np.linspace(solver.t_old, solver.t, SAMPLES + 1)
            samples = np.array([self.events(dense(place), regimes) for place in places])
            overdue = np.argwhere((samples < 0.0).all(axis=0))  # the regime had ended before it began
            if len(overdue):
                return tuple(overdue[0]), solver.t_old, dense(solver.t_old)
            for k in range(SAMPLES):
                falls = np.argwhere((samples[k] >= 0.0) & (samples[k + 1] < 0.0))
                if len(falls):
                    ends = places[k : k + 2]
                    place, *event = min((self.root(dense, regimes, tuple(at), ends), *at) for at in falls)
                    return event, place, dense(place)
        return None, end, solver.y

    def root(self, dense, regimes, at, ends):
        options = {"xtol": 1e-300, "rtol": 4e-15, "maxiter": 1000}
        return brentq(lambda time: self.events(dense(time), regimes)[at], *ends, **options)


def dots(a, b):
    return np.einsum("ij,ij->i", a, b)
