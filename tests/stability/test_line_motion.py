"""The atlas's closed forms against other ways to the same motion: bounce trains, the Taylor integrator,
restitution and duration of a single impact.
"""

import math
from dataclasses import replace
from decimal import Decimal, localcontext

import pytest
from mpmath import mp, mpf, odefun
from scipy.integrate import solve_ivp

from contact_fmus.scenarios.closed_forms import overlap_duration, restitution
from contact_fmus.stability.expected import of_head_on
from contact_fmus.stability.head_on import GEOMETRIES, LAWS, PLANE, HeadOn
from contact_fmus.stability.impact import Impact
from contact_fmus.stability.line_motion import Line
from contact_fmus.stability.swing import Swing
from support.checks import check_close
from support.reference.bounce_train import Ball
from support.reference.integrator import Reference

SHAPES = {"SphereSphere": "sphere", "SphereCylinder": "cylinder", "SpherePlane": "plane"}


@pytest.mark.parametrize("damping", [0.0, 200.0])
@pytest.mark.parametrize("dashpot", ["non_adhesive", "unclamped"])
def test_a_bounce_train_is_that_of_the_other_closed_form(dashpot, damping):
    train = Ball(mpf(1), mpf(1e6), mpf(damping), mpf(9.81), dashpot == "non_adhesive").train(mpf(0.5), mpf(6))
    motion = HeadOn(law=dashpot, gap=0.5, speed=0.0, damping=damping, end=6.0)
    line = motion.line().run(motion.end)
    assert len(line.onset_times) == len(train.onset_times) > 5
    for ours, theirs in zip(line.onset_times, train.onset_times, strict=True):
        assert abs(ours - theirs) < 1e-40


@pytest.mark.parametrize(
    "geometry, law, ratio",
    [(geometry, law, 0.2) for geometry in (*GEOMETRIES, PLANE) for law in LAWS]
    + [("sphere outside", law, ratio) for law in LAWS[1:] for ratio in (0.05, 1.5)],
)
def test_a_head_on_scene_ends_where_the_taylor_integrator_says(geometry, law, ratio):
    """But for the middle of a solid body, which that one does not know: a dashpot alone stops before it."""
    damping = 200.0 * ratio + 30.0 if law == "viscous_only" else None
    motion = HeadOn(geometry=geometry, law=law, ratio=ratio, damping=damping, penalty=1e4, force=3.0, end=0.4)
    expected = of_head_on(motion)
    shape = SHAPES[motion.fmu]
    with localcontext(prec=40):
        reference = Reference(motion.configuration(), shape, number=Decimal, order=24).run(0.4)
    moved = reference.position["source"][2] - Decimal(motion.source_center()[2])
    check_close("displacement", float(expected.displacement["source"][2]), float(moved), 1e-14)
    assert expected.onsets == reference.onsets >= 1
    check_close("onset", expected.last_onset, float(reference.onset_times[-1]), 1e-14)


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.2, 0.999])
@pytest.mark.parametrize("law", ["non_adhesive", "unclamped", "approach_only"])
def test_an_impact_gives_back_and_lasts_as_theory_says(law, ratio):
    motion = HeadOn(law=law, ratio=ratio, gravity=0.0, end=1.0, penalty=1e6)
    line = motion.line().run(1.0)
    damping = motion.dashpot_factor
    check_close("restitution", float(line.speed), restitution(law, ratio), 1e-13)
    lasts = overlap_duration(law, 1.0, 1e6, damping)
    check_close("duration", float(line.last_duration), lasts, 1e-12 * lasts)


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "approach_only"])
def test_an_impact_by_hertz_goes_as_its_equation(law):
    """Dormand and Prince's method of order 8, from the touch to the gap's next zero"""
    motion = Impact("plane", law, damped=0.0 if law == "undamped" else 0.7, speed=2.0)
    k, chi = 1e8, 0.0 if law == "undamped" else 0.35

    def rates(_, y):
        damping = 0.0 if law == "approach_only" and y[1] < 0 else chi
        return [y[1], -k * max(y[0], 0.0) ** 1.5 * (1 + damping * y[1])]

    def parts(t, y):
        return y[0] if t > 1e-6 else 1.0

    def turns(_, y):
        return y[1]

    parts.terminal = turns.terminal = True
    settings = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-18}
    forth = solve_ivp(rates, (0, 1), [0.0, 2.0], events=turns, **settings)
    back = solve_ivp(rates, (forth.t[-1], 1), forth.y[:, -1], events=parts, **settings)
    duration, after, depth = motion.impact
    check_close("depth", float(depth), forth.y[0, -1], 1e-10 * float(depth))
    check_close("duration", float(duration), back.t[-1], 1e-10 * float(duration))
    check_close("speed", float(after), -back.y[1, -1], 1e-10)


def test_two_free_bodies_keep_their_momentum():
    motion = HeadOn(source_mass=3.0, destination_mass=2.0, law="undamped", gravity=0.0, end=0.5)
    moved = of_head_on(motion).displacement
    check_close("momentum", float(3 * moved["source"][2] + 2 * moved["destination"][2]), -3.0 * 0.5, 1e-15)


def test_a_soft_body_is_passed_through_its_middle():
    """Without a dashpot it comes out as fast as it went in."""
    motion = HeadOn(law="undamped", penalty=4.0, speed=3.0, gravity=0.0, end=1.0)
    line = motion.line().run(1.0)
    assert line.place < -line.reach
    assert abs(line.speed + 3) < 1e-45
    half = mp.asin(motion.reach / (mpf(3) / 2)) / 2  # s = (v/omega) sin(omega t) reaches the middle
    assert abs(line.last_duration - 2 * half) < 1e-30


def test_an_end_of_the_cylinder_switches_the_contact_off():
    """Out of the contact half way, at its deepest: the ball stays where it is"""
    touch, half = 0.125, math.pi / 2 / 100
    motion = HeadOn("cylinder outside", "undamped", penalty=1e4, gravity=0.0, length=1.0, end=0.5)
    line = replace(motion, along=0.5 - touch - half, along_speed=1.0).line().run(0.5)
    check_close("speed", float(line.speed), 0.0, 1e-13)
    check_close("depth", float(line.depth()), 0.01, 1e-13)
    check_close("duration", float(line.last_duration), half, 1e-15)


@pytest.mark.parametrize("damping", [0, 3, 20, 25, 400])
@pytest.mark.parametrize("stiffness", [0, 100])
def test_a_swing_is_the_solution_of_its_equation(stiffness, damping):
    """100 and 20: critical damping"""
    swing = Swing(mpf(stiffness), mpf(damping), mpf(2), mpf("0.3"), mpf(-1))
    solve = odefun(lambda _, y: [y[1], 2 - damping * y[1] - stiffness * y[0]], 0, [mpf("0.3"), mpf(-1)])
    for t in (mpf("0.05"), mpf("0.4")):
        for ours, theirs in zip(swing.at(t), solve(t), strict=True):
            check_close("s", float(ours), float(theirs), 1e-14)


def test_the_first_change_of_sign_is_not_passed_over():
    """A decaying swing about 0.1: f = s - 0.1 - c changes its sign where samples say"""
    swing = Swing(mpf(100), mpf(1), mpf(10), mpf(1), mpf(0))
    for level in (0.0, 0.05, 0.11, 0.3):
        t = swing.first_change((mpf(1), mpf(0), -mpf(level)), mpf(100))
        assert abs(swing.at(t)[0] - level) < 1e-40
        assert all(swing.at(t * k / 200)[0] > level for k in range(200))
    assert swing.first_change((mpf(1), mpf(0), mpf(1)), mpf(100)) is None


def test_a_line_without_forces_goes_straight_on():
    line = Line(True, mpf(1), mpf(1), mpf(1), mpf(0), "unclamped", mpf(0), mpf(0), mpf(2)).run(0.25)
    assert (line.place, line.speed, line.onset_times) == (mpf(0.5), mpf(2), [])


def test_a_motion_of_more_pieces_than_anyone_waits_for_has_no_closed_form(monkeypatch):
    monkeypatch.setattr("contact_fmus.stability.line_motion.MOST_PIECES", 12)
    motion = HeadOn(law="undamped", gap=0.5, speed=0.0, end=2.0)
    assert len(motion.line().run(2.0).onset_times) == 3
    with pytest.raises(ArithmeticError, match="more than 12 pieces up to"):
        motion.line().run(200.0)
