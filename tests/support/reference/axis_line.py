"""A reference for motion straight through the axis of a solid cylinder: one place s across it and its rate.

m s'' = sign(s) F_n + m a with F_n of the gap |s| - reach: within a regime a linear equation with constant
coefficients, solved by the exponential of its matrix; the regime ends at the first root of its conditions.
"""

import math

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

PLACES = 24  # in each radian of the motion, to find roots between


def root_between(value, low, high):
    """Where a value that falls from low to high is zero; the places are rounded, so it may be at an end."""
    if value(low) <= 0.0:
        return low
    return brentq(value, low, high, xtol=1e-300, rtol=1e-15) if value(high) < 0.0 else high


class Line:
    def __init__(self, s, rate, mass, reach, stiffness, damping, dashpot, pull=0.0):
        self.s, self.rate, self.mass, self.reach, self.pull = s, rate, mass, reach, pull
        self.k, self.c, self.dashpot = stiffness, damping, dashpot
        self.time = self.last_onset = self.last_duration = 0.0
        self.onsets = self.events = 0
        self.full = True  # spring and dashpot; else what the dashpot leaves
        self.side = math.copysign(1.0, s)
        self.touching = abs(s) < reach or (abs(s) == reach and s * rate < 0.0)
        if self.touching:
            self.begin()

    def begin(self):
        self.onsets += 1
        self.last_onset = self.time
        self.full = self.law(np.array([self.s, self.rate])) > 0.0

    def law(self, x):
        """Above zero while the dashpot acts"""
        gap, rate = self.side * x[0] - self.reach, self.side * x[1]
        if not self.c or self.dashpot == "unclamped":
            return 1.0
        return -rate if self.dashpot == "approach_only" else -(self.k * gap + self.c * rate)

    def matrix(self):
        spring = self.touching and (self.full or self.dashpot == "approach_only")
        k = self.k / self.mass if spring else 0.0
        c = self.c / self.mass if self.touching and self.full else 0.0
        return np.array([[0, 1, 0], [-k, -c, self.pull + self.side * k * self.reach], [0, 0, 0]])

    def conditions(self):
        """Each above zero as long as the regime lasts"""
        if not self.touching:
            return {"gap": lambda x: abs(x[0]) - self.reach}
        return {
            "gap": lambda x: self.reach - abs(x[0]),
            "centre": lambda x: self.side * x[0],
            "law": (lambda x: self.law(x)) if self.full else (lambda x: -self.law(x)),
        }

    def first_event(self, left, just):
        matrix, start = self.matrix(), np.array([self.s, self.rate, 1.0])

        def state(t):
            return expm(matrix * t) @ start

        radians = left * (math.sqrt(abs(matrix[1, 0])) + abs(matrix[1, 1]) + 1.0)
        count = 2 + int(PLACES * radians)
        step = expm(matrix * (left / count))
        states = [start]
        for _ in range(count):
            states.append(step @ states[-1])
        # Events right after the start need a closer look.
        soon = np.geomspace(1e-9, 1.0, 12)[:-1] * left / count
        times = np.concatenate([[0.0], soon, np.arange(1, count + 1) * left / count])
        states = [start, *(state(t) for t in soon), *states[1:]]
        first, event = left, None
        for name, condition in self.conditions().items():
            values = [condition(x) for x in states]
            for i in range(1 if name == just else 0, len(times) - 1):
                if values[i] > 0.0 and values[i + 1] <= 0.0:
                    root = root_between(lambda t, of=condition: of(state(t)), times[i], times[i + 1])
                    first, event = (root, name) if root < first else (first, event)
                    break
        return first, event, state(first)

    def run(self, end):
        event = None
        while self.time < end:
            step, event, x = self.first_event(end - self.time, event)
            self.s, self.rate = x[0], x[1]
            self.time += step
            if event is None:
                self.last_duration = end - self.last_onset if self.touching else self.last_duration
                return self
            self.events += 1
            self.happen(event)
        return self

    def happen(self, event):
        if event == "centre":
            self.side, self.s = -self.side, 0.0
            self.full = self.law(np.array([0.0, self.rate])) > 0.0
        elif event == "law":
            self.full = not self.full
        elif self.touching:
            self.touching, self.last_duration = False, self.time - self.last_onset
        else:
            self.touching, self.side = True, math.copysign(1.0, self.s)
            self.s = self.side * self.reach
            self.begin()
