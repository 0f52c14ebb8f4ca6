"""A sphere on a plane under regularized friction with no load along the plane, which is a closed form: in all
that a run says against the reference, and against the formula

    u = v_0 ln(1 + (exp(u_0/v_0) - 1) exp(-mu kappa p / v_0)),   p = integral of F_n dt,   kappa = 1/m + r^2/I
"""

import math

import numpy as np
import pytest

from support.checks import check_close, differences, run
from support.reference.turning import follow
from support.scenes.agreement import Scene, check_agreement, seeds
from support.scenes.turning_checks import TurningFmuRun, rows
from support.scenes.turning_scenes import random_plane_scene

ALLOWED, BALANCE = 1e-9, 1e-12


@pytest.mark.parametrize("seed", seeds())
def test_a_ball_on_a_plane_goes_as_the_reference_says(opened, seed):
    scene, fmu = random_plane_scene(seed), opened("SpherePlane")
    expected = follow(scene.values, scene.shape, scene.end)
    found, wrong = TurningFmuRun(fmu, scene.values, scene.end, scene.steps, "event_driven"), []
    for name, (value, right, allowed) in rows(found, expected, ALLOWED).items():
        wrong += differences(name, value, right, allowed)
    wrong += differences("energy balance", found.stray, 0.0, BALANCE * max(1.0, found.in_play))
    assert not wrong, f"{wrong}\n{scene}"
    assert fmu["solver.fallbacks"] == 0  # the general segment takes no part
    assert fmu["contact.onsets"] == expected["contact.onsets"]


@pytest.mark.parametrize("seed", seeds())
def test_a_ball_on_a_plane_goes_the_same_at_every_tolerance_and_step(opened, seed):
    scene = random_plane_scene(seed)
    check_agreement(opened, Scene("SpherePlane", scene.values, scene.end, slack=1e3), seed)


R, M, MU, G = 0.1, 1.3, 0.3, 9.81
LAWS = {
    "linear": {"contact.penalty_factor": 1e6, "contact.viscous_penalty_factor": 30.0,
        "contact.dashpot": "non_adhesive"},
    "hertz": {"contact.law": "hertz", "contact.hertz_stiffness": 3e7,
        "contact.viscous_control": "user_defined", "contact.hunt_crossley_factor": 0.1,
        "contact.dashpot": "non_adhesive"},
}  # fmt: skip


def thrown(law, rotation, ratio, speed=2.0):
    """A ball thrown down to a floor with a slip of 2 m/s, spin about the normal included."""
    unit = speed / ratio if ratio > 0.0 else 0.1
    slip = speed if ratio > 0.0 else 0.0
    values = {"source.radius": R, "source.mass": M, "source.center": [0.0, 0.0, R + 0.02]}
    values |= {"source.rotation": rotation, "contact.friction": "regularized"}
    values |= {"contact.friction_coefficient": MU, "contact.slip_velocity_control": "user_defined"}
    values |= {"contact.characteristic_slip_velocity": unit, "contact.method": "penalty_dynamic"}
    values |= {"gravity": [0.0, 0.0, -G]}
    if rotation == "free":  # v + omega x (-r e_z) = slip (0.6, 0.8, 0)
        values["source.initial_angular_velocity"] = [2.0, -3.0, 15.0]
        values["source.initial_velocity"] = [0.6 * slip - 0.3, 0.8 * slip - 0.2, -1.0]
    else:
        values["source.initial_velocity"] = [0.6 * slip, 0.8 * slip, -1.0]
    return values | LAWS[law], unit


def slip_of(velocity, spin):
    return velocity[:2] + R * np.array([-spin[1], spin[0]])


def lost_by(begin, unit, kappa, impulse):
    """u_0 - u by the formula, for one impulse or many at once."""
    ratio = begin / unit
    left = ratio - MU * kappa * impulse / unit
    small = -math.expm1(-ratio)  # (exp(u_0/v_0) - 1) exp(-u_0/v_0)
    above, below = np.maximum(left, 0.0), np.minimum(left, 0.0)
    slides, rolls = above + np.log(np.exp(-above) + small), np.log1p(small * np.exp(below))
    return begin - unit * np.where(left > 0.0, slides, rolls)


@pytest.mark.parametrize("steps", [1, 7, 300])
@pytest.mark.parametrize("ratio", [0.0, 1e-3, 1.0, 30.0, 1e3, 1e8])
@pytest.mark.parametrize("rotation", ["none", "free"])
@pytest.mark.parametrize("law", LAWS)
def test_the_slip_is_that_of_the_formula_through_all_bounces(opened, law, rotation, ratio, steps):
    values, unit = thrown(law, rotation, ratio)
    end, fmu = 0.4, opened("SpherePlane")
    kappa = 1 / M + (R**2 / (0.4 * M * R**2) if rotation == "free" else 0.0)
    spin = np.array(values.get("source.initial_angular_velocity", [0.0, 0.0, 0.0]))
    begin = slip_of(np.array(values["source.initial_velocity"]), spin)

    def check(fmu):
        velocity = fmu["source.velocity"]
        now = fmu["source.angular_velocity"] if rotation == "free" else np.zeros(3)
        impulse = M * (velocity[2] + 1.0 + G * fmu.time)
        first = np.linalg.norm(begin)
        size = first - lost_by(first, unit, kappa, impulse)
        direction = begin / np.linalg.norm(begin) if ratio > 0.0 else np.zeros(2)
        check_close("slip", slip_of(velocity, now), size * direction, 1e-12)
        check_close("spin about the normal", now[2], spin[2], 1e-14)
        # what friction takes from the momentum, it takes from the spin
        taken = M * (velocity[:2] - np.array(values["source.initial_velocity"])[:2])
        turned = 0.4 * M * R**2 * (now - spin)[:2]
        if rotation == "free":
            check_close("spin", turned, R * np.array([taken[1], -taken[0]]), 1e-14)

    run(fmu, values, end, steps, 1e-10, each=check)
    assert fmu["contact.onsets"] >= 2
    assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("stiffness", [1e6, 1e10])
@pytest.mark.parametrize("spin, steps", [([0.0] * 3, 1), ([0.0] * 3, 1000), ([3.0, -5.0, 20.0], 1)])
def test_an_oscillation_that_never_dies_away_costs_little_while_a_ball_slides(opened, stiffness, spin, steps):
    """Set down where it touches, undamped: p = m g (t - sin(w t)/w), 16 or 1,600 swings until it rolls. The
    way is a sum over Gauss-Legendre panels of a twentieth of a radian and less. Communication points end no
    phase but where friction ceases to be full."""
    unit, end = 1e-3, 0.5
    values = thrown("linear", "free", 2.0 / unit)[0] | {"source.center": [0.0, 0.0, R]}
    values |= {"source.initial_velocity": [1.0, 0.3, 0.0], "source.initial_angular_velocity": spin}
    values |= {"contact.method": "penalty", "contact.penalty_factor": stiffness}
    fmu = run(opened("SpherePlane"), values, end, steps, 1e-10)
    assert fmu["solver.steps"] < 100
    begin, swing = slip_of(np.array([1.0, 0.3]), np.array(spin)), math.sqrt(stiffness / M)
    size, kappa = np.linalg.norm(begin), 3.5 / M
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = 0.5 * end / 1_000_000
    middle = half * (2 * np.arange(1_000_000) + 1)
    lost = sum(
        half * weight * np.sum(lost_by(size, unit, kappa, M * G * (t - np.sin(swing * t) / swing)))
        for weight, t in ((weight, middle + half * node) for node, weight in zip(nodes, weights, strict=True))
    )
    way = np.array([1.0, 0.3]) * end - begin / size * lost / (kappa * M)
    check_close("way", fmu["source.position"][:2], way, 1e-11)
    check_close("slip", slip_of(fmu["source.velocity"], fmu["source.angular_velocity"]), [0.0, 0.0], 1e-12)


def test_a_cap_that_acts_is_left_to_the_general_segment(opened):
    """With F_max of a tenth of the largest mu F_n, and with one that is never reached."""
    values, fmu = thrown("linear", "free", 1e3)[0], opened("SpherePlane")
    for cap, fallbacks in ((30.0, True), (1e5, False)):
        capped = values | {"contact.maximum_friction_force": cap}
        expected = follow(capped, "plane", 0.15)
        found = TurningFmuRun(fmu, capped, 0.15, 3, "event_driven")
        wrong = []
        for name, (value, right, allowed) in rows(found, expected, 1e-8).items():
            wrong += differences(name, value, right, allowed)
        assert not wrong, f"{cap}: {wrong}"
        assert (fmu["solver.fallbacks"] > 0) == fallbacks


def test_a_load_along_the_plane_that_begins_and_ends_is_followed(opened):
    """A push of 2 N for a tenth of a second on a ball that rolls: the general segment takes that time."""
    values = thrown("linear", "free", 1e3)[0] | {"source.center": [0.0, 0.0, R - M * G / 1e6]}
    values |= {"source.initial_velocity": [0.5, 0.0, 0.0], "source.initial_angular_velocity": [0.0, 5.0, 0.0]}
    fmu = run(opened("SpherePlane"), values, 0.1, 1, 1e-10)
    assert fmu["solver.fallbacks"] == 0
    fmu["source.external_force"] = [2.0, 0.0, 0.0]
    fmu.step(0.1)
    between = fmu["solver.fallbacks"]
    assert between > 0
    fmu["source.external_force"] = [0.0, 0.0, 0.0]
    fmu.step(0.1)
    assert fmu["solver.fallbacks"] == between
    # rolling, up to the creep of 2 v_0/7 F / (mu m g): 5/7 of the push's acceleration
    check_close("speed", fmu["source.velocity"][0], 0.5 + 5 / 7 * 2.0 / M * 0.1, 1e-9)
    parts = ("kinetic", "rotational", "potential", "contact", "dissipated", "friction")
    whole = sum(fmu[f"energy.{part}"] for part in parts) - fmu["energy.external_work"]
    check_close("energy", fmu["energy.total"], whole, 1e-12)
