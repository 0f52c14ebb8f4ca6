"""Head-on scenes in which everything is extreme at once, drawn at random"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .head_on import GEOMETRIES, LAWS, HeadOn

SEED = 20
GROUPS, SIZE = 10, 40


def power(random: np.random.Generator, first: float, last: float) -> float:
    return float(10 ** random.uniform(first, last))


def drawn(random: np.random.Generator) -> HeadOn:
    """Within the ranges of the other axes; half of the scenes know no gravity, force or offset"""
    geometry = GEOMETRIES[random.integers(4)]
    large = power(random, -9, 6)
    small = large * power(random, -9, -0.05)
    inside = geometry.endswith("inside")
    radii = (small, large) if inside or random.integers(2) else (large, small)
    reach = large - small if inside else large + small
    mass = power(random, -9, 9)
    return HeadOn(
        geometry=geometry,
        law=LAWS[random.integers(5)],
        dashpot=LAWS[1 + random.integers(3)],
        source_radius=radii[0],
        destination_radius=radii[1],
        gap=reach * power(random, -6, 0),
        speed=power(random, -6, 6),
        source_mass=mass,
        destination_mass=mass * power(random, -12, 12) if random.integers(2) else None,
        penalty=power(random, 0, 15),
        ratio=power(random, -4, 2),
        gravity=9.81 * random.integers(2),
        force=power(random, -3, 12) * (random.random() < 0.3),
        offset=power(random, 0, 9) * (random.random() < 0.3),
    )


def scenes() -> Iterator[tuple[int, int, HeadOn]]:
    """Group, number and motion"""
    for group in range(GROUPS):
        for number in range(SIZE):
            yield group, number, drawn(np.random.default_rng([SEED, group, number]))
