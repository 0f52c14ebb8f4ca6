"""Two bodies that meet head-on, every contact in closed form: the relative coordinate q along a line through
both centres (across a cylinder's axis), under a constant acceleration a.

Outside, the bodies overlap by s = reach - |q|, and a body fast or deep enough passes the middle, where the
contact turns round. Inside they overlap by s = |q| - reach, on a plane by s = reach - q. The contact obeys

    m s'' = m b - F(s, s'),    b the acceleration into the contact,

with F by the dashpot (DESIGN section 1 of the FMU): all straight-lined pieces, joined at the first sign
change of s, s' or F. `mpmath` carries the digits, 60 here.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mpmath import mp, mpf

from .swing import Swing

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
    onset_speeds: list = field(default_factory=list)  # into the contact
    last_duration: mpf = ZERO
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

    def run(self, until: float) -> Line:
        with mp.workdps(DIGITS):
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
            if self.touching:
                self.last_duration = self.time - self.onset_times[-1]
        return self

    def moved(self, jump: float, speed_change: float = 0.0) -> None:
        """The destination jumps by -jump along q: q changes at once"""
        with mp.workdps(DIGITS):
            self.place, self.speed = self.place + mpf(jump), self.speed + mpf(speed_change)
            self._on_root = ""
            if self.touching and self.depth() <= 0:
                self._let_go()
            elif self.touching:
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

    def _let_go(self) -> None:
        self.touching = False
        self.last_duration = self.time - self.onset_times[-1]

    def _next_end(self, until: mpf) -> mpf:
        return min([t for t in self.ends if t > self.time] + [until])

    def _fly(self, until: mpf) -> None:
        """To the next touch, end or the end of all"""
        swing = Swing(mpf(0), mpf(0), self.push, self.place, self.speed)
        stop = self._next_end(until)
        begin, event = self.time, ""
        left = self._on_root == "left" and (1 if self.flat else mp.sign(self.place))
        for wall in (self.reach,) if self.flat else (self.reach, -self.reach):
            if not self.within:
                break
            t = swing.first_change((mpf(1), mpf(0), -wall), stop - begin, left == mp.sign(wall))
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
            self._on_root = ""
            if self.touching:
                self._let_go()

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
        self._note_turn(swing, stop - begin)
        depth, rate = swing.at(stop - begin)
        sign = 1 if self.inside else -1
        self.time, self._on_root = stop, event
        self.place, self.speed = side * (self.reach + sign * depth), side * sign * rate
        self._happen(event, side)
        self._pass_end()

    def _note_turn(self, swing: Swing, duration: mpf) -> None:
        turn = swing.first_change((mpf(0), mpf(1), mpf(0)), duration)
        if turn is not None:
            self.deepest = max(self.deepest, swing.at(turn)[0])

    def _happen(self, event: str, side: mpf) -> None:
        if event == "gap":
            self.place = side * self.reach
            self._let_go()
            self._on_root = "left"
        elif event == "middle":
            self.place, self.through_middle = mpf(0), True
            self._on_root = "middle"
            self._choose_law()
        elif event == "rate":
            self.law = SPRING if self.law == FULL else FULL
        elif event == "force":
            self.law = CLIPPED if self.law == FULL else FULL


def damping_ratio(restitution: float, dashpot: str) -> mpf:
    """zeta of a free impact with this coefficient of restitution, by halving: with cos t = zeta, or cosh t
    beyond critical damping, unclamped e = exp(-pi cot t), the others e = exp(-t cot t), non_adhesive its
    square. None but an infinite dashpot would give 0: less than 1e-6 counts as that."""
    with mp.workdps(DIGITS):
        e = mpf(restitution)
        if dashpot == "unclamped":
            return mpf(1) if e == 0 else -mp.log(e) / mp.hypot(mp.pi, mp.log(e))
        wanted = -mp.log(max(e, mpf("1e-6"))) / (2 if dashpot == "non_adhesive" else 1)
        low, high = mpf(0), mp.exp(wanted) if wanted > 0 else mpf(0)
        for _ in range(220):
            middle = (low + high) / 2
            t = mp.acos(mp.mpc(middle))
            lost = mp.re(t * mp.cot(t)) if t != 0 else mpf(1)
            low, high = (middle, high) if lost < wanted else (low, middle)
        return high
