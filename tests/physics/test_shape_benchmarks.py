"""The references of P1 and P2 on a plane and over a rim against others: the closed form of bounces along a
line in 40 digits (mpmath), and Dormand and Prince's method, which stops at the edges of zones (capped.py).
"""

import mpmath
import numpy as np
import pytest

from contact_fmus.bench.problems import law_benchmarks
from support.reference import capped

mpmath.mp.dps = 40
GRAVITY = mpmath.mpf("9.81")


def bounces(start, gap, stop):
    """How much higher than at the start a ball is that falls from `gap`, and its impacts: a parabola in
    flight and a damped oscillator under gravity in each contact, which ends where the gap is zero again."""
    mass, stiffness = mpmath.mpf(start["source.mass"]), mpmath.mpf(start["contact.penalty_factor"])
    damped = start["contact.method"] == "penalty_dynamic"
    decay = (start["contact.viscous_penalty_factor"] if damped else 0) / (2 * mass)
    omega = mpmath.sqrt(stiffness / mass - decay**2)
    sag = GRAVITY * mass / stiffness
    time, impacts, speed = mpmath.sqrt(2 * gap / GRAVITY), 0, mpmath.sqrt(2 * gap * GRAVITY)
    while time < stop:
        impacts += 1
        other = (sag * decay - speed) / omega

        def height(t, other=other):
            swing = sag * mpmath.cos(omega * t) + other * mpmath.sin(omega * t)
            return mpmath.exp(-decay * t) * swing - sag

        about = (mpmath.pi + 2 * omega * sag / speed) / omega
        length = mpmath.findroot(height, (about, about * (1 + sag)))
        speed, time = mpmath.diff(height, length), time + length
        if time + 2 * speed / GRAVITY > stop:
            rest = stop - time
            assert rest > 0  # else the end is in the contact
            return speed * rest - GRAVITY * rest**2 / 2 - gap, impacts
        time += 2 * speed / GRAVITY
    raise AssertionError("no impact")


@pytest.mark.parametrize("name, impacts", [("P1 plane", 8), ("P2 plane", 3), ("P1 rim", 3)])
def test_references_of_bounces_along_the_normal_are_the_closed_form(name, impacts):
    """Motion along the plane is uniform; the rim of P1 is 0.5 m high to rounding, straight below the ball."""
    problem = law_benchmarks()[name]
    center = problem.start["source.center"]
    gap = mpmath.mpf(center[2]) - mpmath.mpf("0.5") - mpmath.mpf(problem.start["source.radius"])
    higher, found = bounces(problem.start, gap, problem.stop)
    assert found == impacts
    along = [v * problem.stop for v in problem.start.get("source.initial_velocity", (0.0, 0.0, 0.0))]
    expected = np.add(center, along) + np.array([0.0, 0.0, float(higher)])
    assert problem.error(expected) < (2e-12 if name == "P1 rim" else 1e-14)


@pytest.mark.parametrize("name, zones", [("P1 rim", ["rim"]), ("P2 rim", ["rim", "cap", "rim"])])
def test_references_of_impacts_on_a_rim_are_those_of_another_method(name, zones):
    problem = law_benchmarks()[name]
    start = problem.start
    damped = start["contact.method"] == "penalty_dynamic"
    pair = capped.CappedPair(
        start["source.radius"],
        start["destination.radius"],
        start["destination.length"],
        tuple(start["destination.axis"]),
        (start["source.mass"], np.inf),
        (0.0, 0.0, -float(GRAVITY)),
        stiffness=start["contact.penalty_factor"],
        damping=start["contact.viscous_penalty_factor"] if damped else 0.0,
        dashpot=start.get("contact.dashpot", "non_adhesive"),
    )
    places = [*start["source.center"], *start["destination.center"], *[0.0] * 6]
    found = capped.run(pair, places, problem.stop)
    assert [zone for _, zone in found.zones] == zones
    assert problem.error(found.state[:3]) < 1e-11
