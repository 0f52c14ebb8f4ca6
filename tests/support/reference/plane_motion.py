"""A ball on a plane in closed form, to forty digits, where all that acts is constant. A ball that is dropped
straight on a body is the same.

Only the gap couples to the contact: m g'' = F_n + m a with the relative mass m and the part a of the
relative acceleration along the normal. In each regime that is linear, x = g - x_0 a sum of two
exponentials, and the next change of regime the first zero of a function of time, looked for in steps far
shorter than a period.
"""

from dataclasses import dataclass, field

import mpmath as mp

DIGITS = 40
STEPS_OF_PERIOD = 64  # in which a change of regime is looked for; none of them is that short here
FLIGHT, FULL, SPRING, CLIPPED = "flight", "spring and dashpot", "spring alone", "clipped"


@dataclass
class PlaneMotion:
    """The gap, its rate, and what happened, at `time`; masses in kg, factors in N/m and N s/m."""

    gap: mp.mpf
    rate: mp.mpf
    acceleration: mp.mpf  # of the gap without the contact, m/s^2
    mass: mp.mpf
    penalty: mp.mpf
    viscous: mp.mpf
    dashpot: str
    time: mp.mpf = field(default_factory=lambda: mp.mpf(0))
    regime: str = FLIGHT
    onsets: list = field(default_factory=list)
    ends: list = field(default_factory=list)  # of contacts; one fewer where the last one lasts
    impulse: mp.mpf = field(default_factory=lambda: mp.mpf(0))  # of the contact along the normal

    def run(self, end):
        with mp.workdps(DIGITS):
            end = mp.mpf(end)
            while self.time < end:
                self.one_regime(end)
        return self

    def force(self, gap, rate):
        return -self.penalty * gap - self.viscous * rate

    def law(self):
        """Spring and dashpot in force in this regime."""
        spring = self.penalty if self.regime in (FULL, SPRING) else mp.mpf(0)
        return spring, self.viscous if self.regime == FULL else mp.mpf(0)

    def motion(self):
        """Functions of the time since now: gap and rate in this regime, whether it lasts from there on"""
        spring, dashpot = self.law()
        g, v, a = self.gap, self.rate, self.acceleration
        if spring == 0:
            return (lambda t: g + v * t + a * t * t / 2), (lambda t: v + a * t), (lambda t: False)
        rest = self.mass * a / spring
        half = dashpot / (2 * self.mass)
        root = mp.sqrt(mp.mpc(half * half - spring / self.mass))
        one, two = -half + root, -half - root
        by_one = (v - two * (g - rest)) / (one - two)
        by_two = (g - rest) - by_one
        return (
            lambda t: rest + mp.re(by_one * mp.exp(one * t) + by_two * mp.exp(two * t)),
            lambda t: mp.re(one * by_one * mp.exp(one * t) + two * by_two * mp.exp(two * t)),
            lambda t: self.lasts(
                rest, [(one, abs(by_one * mp.exp(one * t))), (two, abs(by_two * mp.exp(two * t)))]
            ),
        )

    def lasts(self, rest, swings):
        """Whether swings of (exponent, size), which only shrink, are too small to end the pressure at rest"""
        gap = sum(size for _, size in swings)
        force = sum(size * abs(self.penalty + self.viscous * exponent) for exponent, size in swings)
        return self.dashpot != "approach_only" and gap < -rest and force < -self.penalty * rest

    def events(self, gap, rate):
        """(function that falls through zero, the regime that follows)"""
        if self.regime == FLIGHT:
            return [(gap, FULL)]
        found = [(lambda t: -gap(t), FLIGHT)]
        if self.viscous and self.dashpot == "non_adhesive":
            sign = -1 if self.regime == CLIPPED else 1
            found.append(
                (lambda t: sign * self.force(gap(t), rate(t)), FULL if self.regime == CLIPPED else CLIPPED)
            )
        if self.viscous and self.dashpot == "approach_only":
            sign = 1 if self.regime == SPRING else -1
            found.append((lambda t: sign * rate(t), FULL if self.regime == SPRING else SPRING))
        return found

    def one_regime(self, end):
        gap, rate, lasts = self.motion()
        step = mp.sqrt(self.mass / self.penalty) * 2 * mp.pi / STEPS_OF_PERIOD
        if self.regime == FLIGHT:
            length, following = self.touch(), FULL
        else:
            length, following = first_fall(self.events(gap, rate), step, end - self.time, lasts)
        if length is None or self.time + length >= end:
            length, following = end - self.time, self.regime
        before = self.rate
        self.gap, self.rate = gap(length), rate(length)
        self.impulse += self.mass * (self.rate - before - self.acceleration * length)
        self.time += length
        if following in (FULL, FLIGHT) and FLIGHT in (following, self.regime) and following != self.regime:
            self.gap = mp.mpf(0)
            (self.onsets if following == FULL else self.ends).append(self.time)
        self.regime = following

    def touch(self):
        """When a parabola that is at or above zero falls through it; None: never."""
        a, v, g = self.acceleration / 2, self.rate, self.gap
        square = v * v - 4 * a * g
        if square < 0:
            return None
        roots = [2 * g / (-v + s * mp.sqrt(square)) for s in (1, -1) if g and -v + s * mp.sqrt(square)]
        roots += [] if g or not a else [-v / a]
        roots = [t for t in roots if t > 0 and v + 2 * a * t < 0]
        return min(roots, default=None)


def first_fall(events, step, longest, lasts):
    """The first time at which one of the functions falls through zero, and what follows, or None, None."""
    time, soon = mp.mpf(0), step * mp.mpf(10) ** -12  # just after the last change
    values = [function(soon) for function, _ in events]
    while time < longest and not lasts(time):
        later = time + step
        found = []
        for i, (function, following) in enumerate(events):
            value = function(later)
            if values[i] > 0 >= value:
                between = (max(time, soon) / step, later / step)
                root = mp.findroot(lambda x, f=function: f(x * step), between, solver="anderson")
                found.append((root * step, following))
            values[i] = value
        if found:
            return min(found)
        time = later
    return None, None
