"""The Taylor integrator on the scenes that its families add: against numbers found in other ways, and against
forty digits.
"""

from decimal import Decimal

import numpy as np
import pytest

from support.checks import check_close
from support.reference.integrator import Reference
from support.scenes.scene_families import FAMILIES, drawn, expected

# The line, cylinder and plane of these are simple enough for other means (closed forms, mpmath, long double).
STILL = [0.0, 0.0, 0.0]


def test_a_given_chord_through_a_sphere():
    """x = -1 + 3 t at a distance of 0.1: touching between the roots of x^2 = 0.6^2 - 0.1^2, and pushed while
    it comes nearer.
    """
    values = {"source.motion": "prescribed", "source.center": [-1.0, 0.1, 0.0]}
    values["source.prescribed_velocity"] = [3.0, 0.0, 0.0]
    found = Reference(values, "sphere").run(2.0)
    half = 0.35**0.5
    check_close("onset", found.onset_times, [(1 - half) / 3], 1e-15)
    check_close("duration", found.durations, [2 * half / 3], 1e-15)
    assert len(found.event_times) == 3
    check_close("dissipated", found.dissipated, 270.72014, 5e-6)
    check_close("peak penetration", found.peak_penetration, 0.5, 1e-14)


def test_a_ball_against_a_dashpot_through_the_axis_of_a_tilted_cylinder():
    """Across the axis: from 0.6 on m v' = -c v, so that v falls by c/m times the way, until the axis, where
    it is let go.
    """
    values = {
        "source.center": [0.5, -0.5, 0.0],
        "source.initial_velocity": [0.0, 1.0, 0.5],
        "destination.axis": [1.0, 1.0, 1.0],
        "contact.location": "outside",
        "contact.penalty_control": "viscous_only",
        "contact.viscous_penalty_factor": 0.2,
        "gravity": STILL,
    }
    found = Reference(values, "cylinder", straight=True).run(1.5)
    speed = 0.5**0.5
    touch = (0.5**0.5 - 0.6) / speed
    through = touch - np.log(1 - 0.2 * 0.6 / speed) / 0.2
    beyond = (speed - 0.2 * 0.6) * (1.5 - through)
    across = np.array([-1.0, 1.0, 0.0]) / 2**0.5
    check_close("position", found.position["source"], beyond * across + 0.75, 1e-14)
    check_close("events", found.event_times, [touch, through], 1e-14)


def test_a_ramp_against_a_contact_beyond_critical_damping():
    """As right to 1e-15 by the two exponentials of a scene that starts with 1e-6 N."""
    values = {
        "source.center": [0.404, 0.0, 0.0],
        "source.external_force.derivatives": [[100.0, 100.0, 0.0]],
        "contact.location": "inside",
        "contact.penalty_factor": 250.0,
        "contact.viscous_penalty_factor": 150.0,
        "contact.dashpot": "unclamped",
        "gravity": STILL,
    }
    found = Reference(values, "sphere").run(0.15)
    right = [0.406656168423122, 0.054633893477733, 0.0]
    check_close("position", found.position["source"], right, 1e-15)


def test_a_light_ball_at_the_end_of_a_heavy_cylinder():
    values = {
        "destination.motion": "free",
        "destination.mass": 1e6,
        "destination.axis": [0.0, 1.0, 0.0],
        "destination.finite_length": True,
        "source.center": [0.605, 0.4, 0.0],
        "source.initial_velocity": [-0.01, 0.199, 0.0],
        "contact.location": "outside",
        "contact.method": "penalty",
        "contact.penalty_factor": 1e4,
    }
    found = Reference(values, "cylinder").run(1.0)
    check_close("x", found.position["source"][0], 0.595156470363825, 1e-15)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("family", FAMILIES)
def test_forty_digits_and_a_higher_order_change_nothing(family, seed):
    scene = drawn(family, seed)
    quick, exact = expected(scene), expected(scene, Decimal, 28)

    def row(found):
        return np.array([[float(x) for x in v] for v in (*found.position.values(), *found.velocity.values())])

    check_close("position and velocity", row(quick), row(exact), 1e-10)
    for name in ("dissipated", "external_work", "peak_penetration"):
        check_close(name, getattr(quick, name), float(getattr(exact, name)), 1e-9)
    peak = float(exact.peak_force)
    check_close("peak_force", quick.peak_force, peak, 1e-9 * max(1.0, peak, quick.penalty * 1e-3))
    assert quick.onsets == exact.onsets or (quick.just_touches and 0.0 not in quick.onset_times)
    most = len(quick.event_times) + quick.just_touches
    assert quick.sure_events() <= len(exact.event_times) <= most
