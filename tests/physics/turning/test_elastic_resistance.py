"""Elastic resistance to rolling and spinning: closed forms of a ball on a plane, whose states follow linear
equations between the events of its springs.
"""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from support.checks import METHODS, check_close, check_relative, run

G, MASS, RADIUS, MU, STIFFNESS = 9.81, 1.0, 0.1, 0.05, 2.25
INERTIA = 0.4 * MASS * RADIUS**2
LIMIT = MU * RADIUS * MASS * G  # N m
BALL = {
    "source.rotation": "free",
    "source.mass": MASS,
    "source.radius": RADIUS,
    "source.center": [0.0, 0.0, RADIUS - MASS * G / 1e6],  # lies on its spring
    "contact.penalty_factor": 1e6,
}


def resisting(kind, stiffness=STIFFNESS, damping=0.0):
    return {
        f"contact.{kind}": "elastic",
        f"contact.{kind}_coefficient": MU,
        f"contact.{kind}_stiffness": stiffness,
        f"contact.{kind}_damping": damping,
    }


class Spinning:
    """The spring angle, the rate and the energies of a ball that spins about the vertical.

    It sticks, I w' = -k a - c w with a' = w, until k a + c w = L. It slides, w' = -L/I and c a' = L - k a,
    until k a + c w = L again; without a dashpot a = L/k, until w = 0. Then it sticks for good.
    """

    def __init__(self, rate, damping):
        self.rate, self.damping = rate, damping
        self.matrix = np.array([[0.0, 1.0], [-STIFFNESS / INERTIA, -damping / INERTIA]])
        self.breaks = 0.0
        if damping * rate < LIMIT:
            period = 2 * math.pi * math.sqrt(INERTIA / STIFFNESS)
            self.breaks = brentq(lambda t: self.carried(self.first(t)) - LIMIT, 0.0, period / 4, xtol=1e-16)
        self.slides = self.first(self.breaks)
        last = self.slides[1] * INERTIA / LIMIT
        if damping == 0.0:
            self.sticks = self.breaks + last
        else:
            self.sticks = self.breaks + brentq(self.excess, 1e-3 * last, 1.001 * last, xtol=1e-16)

    def carried(self, state):
        return STIFFNESS * state[0] + self.damping * state[1]

    def first(self, time):
        return expm(self.matrix * time) @ np.array([0.0, self.rate])

    def second(self, time):
        angle, rate = self.slides
        decay = math.exp(-STIFFNESS * time / self.damping) if self.damping else 0.0
        full = LIMIT / STIFFNESS
        return np.array([full + (angle - full) * decay, rate - LIMIT / INERTIA * time])

    def excess(self, time):
        """k a + c w - L of the second part, without cancellation."""
        angle, rate = self.slides
        decay = math.exp(-STIFFNESS * time / self.damping)
        return self.damping * (rate - LIMIT / INERTIA * time) + (STIFFNESS * angle - LIMIT) * decay

    def at(self, time):
        if time < self.breaks:
            return self.first(time)
        if time < self.sticks:
            return self.second(time - self.breaks)
        return expm(self.matrix * (time - self.sticks)) @ self.second(self.sticks - self.breaks)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("damping", [0.0, 0.002, 0.02])
def test_a_spinning_ball_slides_and_then_swings_on_its_spring(opened, damping, method):
    """With the third dashpot it slides from the start on."""
    ball = Spinning(5.0, damping)
    assert (ball.breaks > 0.0) == (damping < 0.01)
    values = BALL | resisting("spinning", damping=damping) | {"source.initial_angular_velocity": [0, 0, 5.0]}
    energy = 0.5 * INERTIA * 5.0**2
    for time in (0.5 * ball.breaks, 0.3, ball.sticks - 1e-4, ball.sticks + 0.02, ball.sticks + 0.5):
        fmu = run(opened("SpherePlane"), values, max(time, 1e-3), 2, 1e-11, method)
        angle, rate = ball.at(max(time, 1e-3))
        stored, left = 0.5 * STIFFNESS * angle**2, 0.5 * INERTIA * rate**2
        check_close("rate", fmu["source.angular_velocity"], [0.0, 0.0, rate], 1e-9)
        check_close("energy.tangential", fmu["energy.tangential"], stored, 1e-9 * energy)
        check_close("energy.friction", fmu["energy.friction"], energy - stored - left, 1e-9 * energy)
    check_close("solver.events", fmu["solver.events"], 1 + (ball.breaks > 0.0), 0)


K_T, C_T = 1e5, 100.0


class Rolling:
    """The ball's x, v, rolling rate w, spring of friction s and spring of rolling a, by matrix exponentials.

    Friction always sticks: m v' = -k_t s - c_t u, s' = u = v - r w. While rolling sticks, a' = w and
    I w' = r (k_t s + c_t u) - k a - c w; while it slides, the last two terms are -L and c a' = L - k a.
    Without a dashpot a' = 0 then, from a = L/k on.
    """

    def __init__(self, speed, stiffness, damping):
        self.k, self.c = stiffness, damping
        self.events = [(0.0, np.array([0.0, speed, speed / RADIUS, 0.0, 0.0, 1.0]))]
        carried = np.array([0.0, 0.0, damping, 0.0, stiffness, 0.0])
        self.matrices = [self.matrix(sticks) for sticks in (True, False, True)]
        if damping * speed / RADIUS < LIMIT:
            self.until(lambda y: carried @ y - LIMIT)
        else:
            self.events.append(self.events[0])
        self.until((lambda y: carried @ y - LIMIT) if damping else (lambda y: y[2]))

    def matrix(self, sticks):
        m = np.zeros((6, 6))
        push = np.array([0.0, C_T, -C_T * RADIUS, K_T, 0.0, 0.0])
        m[0, 1] = 1.0
        m[1] = -push / MASS
        m[2] = RADIUS * push / INERTIA
        m[3, 1:3] = 1.0, -RADIUS
        if sticks:
            m[2, 2] -= self.c / INERTIA
            m[2, 4] = -self.k / INERTIA
            m[4, 2] = 1.0
        else:
            m[2, 5] = -LIMIT / INERTIA
            if self.c:
                m[4, 4:6] = -self.k / self.c, LIMIT / self.c
        return m

    def until(self, function):
        """Adds the event at which a function next passes zero, looked for by steps of a millisecond."""
        begin, state = self.events[-1]
        matrix, step = self.matrices[len(self.events) - 1], 1e-3
        along = [expm(matrix * step)]
        first = function(along[0] @ state)
        steps, after = 1, along[0] @ state
        while first * function(after) > 0.0:
            steps, after = steps + 1, along[0] @ after
        left = brentq(
            lambda t: function(expm(matrix * t) @ state), (steps - 1) * step or 1e-9, steps * step, xtol=1e-15
        )
        self.events.append((begin + left, expm(matrix * left) @ state))

    def at(self, time):
        for (begin, state), matrix in reversed(list(zip(self.events, self.matrices, strict=True))):
            if time >= begin:
                return expm(matrix * (time - begin)) @ state
        raise AssertionError


def rolled(opened, speed, stiffness, damping, end, method, more=None):
    values = BALL | resisting("rolling", stiffness, damping)
    values |= {
        "source.initial_velocity": [speed, 0.0, 0.0],
        "source.initial_angular_velocity": [0.0, speed / RADIUS, 0.0],
        "contact.friction": "elastic",
        "contact.friction_coefficient": 0.5,
        "contact.static_friction_coefficient": 0.5,
        "contact.tangential_stiffness": K_T,
        "contact.tangential_damping": C_T,
    }
    return run(opened("SpherePlane"), values | (more or {}), end, 2, 1e-11, method)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("damping", [0.0, 0.01, 0.2])
def test_a_rolling_ball_stops_as_the_piecewise_linear_motion_does(opened, damping, method):
    """With the third dashpot it slides from the start on."""
    speed = 0.3
    ball = Rolling(speed, STIFFNESS, damping)
    (_, _), (breaks, _), (sticks, _) = ball.events
    assert (breaks > 0.0) == (damping < 0.1)
    energy = 0.7 * MASS * speed**2
    for time in (0.5 * (breaks + sticks), sticks + 0.03, sticks + 0.4):
        fmu = rolled(opened, speed, STIFFNESS, damping, time, method)
        x, v, w, s, a, _ = ball.at(time)
        stored = 0.5 * STIFFNESS * a**2 + 0.5 * K_T * s**2
        left = 0.5 * MASS * v**2 + 0.5 * INERTIA * w**2
        check_close("position", fmu["source.position"][0], x, 1e-9)
        check_close("velocity", fmu["source.velocity"][0], v, 1e-9)
        check_close("rate", fmu["source.angular_velocity"][1], w, 1e-8)
        check_close("energy.tangential", fmu["energy.tangential"], stored, 1e-9 * energy)
        check_close("energy.friction", fmu["energy.friction"], energy - stored - left, 1e-9 * energy)
    check_close("solver.events", fmu["solver.events"], 1 + (breaks > 0.0), 0)


def test_a_ball_on_a_sticking_spring_swings_with_the_period_of_rolling_without_slip(opened):
    """2 pi sqrt((I + m r^2)/k), but for the friction spring's part k/(k_t r^2) = 2e-3 of the compliance."""
    omega = math.sqrt(STIFFNESS / (1.4 * MASS * RADIUS**2))
    period = 2 * math.pi / omega
    speed = 0.5 * RADIUS * omega * LIMIT / STIFFNESS  # half of what would break it away
    fmu = rolled(opened, speed, STIFFNESS, 0.0, period, "event_driven")
    check_relative("velocity after a period", fmu["source.velocity"][0], speed, 1e-3)
    fmu = rolled(opened, speed, STIFFNESS, 0.0, 0.25 * period, "event_driven")
    check_relative("way of a quarter", fmu["source.position"][0], speed / omega, 2e-3)
    check_close("solver.events", fmu["solver.events"], 0, 0)


@pytest.mark.parametrize("stiffness", [20.0, 200.0])
def test_the_way_of_rolling_approaches_that_of_a_rigid_resistance(opened, stiffness):
    """7 v^2/(10 mu_r g): L takes all energy, since the dashpot lets the spring slide from the start on; then
    the ball rolls back by the spring's angle L/k. Friction, whose spring is stiff, adds 1e-7 m.
    """
    speed, inertia = 0.3, 1.4 * MASS * RADIUS**2
    rigid = {"contact.tangential_stiffness": 1e7, "contact.tangential_damping": 2000.0}
    damping = 2.0 * math.sqrt(stiffness * inertia)
    assert damping * speed / RADIUS > LIMIT
    fmu = rolled(opened, speed, stiffness, damping, 3.0, "event_driven", rigid)
    assert np.linalg.norm(fmu["source.velocity"]) < 1e-9
    way = 7 * speed**2 / (10 * MU * G) - fmu["source.position"][0]
    check_close("way", way, RADIUS * LIMIT / stiffness, 1e-7)
