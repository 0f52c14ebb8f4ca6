"""Three balls of one size in a row, undamped: scipy's DOP853 at 1e-13, restarted wherever a contact begins or
ends.
"""

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

REACH, STIFFNESS, END = 0.2, 1e6, 0.5


def gaps(state):
    places = state[:9].reshape(3, 3)
    return np.linalg.norm(np.diff(places, axis=0), axis=1) - REACH


def rates(state, touching, masses):
    places, velocities = state[:9].reshape(3, 3), state[9:]
    forces = np.zeros((3, 3))
    for k in range(2):
        if touching[k]:
            apart = places[k + 1] - places[k]
            distance = np.linalg.norm(apart)
            push = -STIFFNESS * (distance - REACH) * apart / distance
            forces[k] -= push
            forces[k + 1] += push
    return np.concatenate([velocities, (forces / masses[:, None]).ravel()])


@cache
def reference(case):
    """Places and velocities at END, nine numbers each"""
    places, velocities, masses = (np.array(values) for values in CASES[case])
    time, state = 0.0, np.concatenate([np.ravel(places), np.ravel(velocities)])
    touching = [bool(gap < 0) for gap in gaps(state)]
    while time < END:

        def event(k, until=tuple(touching)):
            def gap(_, y):
                return gaps(y)[k]

            gap.terminal, gap.direction = True, 1.0 if until[k] else -1.0
            return gap

        run = solve_ivp(
            lambda _, y, now=tuple(touching): rates(y, now, masses),
            (time, END),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
            max_step=2e-3,
            events=[event(0), event(1)],
        )
        time, state = run.t[-1], run.y[:, -1]
        for k in range(2):
            touching[k] ^= bool(len(run.t_events[k]))
    return state


REST = [0.0, 0.0, 0.0]
CASES = {  # places, velocities, masses
    "almost touching": (
        [[-0.3, 0, 0], [0, 0, 0], [0.2001, 0, 0]],
        [[1.0, 0, 0], REST, REST],
        [1.0, 1.0, 1.0],
    ),
    "oblique": (
        [[-0.3, 0.05, 0], [0, 0, 0], [0.2002, 0.01, 0.02]],
        [[2.0, 0, 0.1], REST, REST],
        [1.0, 0.5, 3.0],
    ),
    "far apart": ([[-0.3, 0, 0], [0, 0, 0], [0.4, 0.03, 0]], [[3.0, 0, 0], REST, REST], [2.0, 1.0, 0.1]),
}


NAMED = list(CASES)


def random_case(seed):
    """Three balls in a row or almost so: apart, touching to a millionth, pressed in."""
    random = np.random.default_rng([9, seed])
    left, right = random.choice([0.1, 1e-4, 1e-6, 0.0, -1e-6, -0.03], size=2)
    places = np.array([[-REACH - left, 0, 0], [0, 0, 0], [REACH + right, 0, 0]])
    places += random.normal(size=(3, 3)) * random.choice([0.0, 1e-6, 0.01])
    velocities = random.normal(size=(3, 3)) * random.choice([0.0, 0.01, 1.0], size=(3, 1))
    velocities[:, 0] += [random.choice([0, 1, 3]), 0, -random.choice([0, 1, 3])]
    return places.tolist(), velocities.tolist(), 10 ** random.uniform(-1, 1, size=3)


CASES |= {f"random {seed}": random_case(seed) for seed in range(12)}
