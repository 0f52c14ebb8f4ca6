"""A ball dropped straight on a body, every bounce in closed form with 50 digits: flight a parabola,
contact the linear oscillator

    m s'' + c s' + k s = m g,    s the penetration,

and between them, where a dashpot that must not pull is clipped, a parabola again. The first root of the
oscillator's s or force is between two neighbouring extrema, whose times are known.
"""

from typing import NamedTuple

from mpmath import findroot, mp, mpf

mp.dps = 50


class Train(NamedTuple):
    onset_times: list
    durations: list  # one fewer where the last contact lasts
    lasting: bool  # the last contact has no end


class Oscillation:
    """s of the contact from s = depth, s' = speed on; underdamped"""

    def __init__(self, ball, depth, speed):
        self.rest = ball.mass * ball.gravity / ball.stiffness
        self.decay = ball.damping / (2 * ball.mass)
        self.angular = mp.sqrt(ball.stiffness / ball.mass - self.decay**2)
        self.cosine = depth - self.rest
        self.sine = (speed + self.decay * self.cosine) / self.angular

    def depth(self, t):
        turn = self.angular * t
        swing = self.cosine * mp.cos(turn) + self.sine * mp.sin(turn)
        return self.rest + mp.exp(-self.decay * t) * swing

    def speed(self, t):
        turn = self.angular * t
        along = (self.angular * self.sine - self.decay * self.cosine) * mp.cos(turn)
        return mp.exp(-self.decay * t) * (
            along - (self.angular * self.cosine + self.decay * self.sine) * mp.sin(turn)
        )

    def falls_to_zero(self, weight_depth, weight_speed):
        """The first t > 0 at which weight_depth s + weight_speed s', positive at first, falls to zero;
        None if it never does. It is a constant and a damped swing itself, whose extrema are a half turn
        apart.
        """

        def value(t):
            return weight_depth * self.depth(t) + weight_speed * self.speed(t)

        cosine = weight_depth * self.cosine + weight_speed * (
            self.angular * self.sine - self.decay * self.cosine
        )
        sine = weight_depth * self.sine - weight_speed * (self.angular * self.cosine + self.decay * self.sine)
        # extrema: (angular sine - decay cosine) cos = (angular cosine + decay sine) sin
        first = mp.atan2(self.angular * sine - self.decay * cosine, self.angular * cosine + self.decay * sine)
        half = mp.pi / self.angular
        extremum = (first % mp.pi) / self.angular
        before = mpf(0)
        while True:
            if value(extremum) < 0:
                return bisected(value, before, extremum)
            constant = weight_depth * self.rest
            if mp.hypot(cosine, sine) * mp.exp(-self.decay * extremum) < constant:
                return None  # the swing is smaller than the constant from here on
            before, extremum = extremum, extremum + half


def bisected(value, low, high):
    """The root between a positive (or zero) and a negative end; the digits by bisection, then Newton's
    kind
    """
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if value(middle) >= 0 else (low, middle)
    return findroot(value, (low, high), solver="anderson", tol=mpf(10) ** -80, verify=False)


class Ball(NamedTuple):
    mass: mpf
    stiffness: mpf
    damping: mpf
    gravity: mpf
    clipped: bool  # the dashpot does not pull (non_adhesive); otherwise unclamped

    def contact(self, speed):
        """Duration of a contact begun with `speed`, and the speed off the body; None where it lasts"""
        swing = Oscillation(self, mpf(0), speed)
        if not self.clipped:
            end = swing.falls_to_zero(1, 0)
            return end and (end, -swing.speed(end))
        time = mpf(0)
        while True:
            slack = swing.falls_to_zero(self.stiffness, self.damping)
            if slack is None:
                return None
            depth, speed = swing.depth(slack), swing.speed(slack)
            time += slack
            # unloaded: s = depth + speed t + g t^2 / 2 until s = 0 or k s + c s' = 0 again
            leave = first_root(self.gravity / 2, speed, depth)
            return_slope = self.stiffness * speed + self.damping * self.gravity
            load = first_root(self.stiffness * self.gravity / 2, return_slope, mpf(0))
            if leave is not None and (load is None or leave <= load):
                return time + leave, -(speed + self.gravity * leave)
            time += load
            swing = Oscillation(
                self, depth + speed * load + self.gravity * load**2 / 2, speed + self.gravity * load
            )

    def train(self, height, end):
        """Dropped from `height` above the first touch; every contact begun before `end`"""
        onsets, durations = [], []
        time, speed = mp.sqrt(2 * height / self.gravity), mp.sqrt(2 * height * self.gravity)
        while time < end:
            onsets.append(time)
            outcome = self.contact(speed)
            if outcome is None:
                return Train(onsets, durations, True)
            durations.append(outcome[0])
            time, speed = time + outcome[0] + 2 * outcome[1] / self.gravity, outcome[1]
        return Train(onsets, durations, False)


def first_root(a, b, c):
    """The first t > 0 at which a t^2 + b t + c becomes negative, from c >= 0 (falling where c = 0); or
    None
    """
    square = b * b - 4 * a * c
    if square <= 0 or b >= 0:
        return None
    if c == 0:
        return -b / a  # it was at zero and falls: where it comes back
    return 2 * c / (-b + mp.sqrt(square))
