"""Three balls in a row, by the reference of islands: named cases, random ones, contacts that are brief."""

from functools import cache
from typing import NamedTuple

import numpy as np

from support.checks import DASHPOTS
from support.reference.islands import Islands
from support.reference.kept import kept

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


@cache
def reference(name):
    """Returns places of the balls at the end, a row for each."""
    case = (CASES | BRIEF)[name]
    given = zip(case.radii, case.masses, case.places, case.velocities, strict=True)
    free = {"motion": "free", "rotation": "none", "spin": REST, "force": REST}
    balls = [free | {"radius": r, "mass": m, "center": place, "velocity": v} for r, m, place, v in given]
    plain = {"friction": "none", "mu": 0.0, "mu_static": 0.0, "v_0": 1.0, "k_t": 1.0, "c_t": 1.0}
    plain["dashpot"] = case.dashpot
    contacts = [
        plain | {"source": k, "destination": k + 1, "law": law, "k": stiffness, "c": damping}
        for k, law, stiffness, damping in zip((0, 1), case.laws, case.stiffness, case.damping, strict=True)
    ]
    scene = (balls, [], contacts, REST)
    return kept([*scene, case.end], lambda: Islands(*scene).run(case.end, 1e-12, case.end / 80)[0][:, :3])


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


CASES = {
    "almost touching": Case([[-0.3, 0, 0], REST, [0.2001, 0, 0]], [[1.0, 0, 0], REST, REST], [1.0, 1.0, 1.0]),
    "oblique": Case([[-0.3, 0.05, 0], REST, [0.2002, 0.01, 0.02]], [[2.0, 0, 0.1], REST, REST], [1, 0.5, 3]),
    "far apart": Case([[-0.3, 0, 0], REST, [0.4, 0.03, 0]], [[3.0, 0, 0], REST, REST], [2.0, 1.0, 0.1]),
}
NAMED = list(CASES)
CASES |= {f"undamped {seed}": random_case(seed, damped=False) for seed in range(12)}
CASES |= {f"damped {seed}": random_case(seed, damped=True) for seed in range(18)}

# Contacts that are brief beside the end and, under Hertz's law, begin without a force that would tell how
# brief; and a ball that flies past, or strikes, one of a slow pair.
BRIEF = {
    "struck from both sides": Case([[0, 0, 0], [0.7002, 0, 0], [1.6702, 0, 0]],
        [[70, 0, -0.7], [-14, 13, 5], [-75, -1, -0.6]], [0.03, 0.6, 30.0], radii=(0.5, 0.2, 0.7),
        laws=("hertz", "linear"), stiffness=(1e4, 5e3), end=0.2),
    "nearly touching": Case([[0, 0, 0], [0.681, 0, 0], [1.1850008, 0.3780006, 0]],
        [[0.3, 0, 0], [0, -0.1, 0], [-0.3, 0, 0]], [1.5, 14.0, 1.4], radii=(0.08, 0.6, 0.03),
        laws=("linear", "hertz"), stiffness=(5e6, 1e7), end=28.0),
    "glancing": Case([[0, 0, 0], [1.088, -0.306, 0.0227], [1.4172, -0.3126, 0.0457]],
        [[0, 0, 0], [25, -0.4, -30], [0.4, -0.5, -1.8]], [0.035, 11.0, 1.2], radii=(0.9, 0.23, 0.1),
        laws=("hertz", "hertz"), stiffness=(1.4e6, 2.8e7), end=0.165),
    # a step of the soft pair is longer than the third ball's whole way
    "struck in passing": Case([[0, 0, 0], [0.28, 0, 0], [5.28, 0.15, 0]],
        [[0, 0, 0], [0, 0, 0], [-50, 0, 0]], [1.0, 1.0, 2.0], radii=(0.2, 0.1, 0.1),
        stiffness=(30.0, 1e6), end=0.3),
    # it ends before it would strike the other one
    "missed by a hair": Case([[0, 0, 0], [0.28, 0, 0], [5.28, 0.2001, 0]],
        [[0, 0, 0], [0, 0, 0], [-50, 0, 0]], [1.0, 1.0, 2.0], radii=(0.2, 0.1, 0.1),
        stiffness=(30.0, 1e6), end=0.104),
}  # fmt: skip
