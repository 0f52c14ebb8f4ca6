"""The motion m s'' + c s' + k s = m b in closed form, with as many digits as mpmath is set to, and the times
at which a straight combination of s and s' changes its sign. Spring, dashpot or both may be missing.
"""

from __future__ import annotations

from collections.abc import Iterator

from mpmath import mp, mpf


class Swing:
    """s(t) from s(0) = depth, s'(0) = speed"""

    def __init__(self, stiffness: mpf, damping: mpf, push: mpf, depth: mpf, speed: mpf):
        """stiffness and damping over the mass; `push` is b"""
        self.square, self.half = stiffness, damping / 2
        self.depth, self.speed, self.push = depth, speed, push
        self.change = push - damping * speed - stiffness * depth  # s''(0)
        self.turn = mp.sqrt(abs(self.square - self.half**2))
        self.kind = 0 if self.turn == 0 else (1 if self.square > self.half**2 else -1)
        if self.kind < 0:  # exponents; the slow one without cancellation
            self.fast = -(self.half + self.turn)
            self.slow = -self.square / (self.half + self.turn)

    def rate_of(self, first: mpf, second: mpf, t: mpf) -> mpf:
        """y(t) of y'' + 2 half y' + square y = 0 from y(0) = first, y'(0) = second; so do s' and s'' move"""
        if self.kind < 0:
            share = (second - self.fast * first) / (self.slow - self.fast)
            return share * mp.exp(self.slow * t) + (first - share) * mp.exp(self.fast * t)
        decay = mp.exp(-self.half * t)
        bend = second + self.half * first
        if self.kind == 0:
            return decay * (first + bend * t)
        return decay * (first * mp.cos(self.turn * t) + bend / self.turn * mp.sin(self.turn * t))

    def at(self, t: mpf) -> tuple[mpf, mpf]:
        """s and s'"""
        jerk = -2 * self.half * self.change - self.square * self.speed
        speed = self.rate_of(self.speed, self.change, t)
        change = self.rate_of(self.change, jerk, t)
        if self.square != 0:
            return (self.push - 2 * self.half * speed - change) / self.square, speed
        if self.half != 0:  # s' + 2 half s = b t + constant
            return self.depth + (self.push * t - speed + self.speed) / (2 * self.half), speed
        return self.depth + self.speed * t + self.push * t**2 / 2, speed

    def first_change(self, weights: tuple[mpf, mpf, mpf], until: mpf, on_root: bool = False) -> mpf | None:
        """The first time before `until` at which f = weights . (s, s', 1) changes its sign; `on_root`: it is
        zero now, whatever its rounding says"""
        a, b, c = weights
        jerk = -2 * self.half * self.change - self.square * self.speed
        now, slope, bend = a * self.depth + b * self.speed + c, a * self.speed + b * self.change, 0
        bend = a * self.change + b * jerk

        def value(t: mpf) -> tuple[mpf, mpf]:
            """f and f'"""
            s, rate = self.at(t)
            change = self.push - 2 * self.half * rate - self.square * s
            return a * s + b * rate + c, a * rate + b * change

        if on_root:
            now = mpf(0)
        side = mp.sign(now) or mp.sign(slope) or mp.sign(bend)
        if side == 0:
            return None
        if self.square == 0 and self.half == 0:
            return _falls(bend / 2, slope, now, side, until)
        before, monotonous = mpf(0), now == 0
        for t in self.turning_points(slope, bend):
            last = t >= until
            t = min(t, until)
            if not monotonous and mp.sign(value(t)[0]) == -side:
                return _root(value, before, t, side)
            if last or self._settled(value, t, side, (a, c), (slope, bend)):
                return None
            before, monotonous = t, False
        return None

    def turning_points(self, slope: mpf, bend: mpf) -> Iterator[mpf]:
        """Times > 0 at which f' is zero, then infinity"""
        if self.kind > 0:
            first = mp.atan2(-slope * self.turn, bend + self.half * slope) % mp.pi
            t = (first or mp.pi) / self.turn
            while True:
                yield t
                t += mp.pi / self.turn
        if self.kind == 0:
            rise = bend + self.half * slope
            if rise != 0 and -slope / rise > 0:
                yield -slope / rise
        else:
            share = bend - self.fast * slope, bend - self.slow * slope  # of slow, of fast
            if share[0] != 0 and share[1] / share[0] > 1:
                yield mp.log(share[1] / share[0]) / (self.slow - self.fast)
        yield mp.inf

    def _settled(self, value, t, side, weights, rates) -> bool:
        """Whether the swing has become smaller than its distance from zero, so that f keeps its sign"""
        if self.kind <= 0:
            return False
        middle = weights[0] * self.push / self.square + weights[1]
        return mp.sign(middle) == side and abs(value(t)[0] - middle) < abs(middle)


def _root(value, low: mpf, high: mpf, side: mpf) -> mpf:
    """Newton's method, kept between a point on this side of the root and one beyond it"""
    t = (low + high) / 2
    for _ in range(400):
        f, rate = value(t)
        if f == 0:
            return t
        low, high = (t, high) if mp.sign(f) == side else (low, t)
        step = t - f / rate if rate != 0 else low
        if abs(step - t) <= abs(t) * mpf(10) ** (-mp.dps // 2):  # this last step doubles the digits
            return step
        t = step if low < step < high else (low + high) / 2
    raise ArithmeticError(
        "the moment of an event could not be found: 400 steps of Newton's method and bisection do not settle"
    )


def _falls(a: mpf, b: mpf, c: mpf, side: mpf, until: mpf) -> mpf | None:
    """The first t > 0 at which side (a t^2 + b t + c), positive before, becomes negative"""
    a, b, c = side * a, side * b, side * c
    square = b * b - 4 * a * c
    if square <= 0 or (a >= 0 and b >= 0):
        return None
    root = mp.sqrt(square)
    t = 2 * c / (root - b) if b < 0 and c != 0 else (-b - root) / (2 * a) if a != 0 else None
    return t if t is not None and 0 < t <= until else None
