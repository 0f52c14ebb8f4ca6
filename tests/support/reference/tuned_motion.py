"""An independent reference for parameters that change during a run: scipy's DOP853, piece by piece.

A ball of 0.1 m and 1 kg meets a fixed sphere of 0.5 m at the origin. From one change of parameters or of the
force law's branch to the next the equations are smooth; each piece is integrated to the accuracy of doubles
and starts from the state at the end of the one before, with the parameters of its own.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

REACH = 0.6  # m, sum of the radii
APART, FULL, SPRING, CLIPPED = range(4)
VISCOUS, DASHPOT = "contact.viscous_penalty_factor", "contact.dashpot"


@dataclass
class TunedMotion:
    """`values`: penalty factor, viscous penalty factor, dashpot and gravity by their FMI names."""

    values: dict
    position: np.ndarray
    velocity: np.ndarray
    time: float = 0.0
    dissipated: float = 0.0
    external_work: float = 0.0
    branch: int = field(default=APART)

    def gap(self, y):
        return np.linalg.norm(y[:3]) - REACH

    def rate(self, y):
        return y[:3] @ y[3:6] / np.linalg.norm(y[:3])

    def formula(self, y):
        return -self.values["contact.penalty_factor"] * self.gap(y) - self.values[VISCOUS] * self.rate(y)

    def force(self, y):
        spring = -self.values["contact.penalty_factor"] * self.gap(y)
        return {APART: 0.0, CLIPPED: 0.0, FULL: self.formula(y), SPRING: spring}[self.branch]

    def right_side(self, _, y):
        normal, force = y[:3] / np.linalg.norm(y[:3]), self.force(y)
        spring = 0.0 if self.branch == APART else -self.values["contact.penalty_factor"] * self.gap(y)
        power = -(force - spring) * self.rate(y)
        return [*y[3:6], *(np.array(self.values["gravity"]) + force * normal), power]

    def state(self):
        return np.array([*self.position, *self.velocity, self.dissipated])

    def branch_by_law(self, y):
        if self.values[DASHPOT] == "non_adhesive" and self.formula(y) <= 0:
            return CLIPPED
        return SPRING if self.values[DASHPOT] == "approach_only" and self.rate(y) >= 0 else FULL

    def energies(self):
        """Potential and stored energy"""
        y = self.state()
        stored = (
            0.0 if self.branch == APART else 0.5 * self.values["contact.penalty_factor"] * self.gap(y) ** 2
        )
        return -np.array(self.values["gravity"]) @ self.position + stored

    def change(self, values):
        before = self.energies()
        self.values = {**self.values, **values}
        self.external_work += self.energies() - before
        if self.branch != APART:
            self.branch = self.branch_by_law(self.state())

    def ends(self):
        """What ends the branch, each with the branch after it"""
        touch = (lambda _, y: self.gap(y), -1, None)
        part = (lambda _, y: self.gap(y), 1, APART)
        if self.branch == APART:
            return [touch]
        kind = self.values[DASHPOT]
        if kind == "non_adhesive":
            sign = -1 if self.branch == FULL else 1
            return [part, (lambda _, y: self.formula(y), sign, CLIPPED if self.branch == FULL else FULL)]
        if kind == "approach_only":
            sign = 1 if self.branch == FULL else -1
            return [part, (lambda _, y: self.rate(y), sign, SPRING if self.branch == FULL else FULL)]
        return [part]

    def advance(self, end):
        while self.time < end:
            ends, events = self.ends(), []
            for function, direction, _ in ends:
                event = lambda t, y, f=function: f(t, y)  # noqa: E731
                event.terminal, event.direction = True, direction
                events.append(event)
            piece = solve_ivp(
                self.right_side,
                (self.time, end),
                self.state(),
                "DOP853",
                events=events,
                rtol=1e-13,
                atol=1e-16,
            )
            assert piece.success, piece.message
            y = piece.y[:, -1]
            self.time, self.position, self.velocity, self.dissipated = piece.t[-1], y[:3], y[3:6], y[6]
            for (_, _, after), found in zip(ends, piece.t_events, strict=True):
                if len(found):
                    self.branch = self.branch_by_law(y) if after is None else after
