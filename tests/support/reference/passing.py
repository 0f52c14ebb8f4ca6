"""What is true of two given motions that pass by, by the closed form of the gap.

Both paths are polynomials of degree two, so d^2 is one of degree four: between the roots of its slope d is
monotone, and so is the gap. Regimes change where the gap, the force or the gap rate is zero; each root is
bracketed and found by scipy's brentq. Impulse, dissipated energy and work are quadratures of smooth functions
between these roots.
"""

import functools
import itertools
import math

import numpy as np
from numpy.polynomial import Polynomial
from scipy.optimize import brentq, minimize_scalar

APART, COMPRESSION, RESTITUTION, SEPARATING = range(4)


def vector_path(values, body):
    """Three polynomials of time: where the body's centre is."""
    center = np.array(values.get(f"{body}.center", [0.0, 0.0, 0.0]))
    if values.get(f"{body}.motion") != "prescribed":
        return [Polynomial([x]) for x in center]
    velocity = np.array(values.get(f"{body}.prescribed_velocity", [0.0, 0.0, 0.0]))
    bend = np.array(values.get(f"{body}.prescribed_velocity.derivatives", [[0.0, 0.0, 0.0]])[0])
    return [Polynomial([x, u, 0.5 * a]) for x, u, a in zip(center, velocity, bend, strict=True)]


def roots_of(polynomial, end):
    """Where the polynomial changes its sign in (0, end): between the roots of its slope, by bisection."""
    trimmed = polynomial.trim()
    if trimmed.degree() < 1:
        return []
    places = [0.0, *roots_of(trimmed.deriv(), end), end]
    found = []
    for low, high in itertools.pairwise(places):
        if trimmed(low) * trimmed(high) < 0:
            found.append(brentq(trimmed, low, high, xtol=1e-300, rtol=1e-15))
    return found


class Passing:
    """The truth of one scene."""

    def __init__(self, values, end):
        self.values, self.end = values, end
        self.side = -1 if values["contact.location"] == "inside" else 1
        r_s, r_d = values["source.radius"], values["destination.radius"]
        self.r_s, self.r_d = r_s, r_d
        self.k = (
            0.0 if values["contact.penalty_control"] == "viscous_only" else values["contact.penalty_factor"]
        )
        self.p = 0.0 if values["contact.method"] == "penalty" else values["contact.viscous_penalty_factor"]
        self.dashpot = values.get("contact.dashpot", "unclamped") if self.p > 0 else "unclamped"
        source, destination = vector_path(values, "source"), vector_path(values, "destination")
        self.velocity = {
            "source": [x.deriv() for x in source],
            "destination": [x.deriv() for x in destination],
        }
        c = [d - s for s, d in zip(source, destination, strict=True)]
        self.half_length = math.inf
        if "destination.axis" in values:
            e = np.array(values["destination.axis"]) / np.linalg.norm(values["destination.axis"])
            self.axial = sum(x * y for x, y in zip(c, e, strict=True))
            c = [x - self.axial * y for x, y in zip(c, e, strict=True)]
            if values.get("destination.finite_length"):
                self.half_length = 0.5 * values["destination.length"]
        self.c, self.w = c, [x.deriv() for x in c]
        self._run()

    def at(self, time):
        """Gap, gap rate, direction"""
        c = np.array([x(time) for x in self.c])
        w = np.array([x(time) for x in self.w])
        d = np.linalg.norm(c)
        n = c / d
        gap = (d - self.r_s) - self.r_d if self.side > 0 else (self.r_d - d) - self.r_s
        return gap, self.side * float(n @ w), n

    def gap(self, time):
        return self.at(time)[0]

    def law(self, time):
        gap, rate, _ = self.at(time)
        return self.k * gap + self.p * rate

    def within(self, time):
        return math.isinf(self.half_length) or abs(self.axial(time)) <= self.half_length

    def regime(self, time):
        gap, rate, _ = self.at(time)
        if gap >= 0 or not self.within(time):
            return APART
        if self.p > 0 and self.dashpot == "non_adhesive" and self.k * gap + self.p * rate >= 0:
            return SEPARATING
        if self.p > 0 and self.dashpot == "approach_only" and rate >= 0:
            return RESTITUTION
        return COMPRESSION

    def force(self, time, regime):
        gap, rate, _ = self.at(time)
        if regime in (APART, SEPARATING):
            return 0.0
        return -(self.k * gap + (self.p if regime == COMPRESSION else 0.0) * rate)

    def stored(self, time, regime):
        return 0.0 if regime == APART else 0.5 * self.k * self.gap(time) ** 2

    def _cuts(self):
        closing = sum((x * y for x, y in zip(self.c, self.w, strict=True)), Polynomial([0.0]))
        turns = roots_of(closing, self.end)
        cuts = list(turns)
        places = [0.0, *turns, self.end]
        for low, high in itertools.pairwise(places):
            if self.gap(low) * self.gap(high) < 0:
                cuts.append(brentq(self.gap, low, high, xtol=1e-300, rtol=1e-15))
        if math.isfinite(self.half_length):
            cuts += roots_of(self.axial - self.half_length, self.end)
            cuts += roots_of(self.axial + self.half_length, self.end)
        if self.dashpot == "non_adhesive" and self.k > 0:
            # Among so many places the law has one root at most between two, of paths of degree two.
            fine = np.unique(
                np.concatenate(
                    [
                        np.linspace(a, b, 400)
                        for a, b in zip(sorted([0.0, *cuts]), sorted([*cuts, self.end]), strict=True)
                    ]
                )
            )
            of = [self.law(time) for time in fine]
            for i in range(len(fine) - 1):
                if of[i] * of[i + 1] < 0:
                    cuts.append(brentq(self.law, fine[i], fine[i + 1], xtol=1e-300, rtol=1e-15))
        return sorted(cuts)

    def _run(self):
        cuts = [0.0, *self._cuts(), self.end]
        self.pieces = []  # (from, to, regime)
        for low, high in itertools.pairwise(cuts):
            if high > low:
                regime = self.regime(0.5 * (low + high))
                if self.pieces and self.pieces[-1][2] == regime:
                    self.pieces[-1] = (self.pieces[-1][0], high, regime)
                else:
                    self.pieces.append((low, high, regime))
        self.cuts = cuts
        self.events = len(self.pieces) - 1
        self.onsets = 0
        self.onset = self.duration = 0.0
        touched = None
        for low, _high, regime in self.pieces:
            if regime != APART and touched is None:
                touched = low
                self.onsets += 1
                self.onset = low
            if regime == APART and touched is not None:
                self.duration = low - touched
                touched = None
        if touched is not None:
            self.duration = self.end - touched
        self._integrate()

    def _integrate(self):
        self.impulse = np.zeros(3)
        self.dissipated = self.work = 0.0
        self.peak_force = self.peak_penetration = 0.0
        before = self.pieces[0][2]
        self.size = 0.0  # of the powers, for what rounding makes of the sums
        for low, high, regime in self.pieces:
            # What the end of a cylinder or a regime switches on or off
            self.dissipated += self.stored(low, before) - self.stored(low, regime)
            before = regime
            if regime == APART:
                continue
            inner = [x for x in self.cuts if low < x < high]
            for a, b in zip([low, *inner], [*inner, high], strict=True):
                self._panel(a, b, regime)
                self._peaks(a, b, regime)

    def _powers(self, time, regime):
        gap, rate, n = self.at(time)
        force = self.force(time, regime)
        on_source = -self.side * force * n
        v_s = np.array([x(time) for x in self.velocity["source"]])
        v_d = np.array([x(time) for x in self.velocity["destination"]])
        work = 0.0
        if self.values.get("source.motion") == "prescribed":
            work -= on_source @ v_s
        if self.values.get("destination.motion") == "prescribed":
            work += on_source @ v_d
        return np.array([*on_source, -(force + self.k * gap) * rate, work])

    def _panel(self, low, high, regime):
        sums = adaptive(lambda time: self._powers(time, regime), low, high)
        self.impulse += sums[:3]
        self.dissipated += sums[3]
        self.work += sums[4]

    def _peaks(self, low, high, regime):
        times = np.linspace(low, high, 41)
        for name, of in (
            ("peak_force", lambda t: self.force(t, regime)),
            ("peak_penetration", lambda t: -self.gap(t)),
        ):
            values = [of(time) for time in times]
            best = int(np.argmax(values))
            found = values[best]
            a, b = times[max(best - 1, 0)], times[min(best + 1, 40)]
            if b > a:
                top = minimize_scalar(
                    lambda t, of=of: -of(t),
                    bounds=(a, b),
                    method="bounded",
                    options={"xatol": 1e-9 * (b - a)},
                )
                found = max(found, -top.fun)
            setattr(self, name, max(getattr(self, name), found))


@functools.cache
def nodes(count):
    return np.polynomial.legendre.leggauss(count)


def rule(f, low, high):
    """Sum and size of an integrand over a panel, by Gauss-Legendre with 12 nodes"""
    x, w = nodes(12)
    half = 0.5 * (high - low)
    values = np.array([f(low + half * (1.0 + s)) for s in x])
    return half * (w @ values), half * (w @ np.abs(values))


def adaptive(f, low, high, allowed=None, whole=None):
    """Panels halved until halves agree with the whole to 1e-13 of the size of everything"""
    if whole is None:
        whole, size = rule(f, low, high)
        allowed = 1e-13 * size + 1e-300
    middle = 0.5 * (low + high)
    left, right = rule(f, low, middle)[0], rule(f, middle, high)[0]
    if high - low < 1e-9 or np.all(np.abs(left + right - whole) <= allowed):
        return left + right
    return adaptive(f, low, middle, allowed, left) + adaptive(f, middle, high, allowed, right)
