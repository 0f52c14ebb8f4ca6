"""Three balls in a row: scipy's DOP853 at 1e-12, restarted wherever a contact changes its regime.

A contact is apart, presses (F = -(k g + c g')), recedes (F = -k g: a dashpot that acts on approach only) or
is separating (F = 0: a dashpot that does not pull, until its force presses again or the gap opens). Under
Hertz's law, F = k (-g)^(3/2), there is no dashpot.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

REACH, STIFFNESS, END = 0.2, 1e6, 0.5
REST = [0.0, 0.0, 0.0]


class Case(NamedTuple):
    places: list
    velocities: list
    masses: list
    dashpot: str = "unclamped"
    damping: tuple = (0.0, 0.0)  # of either contact
    radii: tuple = (REACH / 2, REACH / 2, REACH / 2)
    laws: tuple = ("linear", "linear")
    stiffness: tuple = (STIFFNESS, STIFFNESS)
    end: float = END


def gap(case, state, contact):
    """Gap, its rate, direction to the next ball"""
    apart, rate = (np.diff(half.reshape(3, 3), axis=0)[contact] for half in (state[:9], state[9:]))
    distance = np.linalg.norm(apart)
    return distance - case.radii[contact] - case.radii[contact + 1], apart @ rate / distance, apart / distance


def width(case, state, contact):
    return gap(case, state, contact)[0]


def margin(case, state, contact):
    """The quantity at whose zero the dashpot's regime changes"""
    g, rate, _ = gap(case, state, contact)
    return rate if case.dashpot == "approach_only" else -force(case, contact, g, rate)


def started(case, state, contact):
    if width(case, state, contact) >= 0:
        return "apart"
    if case.dashpot == "unclamped" or margin(case, state, contact) < 0:
        return "compression"
    return "restitution" if case.dashpot == "approach_only" else "separating"


def force(case, contact, g, rate, damps=True):
    if case.laws[contact] == "hertz":
        return case.stiffness[contact] * max(-g, 0.0) ** 1.5
    return -(case.stiffness[contact] * g + damps * case.damping[contact] * rate)


def rates(case, state, regimes):
    forces = np.zeros((3, 3))
    for contact, regime in enumerate(regimes):
        g, rate, direction = gap(case, state, contact)
        if regime in ("compression", "restitution"):
            push = force(case, contact, g, rate, damps=regime == "compression") * direction
            forces[contact] -= push
            forces[contact + 1] += push
    return np.concatenate([state[9:], (forces / np.array(case.masses)[:, None]).ravel()])


def changes(case, regimes):
    """(contact, next regime, event) of all that may happen"""
    other = "restitution" if case.dashpot == "approach_only" else "separating"
    for contact, regime in enumerate(regimes):
        touches = regime == "apart"
        yield contact, "compression" if touches else "apart", crossing(case, width, contact, touches)
        if regime == "compression" and case.dashpot != "unclamped" and case.damping[contact] > 0.0:
            yield contact, other, crossing(case, margin, contact, False)
        if regime == other:
            yield contact, "compression", crossing(case, margin, contact, True)


def crossing(case, quantity, contact, falls):
    def event(_, state):
        return quantity(case, state, contact)

    event.terminal, event.direction = True, -1.0 if falls else 1.0
    return event


@cache
def reference(name):
    """Places and velocities at the end, nine numbers each"""
    case = (CASES | BRIEF)[name]
    time, state = 0.0, np.concatenate([np.ravel(case.places), np.ravel(case.velocities)])
    regimes = [started(case, state, contact) for contact in range(2)]
    while time < case.end:
        possible = list(changes(case, regimes))
        run = solve_ivp(
            lambda _, y, now=tuple(regimes): rates(case, y, now),
            (time, case.end),
            state,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
            max_step=case.end / 250,
            events=[event for _, _, event in possible],
        )
        time, state = run.t[-1], run.y[:, -1]
        for (contact, regime, _), times in zip(possible, run.t_events, strict=True):
            if len(times):
                regimes[contact] = regime
    return state


def random_case(seed, damped):
    """In a row or almost so: apart, touching to a millionth, pressed in."""
    random = np.random.default_rng([9, seed])
    left, right = random.choice([0.1, 1e-3, 1e-6, 0.0, -1e-6, -0.03], size=2)
    places = np.array([[-REACH - left, 0, 0], [0, 0, 0], [REACH + right, 0, 0]])
    places += random.normal(size=(3, 3)) * random.choice([0.0, 1e-6, 0.01])
    velocities = random.normal(size=(3, 3)) * random.choice([0.0, 0.01, 1.0], size=(3, 1))
    velocities[:, 0] += [random.choice([0, 1, 3]), 0, -random.choice([0, 1, 3])]
    masses = 10 ** random.uniform(-1, 1, size=3)
    case = Case(places.tolist(), velocities.tolist(), masses.tolist())
    if not damped:
        return case
    critical = 2 * np.sqrt(STIFFNESS / (1 / masses[:2] + 1 / masses[1:]))
    damping = critical * 10 ** random.uniform(-2, 0.7, size=2)
    return case._replace(dashpot=DASHPOTS[seed % 3], damping=tuple(damping.tolist()))


DASHPOTS = ["non_adhesive", "unclamped", "approach_only"]
CASES = {
    "almost touching": Case([[-0.3, 0, 0], REST, [0.2001, 0, 0]], [[1.0, 0, 0], REST, REST], [1.0, 1.0, 1.0]),
    "oblique": Case(
        [[-0.3, 0.05, 0], REST, [0.2002, 0.01, 0.02]], [[2.0, 0, 0.1], REST, REST], [1.0, 0.5, 3.0]
    ),
    "far apart": Case([[-0.3, 0, 0], REST, [0.4, 0.03, 0]], [[3.0, 0, 0], REST, REST], [2.0, 1.0, 0.1]),
}
NAMED = list(CASES)
CASES |= {f"undamped {seed}": random_case(seed, damped=False) for seed in range(12)}
CASES |= {f"damped {seed}": random_case(seed, damped=True) for seed in range(18)}

# Contacts that are brief beside the end and, under Hertz's law, begin without a force that would tell how
# brief; and a ball that flies past, or strikes, one of a slow pair.
BRIEF = {
    "struck from both sides": Case(
        [[0, 0, 0], [0.7002, 0, 0], [1.6702, 0, 0]],
        [[70, 0, -0.7], [-14, 13, 5], [-75, -1, -0.6]],
        [0.03, 0.6, 30.0],
        radii=(0.5, 0.2, 0.7),
        laws=("hertz", "linear"),
        stiffness=(1e4, 5e3),
        end=0.2,
    ),
    "nearly touching": Case(
        [[0, 0, 0], [0.681, 0, 0], [1.1850008, 0.3780006, 0]],
        [[0.3, 0, 0], [0, -0.1, 0], [-0.3, 0, 0]],
        [1.5, 14.0, 1.4],
        radii=(0.08, 0.6, 0.03),
        laws=("linear", "hertz"),
        stiffness=(5e6, 1e7),
        end=28.0,
    ),
    "glancing": Case(
        [[0, 0, 0], [1.088, -0.306, 0.0227], [1.4172, -0.3126, 0.0457]],
        [[0, 0, 0], [25, -0.4, -30], [0.4, -0.5, -1.8]],
        [0.035, 11.0, 1.2],
        radii=(0.9, 0.23, 0.1),
        laws=("hertz", "hertz"),
        stiffness=(1.4e6, 2.8e7),
        end=0.165,
    ),
    "struck in passing": Case(  # a step of the soft pair is longer than the third ball's whole way
        [[0, 0, 0], [0.28, 0, 0], [5.28, 0.15, 0]],
        [[0, 0, 0], [0, 0, 0], [-50, 0, 0]],
        [1.0, 1.0, 2.0],
        radii=(0.2, 0.1, 0.1),
        stiffness=(30.0, 1e6),
        end=0.3,
    ),
    "missed by a hair": Case(
        [[0, 0, 0], [0.28, 0, 0], [5.28, 0.2001, 0]],
        [[0, 0, 0], [0, 0, 0], [-50, 0, 0]],
        [1.0, 1.0, 2.0],
        radii=(0.2, 0.1, 0.1),
        stiffness=(30.0, 1e6),
        end=0.104,  # before it would strike the other one
    ),
}
