"""closed_forms.py against the same formulas by complex numbers, and numerical integration"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contact_fmus.scenarios import closed_forms
from support.scenes.head_on import oscillator

DAMPING_RATIOS = (0.0, 1e-3, 0.05, 0.3, 0.7, 0.99, 1.01, 2.5, 20.0)


@pytest.mark.parametrize("zeta", DAMPING_RATIOS)
def test_restitution_and_duration_are_those_of_the_oscillator_by_complex_phases(dashpot, zeta):
    if dashpot == "unclamped" and zeta > 0.98:
        assert closed_forms.restitution(dashpot, zeta) < 1e-9
        return
    expected = oscillator(dashpot, 1.0, 1.0, 2.0 * zeta)
    duration = closed_forms.overlap_duration(dashpot, 1.0, 1.0, 2.0 * zeta)
    assert closed_forms.restitution(dashpot, zeta) == pytest.approx(expected.restitution, rel=1e-8)
    assert duration == pytest.approx(expected.duration, rel=1e-8)


def test_an_unclamped_dashpot_at_or_above_critical_damping_never_parts():
    assert closed_forms.restitution("unclamped", 1.0) == 0.0
    assert math.isinf(closed_forms.overlap_duration("unclamped", 1.0, 1.0, 2.0))


def test_elastic_bounce_is_that_of_the_quadruple_precision_reference():
    """P1: dropped from a gap of 0.5 m, the centres 0.6 m apart when touching, after 5 s"""
    gap = closed_forms.elastic_bounce_gap(np.array([5.0]), 0.5, 1.0, 9.81, 1e6)[0]
    assert 0.6 + gap == pytest.approx(1.0124643381657108, abs=1e-12)


def test_velocities_after_conserve_momentum_and_set_the_restitution():
    after = closed_forms.velocities_after(2.0, 3.0, 5.0, -1.0, e=0.4)
    assert 2.0 * after[0] + 5.0 * after[1] == pytest.approx(2.0 * 3.0 - 5.0, rel=1e-14)
    assert after[1] - after[0] == pytest.approx(0.4 * 4.0, rel=1e-14)
    assert closed_forms.velocities_after(2.0, 3.0, math.inf, -1.0) == (-5.0, -1.0)


def test_viscous_sinking_is_the_integrated_motion():
    run = solve_ivp(lambda _t, y: [y[1], 9.81 - 40.0 * y[1]], (0.0, 0.3), [0.0, 0.0], rtol=1e-12, atol=1e-14)
    found = closed_forms.viscous_sinking(np.array([0.3]), 2.0, 9.81, 80.0)[0]
    assert found == pytest.approx(run.y[0, -1], rel=1e-9)


def test_cylinder_extent_contains_the_cylinder_and_touches_it():
    rng = np.random.default_rng(1)
    axis = rng.normal(size=3)
    unit = axis / np.linalg.norm(axis)
    side = np.linalg.svd(unit[None])[2][1:]
    angle = np.linspace(0.0, 2.0 * math.pi, 4001)
    rim = 0.3 * (np.outer(np.cos(angle), side[0]) + np.outer(np.sin(angle), side[1])) + 0.7 * unit
    extent = closed_forms.cylinder_extent(0.3, axis, 1.4)
    assert np.max(np.abs(rim), axis=0) == pytest.approx(extent, abs=1e-6)
    assert closed_forms.cylinder_extent(0.3, [0.0, 0.0, 2.0], 0.0) == pytest.approx([0.3, 0.3, 0.0])


def test_a_pendulum_let_go_swings_as_its_equation_says():
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    run = solve_ivp(lambda _t, y: [y[1], -4.0 * math.sin(y[0])], (0.0, 7.0), [2.5, 0.0], **options)
    assert closed_forms.pendulum(run.t, 2.5, 2.0) == pytest.approx(run.y[0], abs=1e-10)


@pytest.mark.parametrize("slip", [1e-3, 0.3])
def test_a_driven_roller_turns_as_its_equation_says(slip):
    def faster(_t, y):
        return [0.2 / 0.01 * 3.0 * -np.expm1(-(2.0 - 0.2 * y[0]) / slip)]

    run = solve_ivp(faster, (0.0, 0.4), [0.0], "Radau", rtol=1e-10, atol=1e-12)
    assert closed_forms.friction_drive(run.t, 2.0, 0.2, 0.01, 3.0, slip) == pytest.approx(run.y[0], abs=1e-7)


def test_a_ball_rolls_in_a_groove_as_without_slip():
    """The contact point of a ball of radius r rests: 2/5 m r^2 omega' = r n x F and m x'' = F - m g x/l."""

    # Friction as a Lagrange multiplier makes the accelerations of centre and surface agree.
    def rolling(_t, y):
        pull = -9.81 * y[:2] / np.array([1.15, 0.15])
        friction = -pull / (1.0 + 1.0 / 0.4)
        return np.concatenate([y[2:], pull + friction])

    run = solve_ivp(rolling, (0.0, 5.0), [1e-3, -2e-3, 0.0, 0.0], "DOP853", rtol=1e-11, atol=1e-14)
    expected = closed_forms.rolling_in_a_groove(run.t, np.array([1e-3, -2e-3]), np.array([1.15, 0.15]), 9.81)
    assert expected == pytest.approx(run.y[:2].T, abs=1e-10)
