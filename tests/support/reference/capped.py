"""An independent reference for capped cylinders: the equations of motion in world coordinates, as DESIGN
sections 1 and 6 write them, by Dormand and Prince's method of order 8 (scipy), which stops at every touch,
release, change of the dashpot and edge between side, cap and rim.

The gap is the distance of the ball's centre from the solid, less its radius: of a box [0, r_d] x [-L/2, L/2]
in the half-plane of rho and z, turned about the axis. Zones matter to it only in that the integrator starts
anew at their edges, and where the force turns round: half-way between the caps, and at the axis.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

SETTINGS = {"method": "DOP853", "rtol": 2.5e-14, "atol": 1e-16}
APART, FULL, SPRING, CLIPPED = "apart", "full", "spring", "clipped"
BEYOND = 1e-18  # a place on the other side of the axis [m], less than any rounding here
PARTS_OF_A_RADIAN = 0.05  # longest step in contact, so that the dense output is as good as the steps


class CappedPair(NamedTuple):
    radius: float
    other_radius: float
    length: float
    axis: tuple
    masses: tuple  # infinity does not move
    gravity: tuple
    hertz: bool = False
    stiffness: float = 1e6
    damping: float = 0.0  # p_nv, or chi
    dashpot: str = "non_adhesive"

    def place(self, y):
        """dr and dz, the unit vectors along which they grow, and the rate as the cylinder sees it."""
        p, w = y[0:3] - y[3:6], y[6:9] - y[9:12]
        e = np.array(self.axis)
        z = p @ e
        across = p - z * e
        rho = np.linalg.norm(across)
        outward = across / rho if rho > 0 else np.zeros(3)
        return rho - self.other_radius, abs(z) - self.length / 2, outward, np.copysign(1.0, z) * e, w

    def gap_and_rate(self, y):
        dr, dz, outward, up, w = self.place(y)
        if dr > 0 and dz > 0:
            d = np.hypot(dr, dz)
            n = (dr * outward + dz * up) / d
        else:
            d, n = (dr, outward) if dr >= dz else (dz, up)
        return d - self.radius, n @ w, n

    def zone(self, y):
        dr, dz, *_ = self.place(y)
        return "rim" if dr > 0 and dz > 0 else "side" if dr >= dz else "cap"

    def force(self, gap, rate, branch):
        if branch in (APART, CLIPPED):
            return 0.0
        damping = self.damping if branch == FULL else 0.0
        if self.hertz:
            return self.stiffness * max(-gap, 0.0) ** 1.5 * (1 - damping * rate)
        return -self.stiffness * gap - damping * rate

    def stored(self, gap, branch):
        depth = max(-gap, 0.0) if branch != APART else 0.0
        return 0.4 * self.stiffness * depth**2.5 if self.hertz else 0.5 * self.stiffness * depth**2

    def rates(self, branch, y):
        gap, rate, n = self.gap_and_rate(y)
        force = self.force(gap, rate, branch)
        out = np.concatenate([y[6:12], np.zeros(6)])
        for i, sign in ((0, 1), (1, -1)):
            if np.isfinite(self.masses[i]):
                out[6 + 3 * i : 9 + 3 * i] = np.array(self.gravity) + sign * force / self.masses[i] * n
        return out

    def pull(self, y, branch):
        """Falls through zero where the dashpot changes the branch."""
        gap, rate, _ = self.gap_and_rate(y)
        if self.damping == 0 or self.dashpot == "unclamped":
            return 1.0
        if self.dashpot == "approach_only":
            return -rate if branch == FULL else rate
        if self.hertz:
            return 1 - self.damping * rate if branch == FULL else self.damping * rate - 1
        full = self.force(gap, rate, FULL)
        return full if branch == FULL else -full

    def after_pull(self, branch):
        if branch != FULL:
            return FULL
        return SPRING if self.dashpot == "approach_only" else CLIPPED

    def branch_at(self, y):
        gap, rate, _ = self.gap_and_rate(y)
        if gap > 0 or (gap == 0 and rate >= 0):
            return APART
        other = self.after_pull(FULL)
        return FULL if self.pull(y, FULL) > 0 else other

    def longest(self, y):
        """A step in contact that resolves its oscillation."""
        per_mass = sum(1 / m for m in self.masses)
        depth = max(-self.gap_and_rate(y)[0], 1e-4 * self.radius)
        slope = 1.5 * self.stiffness * depth**0.5 if self.hertz else self.stiffness
        return PARTS_OF_A_RADIAN / np.sqrt(slope * per_mass)


def pair_of(values):
    """The pair of a scene's values"""
    hertz = values.get("contact.law") == "hertz"
    damped = "contact.hunt_crossley_factor" if hertz else "contact.viscous_penalty_factor"
    free = values.get("destination.motion") == "free"
    return CappedPair(
        radius=values["source.radius"],
        other_radius=values["destination.radius"],
        length=values["destination.length"],
        axis=tuple(values["destination.axis"]),
        masses=(values.get("source.mass", 1.0), values["destination.mass"] if free else np.inf),
        gravity=tuple(values["gravity"]),
        hertz=hertz,
        stiffness=values["contact.hertz_stiffness" if hertz else "contact.penalty_factor"],
        damping=0.0 if values.get("contact.method") == "penalty" else values[damped],
        dashpot=values.get("contact.dashpot", "non_adhesive"),
    )


def follow(values, end):
    """The scene from its start to `end`, its destination without a velocity at first"""
    still = [0.0, 0.0, 0.0]
    start = [*values["source.center"], *still, *values.get("source.initial_velocity", still), *still]
    return run(pair_of(values), start, end)


def _away(pair, y, zone):
    """From the axis, or from half-way between the caps: the side on which the force is the present one."""
    _, _, outward, up, _ = pair.place(y)
    return up if zone == "cap" else outward


def _events(pair, branch, zone, away):
    """Functions of (t, y) that are positive until the event."""

    def edge(_t, y):
        dr, dz, *_ = pair.place(y)
        return {
            "rim": min(dr, dz),
            "side": min(dr, 0.0) - dz,
            "cap": min(dz, 0.0) - dr,
        }[zone]

    def opening(_t, y):
        gap = pair.gap_and_rate(y)[0]
        return gap if branch == APART else -gap

    functions = [edge, opening] if branch == APART else [edge, opening, lambda _t, y: pair.pull(y, branch)]
    if branch != APART and zone != "rim":
        functions.append(lambda _t, y: (y[0:3] - y[3:6]) @ away)
    for function in functions:
        function.terminal, function.direction = True, -1.0
    return functions


class Contact(NamedTuple):
    state: np.ndarray  # positions, velocities
    zones: list  # (time, zone) whenever it changes in contact
    changes: list  # (time, branch)
    lost: float  # energy, by the balance


def energy(pair, y, branch):
    total = pair.stored(pair.gap_and_rate(y)[0], branch)
    for i in range(2):
        if np.isfinite(pair.masses[i]):
            x, v = y[3 * i : 3 * i + 3], y[6 + 3 * i : 9 + 3 * i]
            total += pair.masses[i] * (v @ v / 2 - np.array(pair.gravity) @ x)
    return total


def run(pair, y, end):
    """From y = (x_s, x_d, v_s, v_d) at 0 to `end`."""
    y, time = np.array(y, float), 0.0
    branch, zone = pair.branch_at(y), pair.zone(y)
    before = energy(pair, y, branch)
    zones, changes = [(0.0, zone)], []
    while time < end:
        away = _away(pair, y, zone)
        functions = _events(pair, branch, zone, away)
        longest = pair.longest(y) if branch != APART else 0.02 * end
        part = solve_ivp(
            lambda _t, state, now=branch: pair.rates(now, state),
            (time, end), y, events=functions, max_step=longest, first_step=min(longest, end - time) * 1e-3,
            dense_output=True, **SETTINGS,
        )  # fmt: skip
        if part.status != 1:
            return Contact(part.y[:, -1], zones, changes, before - energy(pair, part.y[:, -1], branch))
        which = next(i for i, found in enumerate(part.t_events) if found.size)
        time, y = part.t_events[which][0], part.y_events[which][0].copy()
        time, y = _land(pair, functions[which], part, time, y, branch)
        if which == 0:
            zone = _zone_beyond(pair, y, zone)
            zones.append((time, zone))
            if branch != APART and max(pair.place(y)[:2]) < 0:
                branch = pair.branch_at(y)  # inside the solid the force jumps
            if branch == APART and pair.gap_and_rate(y)[0] <= 0 and pair.branch_at(y) != APART:
                branch = pair.branch_at(y)  # they touch on the very edge
                changes.append((time, branch))
        elif which == 3:
            y[0:3] -= ((y[0:3] - y[3:6]) @ away + BEYOND) * away
            branch = pair.branch_at(y)
        else:
            if which == 1:
                y = _close(pair, y)
            branch = FULL if branch == APART else APART if which == 1 else pair.after_pull(branch)
            changes.append((time, branch))
    return Contact(y, zones, changes, before - energy(pair, y, branch))


def _land(pair, function, part, time, y, branch):
    """One more step from the last accepted point to the root, which the dense output only estimates."""
    start = part.t[-2] if len(part.t) > 1 else part.t[0]
    from_y = part.sol(start)

    def state(to):
        if to <= start:
            return from_y
        return solve_ivp(
            lambda _t, now: pair.rates(branch, now), (start, to), from_y, **SETTINGS
        ).y[:, -1]  # fmt: skip

    width = 1e-6 * max(time - start, 1e-12)
    low, high = max(start, time - width), time + width
    if function(low, state(low)) > 0 > function(high, state(high)):
        time = brentq(lambda to: function(to, state(to)), low, high, xtol=1e-18, rtol=1e-15)
        y = state(time)
    return time, y


def _zone_beyond(pair, y, zone):
    """The zone on the other side of the edge where y is, to rounding."""
    dr, dz, *_ = pair.place(y)
    if zone == "rim":
        return "cap" if dr < dz else "side"
    if zone == "side":
        return "rim" if dr > 0 else "cap"
    return "rim" if dz > 0 else "side"


def _close(pair, y):
    """The gap is zero at a touch and a release."""
    gap, _, n = pair.gap_and_rate(y)
    y[0:3] -= gap * n
    return y
