"""Two bodies that meet head-on, every contact in closed form: the relative coordinate q along a line through
both centres (across a cylinder's axis), under a constant acceleration a.

Outside, the bodies overlap by s = reach - |q|, and a body fast or deep enough passes the middle, where the
contact turns round. Inside they overlap by s = |q| - reach, on a plane by s = reach - q. The contact obeys

    m s'' = m b - F(s, s'),    b the acceleration into the contact,

with F by the dashpot (fmu_src/contact/law.c): linear pieces, joined at the first sign change of s, s' or F.
`mpmath` carries the digits, 60 here.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Self

from mpmath import mp, mpf

# The motion m s'' + c s' + k s = m b in closed form, with as many digits as mpmath is set to, and the times
# at which a straight combination of s and s' changes its sign. Spring, dashpot or both may be missing.


class Swing:
    """s(t) from s(0) = depth, s'(0) = speed. Its two exponentials are complex where it swings."""

    def __init__(self, stiffness: mpf, damping: mpf, push: mpf, depth: mpf, speed: mpf):
        """stiffness and damping over the mass; `push` is b"""
        self.square, self.half = stiffness, damping / 2
        self.depth, self.speed, self.push = depth, speed, push
        self.change = push - damping * speed - stiffness * depth  # s''(0)
        self.jerk = -damping * self.change - stiffness * speed
        self.swings = self.square > self.half**2
        # Critical damping is moved by 1e-36 of itself, which keeps both exponents apart and forty digits right.
        turn = mp.sqrt(self.half**2 - self.square) or mpf("1e-18") * self.half
        self.fast = -(self.half + turn)
        self.slow = self.square / self.fast if self.fast else mpf(0)  # without cancellation

    def rate_of(self, first: mpf, second: mpf, t: mpf) -> mpf:
        """y(t) of y'' + 2 half y' + square y = 0 from y(0) = first, y'(0) = second; so do s' and s'' move"""
        share = (second - self.fast * first) / (self.slow - self.fast)
        return mp.re(share * mp.exp(self.slow * t) + (first - share) * mp.exp(self.fast * t))

    def at(self, t: mpf) -> tuple[mpf, mpf]:
        """s and s'"""
        if not self.fast:  # neither spring nor dashpot
            return self.depth + self.speed * t + self.push * t**2 / 2, self.speed + self.push * t
        speed = self.rate_of(self.speed, self.change, t)
        if self.square != 0:
            change = self.rate_of(self.change, self.jerk, t)
            return (self.push - 2 * self.half * speed - change) / self.square, speed
        return self.depth + (self.push * t - speed + self.speed) / (2 * self.half), speed

    def first_change(self, weights: tuple[mpf, mpf, mpf], until: mpf, on_root: bool = False) -> mpf | None:
        """The first time before `until` at which f = weights . (s, s', 1) changes its sign; `on_root`: it is
        zero now, whatever its rounding says"""
        a, b, c = weights
        now = mpf(0) if on_root else a * self.depth + b * self.speed + c
        slope, bend = a * self.speed + b * self.change, a * self.change + b * self.jerk

        def value(t: mpf) -> tuple[mpf, mpf]:
            """f and f'"""
            s, rate = self.at(t)
            change = self.push - 2 * self.half * rate - self.square * s
            return a * s + b * rate + c, a * rate + b * change

        side = mp.sign(now) or mp.sign(slope) or mp.sign(bend)
        if side == 0:
            return None
        if not self.fast:
            return _falls(bend / 2, slope, now, side, until)
        # f keeps its sign once the swing has become smaller than the distance of its middle from zero.
        middle = a * self.push / self.square + c if self.swings else mpf(0)
        before, monotonous = mpf(0), now == 0
        for t in self.turning_points(slope, bend):
            last = t >= until
            t = min(t, until)
            f = value(t)[0]
            if not monotonous and mp.sign(f) == -side:
                return _root(value, before, t, side)
            if last or (mp.sign(middle) == side and abs(f - middle) < abs(middle)):
                return None
            before, monotonous = t, False
        return None

    def turning_points(self, slope: mpf, bend: mpf) -> Iterator[mpf]:
        """Times > 0 at which f' is zero, then infinity: there exp((slow - fast) t) is the ratio of its parts"""
        apart, divisor = self.slow - self.fast, bend - self.fast * slope
        ratio = (bend - self.slow * slope) / divisor if divisor else mpf(0)
        if self.swings and ratio:
            period = 2 * mp.pi / mp.im(apart)
            t = mp.re(mp.log(ratio) / apart) % period or period
            while True:
                yield t
                t += period
        elif mp.re(ratio) > 1:
            yield mp.log(ratio) / apart
        yield mp.inf


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


DIGITS = 60
MOST_PIECES = 5000  # half a minute
ZERO, INFINITE = mpf(0), mpf("inf")
FULL, SPRING, CLIPPED = "spring and dashpot", "spring alone", "clipped"


@dataclass
class Line:
    """One scene and where it has got to"""

    inside: bool
    reach: mpf  # |q| at the first touch
    mass: mpf  # reduced
    stiffness: mpf
    damping: mpf
    dashpot: str
    push: mpf  # acceleration along q
    place: mpf  # q
    speed: mpf  # q'
    flat: bool = False  # a plane, below it
    ends: tuple = ()  # times at which a finite cylinder's end is passed
    within: bool = True
    time: mpf = ZERO
    onset_times: list = field(default_factory=list)
    end_times: list = field(default_factory=list)  # where the gap opens
    onset_speeds: list = field(default_factory=list)  # into the contact
    fastest: mpf = ZERO
    deepest: mpf = ZERO
    through_middle: bool = False  # of a solid body
    closest_end: mpf = INFINITE  # |depth| where a finite cylinder's end was passed
    touching: bool = False
    law: str = FULL
    _on_root: str = ""

    def depth(self) -> mpf:
        if self.flat:
            return self.reach - self.place
        return (abs(self.place) - self.reach) * (1 if self.inside else -1)

    def side(self) -> mpf:
        """+1 or -1: where the source is; in the middle, where it goes to. At rest there, a solid body's
        contact pushes to +z, the FMU's direction where there is no other."""
        if self.flat:
            return mpf(1)
        away = self.push + self.stiffness * self.reach / self.mass
        at_rest = mpf(1) if not self.inside and away > 0 else mp.sign(self.push) or mpf(1)
        return mp.sign(self.place) or mp.sign(self.speed) or at_rest

    def into(self, along: mpf) -> mpf:
        """A rate along q as one of s"""
        return along * self.side() * (1 if self.inside else -1)

    def run(self, until: float) -> Self:
        with mp.workdps(max(DIGITS, mp.dps)):
            until = mpf(until)
            for _ in range(MOST_PIECES):
                if self.time >= until:
                    break
                self._note_speed()
                self._touch()
                if self.touching:
                    self._press(until)
                else:
                    self._fly(until)
            else:
                raise ArithmeticError(f"more than {MOST_PIECES} pieces up to {float(self.time):.12g} s")
            self._note_speed()
        return self

    def moved(self, jump: float) -> None:
        """The destination jumps by -jump along q: q changes at once"""
        with mp.workdps(DIGITS):
            self.place += mpf(jump)
            self._on_root = ""
            self.touching = self.touching and bool(self.depth() > 0)
            if self.touching:
                self._choose_law()

    def _note_speed(self) -> None:
        self.fastest = max(self.fastest, abs(self.speed))
        if self.within:
            self.deepest = max(self.deepest, self.depth())

    def _touch(self) -> None:
        """Whether a contact begins here"""
        if self.touching or not self.within or self._on_root == "left":
            return
        depth, rate, push = self.depth(), self.into(self.speed), self.into(self.push)
        at_surface = self._on_root == "gap" or depth == 0
        if (depth > 0 and not at_surface) or (at_surface and (rate > 0 or (rate == 0 and push > 0))):
            self.touching = True
            self.onset_times.append(self.time)
            self.onset_speeds.append(rate)
            self._choose_law()

    def _choose_law(self) -> None:
        depth, rate, push = max(self.depth(), mpf(0)), self.into(self.speed), self.into(self.push)
        force = self.stiffness * depth + self.damping * rate
        change = push - force / self.mass
        self.law = FULL
        if self.dashpot == "approach_only" and (rate < 0 or (rate == 0 and change <= 0)):
            self.law = SPRING
        if self.dashpot == "non_adhesive" and self.damping != 0:
            later = self.stiffness * rate + self.damping * push
            if force < 0 or (force == 0 and later < 0):
                self.law = CLIPPED

    def _next_end(self, until: mpf) -> mpf:
        return min([t for t in self.ends if t > self.time] + [until])

    def _fly(self, until: mpf) -> None:
        """Flies to the next touch, to the cylinder's end or to the end of all"""
        swing = Swing(mpf(0), mpf(0), self.push, self.place, self.speed)
        stop = self._next_end(until)
        begin, event = self.time, ""
        left = self._on_root == "left"
        for wall in (self.reach,) if self.flat else (self.reach, -self.reach):
            if not self.within:
                break
            on_wall = left and (self.flat or mp.sign(self.place) == mp.sign(wall))
            t = swing.first_change((mpf(1), mpf(0), -wall), stop - begin, on_wall)
            if t is not None and begin + t < stop:
                stop, event = begin + t, "gap"
                landing = wall
        self.place, self.speed = swing.at(stop - begin)
        self.time, self._on_root = stop, event
        if event:
            self.place = landing
        self._pass_end()

    def _pass_end(self) -> None:
        if self.time in self.ends:
            self.within = not self.within
            self.closest_end = min(self.closest_end, abs(self.depth()))
            self._on_root, self.touching = "", False

    def _conditions(self) -> dict:
        """What ends this piece of a contact, as weights of (s, s', 1)"""
        found = {"gap": (mpf(1), mpf(0), mpf(0))}
        if self.dashpot == "approach_only":
            found["rate"] = (mpf(0), mpf(1), mpf(0))
        if self.dashpot == "non_adhesive" and self.damping != 0:
            found["force"] = (self.stiffness, self.damping, mpf(0))
        if not self.inside and not self.flat:
            found["middle"] = (mpf(1), mpf(0), -self.reach)
        return found

    def _press(self, until: mpf) -> None:
        side, begin = self.side(), self.time
        stiffness = mpf(0) if self.law == CLIPPED else self.stiffness / self.mass
        damping = self.damping / self.mass if self.law == FULL else mpf(0)
        depth = mpf(0) if self._on_root == "gap" else self.depth()
        swing = Swing(stiffness, damping, self.into(self.push), depth, self.into(self.speed))
        stop, event = self._next_end(until), ""
        for name, weights in self._conditions().items():
            on_root = name == self._on_root or (name == "gap" and depth == 0)
            t = swing.first_change(weights, stop - begin, on_root)
            if t is not None and begin + t < stop:
                stop, event = begin + t, name
        turn = swing.first_change((mpf(0), mpf(1), mpf(0)), stop - begin)
        if turn is not None:
            self.deepest = max(self.deepest, swing.at(turn)[0])
        depth, rate = swing.at(stop - begin)
        sign = 1 if self.inside else -1
        self.time, self._on_root = stop, event
        self.place, self.speed = side * (self.reach + sign * depth), side * sign * rate
        self._happen(event, side)
        self._pass_end()

    def _happen(self, event: str, side: mpf) -> None:
        if event == "gap":
            self.place = side * self.reach
            self._on_root, self.touching = "left", False
            self.end_times.append(self.time)
        elif event == "middle":
            self.place, self.through_middle = mpf(0), True
            self._on_root = "middle"
            self._choose_law()
        elif event == "rate":
            self.law = SPRING if self.law == FULL else FULL
        elif event == "force":
            self.law = CLIPPED if self.law == FULL else FULL


def halved(below: Callable[[mpf], bool], low: mpf, high: mpf) -> mpf:
    """Where `below` ends to hold between the two, to sixty digits"""
    for _ in range(220):
        middle = (low + high) / 2
        low, high = (middle, high) if below(middle) else (low, middle)
    return high


def damping_ratio(restitution: float, dashpot: str) -> mpf:
    """zeta of a free impact with this coefficient of restitution, by halving: with cos t = zeta, or cosh t
    beyond critical damping, unclamped e = exp(-pi cot t), the others e = exp(-t cot t), non_adhesive its
    square. None but an infinite dashpot would give 0: less than 1e-6 counts as that."""
    with mp.workdps(DIGITS):
        e = mpf(restitution)
        if dashpot == "unclamped":
            return mpf(1) if e == 0 else -mp.log(e) / mp.hypot(mp.pi, mp.log(e))
        wanted = -mp.log(max(e, mpf("1e-6"))) / (2 if dashpot == "non_adhesive" else 1)

        def too_little(zeta: mpf) -> bool:
            t = mp.acos(mp.mpc(zeta))
            return (mp.re(t * mp.cot(t)) if t != 0 else mpf(1)) < wanted

        return halved(too_little, mpf(0), mp.exp(wanted) if wanted > 0 else mpf(0))
