"""Capped cylinders: event_driven against an independent integration over side, cap and rim, approaches to the
rim over the edge, edge-on impacts, starts within the solid.
"""

import os
import random
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from support.checks import check_close, run, start
from support.reference.capped import CappedPair
from support.reference.capped import run as reference

COUNT = int(os.environ.get("CONTACT_SCENES", "20"))
R_S, R_D, LENGTH = 0.1, 0.5, 1.0


def values_of(pair, position, velocity, free_destination=False):
    law = (
        {"contact.hertz_stiffness": pair.stiffness, "contact.hunt_crossley_factor": pair.damping}
        if pair.hertz
        else {"contact.penalty_factor": pair.stiffness, "contact.viscous_penalty_factor": pair.damping}
    )
    return law | {
        "source.radius": pair.radius,
        "destination.radius": pair.other_radius,
        "destination.finite_length": True,
        "destination.length": pair.length,
        "destination.ends": "capped",
        "destination.axis": list(pair.axis),
        "source.center": list(position),
        "source.initial_velocity": list(velocity),
        "source.mass": pair.masses[0],
        "destination.mass": pair.masses[1] if free_destination else 1.0,
        "destination.motion": "free" if free_destination else "fixed",
        "gravity": list(pair.gravity),
        "contact.law": "hertz" if pair.hertz else "linear",
        "contact.dashpot": pair.dashpot,
        "solver.absolute_tolerance": 1e-13,
    }


def vector(choose):
    return np.array([choose.gauss(0, 1) for _ in range(3)])


def random_pair(choose, axis, free):
    masses = (10 ** choose.uniform(-1, 1), 10 ** choose.uniform(-1, 1) if free else np.inf)
    hertz = choose.random() < 0.3
    stiffness = 10 ** (choose.uniform(5, 8) if hertz else choose.uniform(4, 6.5))
    reduced = 1 / sum(1 / mass for mass in masses)
    zeta = choose.choice([0, 0.1, 0.5, 2.0])
    return CappedPair(
        radius=choose.choice([0.02, 0.1, 0.3]),
        other_radius=choose.uniform(0.2, 0.6),
        length=choose.uniform(0.3, 1.2),
        axis=tuple(axis),
        masses=masses,
        gravity=(0.0, 0.0, 0.0),
        hertz=hertz,
        stiffness=stiffness,
        damping=choose.choice([0, 0.1, 1.0]) if hertz else 2 * zeta * np.sqrt(stiffness * reduced),
        dashpot=choose.choice(["non_adhesive", "unclamped", "approach_only"]),
    )


def scene(seed):
    """A ball near the rim, at it or a little within, that goes any way; and the end."""
    choose = random.Random(seed)
    axis, outward = vector(choose), vector(choose)
    axis /= np.linalg.norm(axis)
    outward -= (outward @ axis) * axis
    outward /= np.linalg.norm(outward)
    free = choose.random() < 0.3
    pair = random_pair(choose, axis, free)
    angle = choose.uniform(-0.3, 1.87)  # from the side's normal to the cap's and beyond
    n = np.cos(angle) * outward + np.sin(angle) * axis
    over = pair.other_radius * choose.choice([0.0, 10 ** choose.uniform(-12, -1), choose.uniform(-0.2, 0.2)])
    gap = choose.choice([choose.uniform(0, 0.1), 0.0, choose.uniform(0, 2e-3)])
    rim = (pair.other_radius - over) * outward + (pair.length / 2 - choose.choice([0, over])) * axis
    pair = pair._replace(gravity=tuple(choose.choice([np.zeros(3), -9.81 * n, 5 * vector(choose)])))
    velocity = -choose.uniform(0.2, 2) * n + 0.7 * vector(choose)
    return pair, rim + (pair.radius + gap) * n, velocity, free, choose.uniform(0.02, 0.2)


def state(fmu):
    rows = [f"{body}.{row}" for row in ("position", "velocity") for body in ("source", "destination")]
    return np.concatenate([fmu[row] for row in rows])


def check_scene(fmu, what, pair, position, velocity, free, end, allowed=1e-8):
    expected = reference(pair, np.concatenate([position, np.zeros(3), velocity, np.zeros(3)]), end)
    values = values_of(pair, position, velocity, free)
    before = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    run(fmu, values, end, 3, 1e-10)
    check_close(what, state(fmu), expected.state, allowed)
    scale = abs(before) + fmu["energy.kinetic"] + fmu["energy.dissipated"] + 1.0
    check_close(f"energy of {what}", fmu["energy.total"], before, 1e-10 * scale)
    touches = sum(branch == "full" for _, branch in expected.changes)
    assert fmu["contact.onsets"] <= touches + 1
    assert fmu["solver.fallbacks"] == 0
    return expected


@pytest.mark.parametrize("seed", range(COUNT))
def test_random_scenes_end_where_the_reference_does(opened, seed):
    check_scene(opened("SphereCylinder"), f"scene {seed}", *scene(seed))


def upright(**changed):
    fixed = {
        "radius": R_S,
        "other_radius": R_D,
        "length": LENGTH,
        "axis": (0.0, 0.0, 1.0),
        "masses": (1.0, np.inf),
        "gravity": (0.0, 0.0, -9.81),
        "stiffness": 1e5,
        "damping": 20.0,
    }
    return CappedPair(**(fixed | changed))


@pytest.mark.parametrize("along", [(0.0, 1.0), (0.5, 0.0), (-0.5, 0.0), (0.01, 0.3)])
@pytest.mark.parametrize("hertz, stiffness, damping", [(True, 1e6, 0), (True, 1e6, 0.1), (False, 1e5, 20)])
@pytest.mark.parametrize("over", [0.0, 1e-12, -1e-12])
def test_from_the_edge_of_the_cap_it_goes_along_or_across(opened, over, hertz, stiffness, damping, along):
    pair = upright(gravity=(0.0, 0.0, 0.0), hertz=hertz, stiffness=stiffness, damping=damping)
    position, velocity = np.array([R_D * (1 + over), 0.0, 0.5 * LENGTH + R_S]), np.array([*along, -1.0])
    fmu = opened("SphereCylinder")
    check_scene(fmu, "edge", pair, position, velocity, False, 0.02, 1e-10)
    assert fmu["contact.onsets"] == 1


def test_a_ball_rests_balanced_on_the_rim(opened):
    """Gravity along the rim's normal, the ball at the depth where the force holds it: nothing moves."""
    n = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    pair = upright(gravity=tuple(-9.81 * n))
    position = np.array([R_D, 0.0, 0.5 * LENGTH]) + (R_S - 9.81 / 1e5) * n
    fmu = opened("SphereCylinder")
    run(fmu, values_of(pair, position, np.zeros(3)), 0.02, 2, 1e-10)
    check_close("position", fmu["source.position"], position, 1e-13)
    assert fmu["contact.zone"] == "rim"
    check_close("force", fmu["contact.normal_force"], 9.81, 1e-9)


@pytest.mark.parametrize(
    "place", [(0.47, 0.0, 0.42), (0.45, 0.0, 0.48), (0.1, 0.2, 0.3), (0.0, 0.48, -0.499)]
)
def test_starts_within_the_solid_leave_by_the_nearest_face(opened, place):
    pair = upright(stiffness=1e3, damping=0.0, gravity=(0.0, 0.0, 0.0))
    position = np.array(place)
    check_scene(opened("SphereCylinder"), f"inside {place}", pair, position, np.zeros(3), False, 0.05)
    assert opened("SphereCylinder")["contact.within_extents"]


@pytest.mark.parametrize("dashpot", ["non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("hertz", [False, True])
def test_a_ball_shot_through_the_circle_of_the_rim_goes_on(opened, hertz, dashpot):
    """At the circle itself all zones meet. It goes on over the cap, as one beside it does."""
    pair = upright(
        gravity=(0.0, 0.0, 0.0), radius=0.02, hertz=hertz, dashpot=dashpot,
        stiffness=2e5 if hertz else 4.3e4, damping=0.01 if hertz else 5.0,
    )  # fmt: skip
    velocity = np.array([-7.7, 0.0, 0.0])
    begin = np.array([R_D + 0.03, 0.0, 0.5 * LENGTH])
    fmu = opened("SphereCylinder")
    beside = np.concatenate([begin - [0.0, 0.0, 1e-9], np.zeros(3), velocity, np.zeros(3)])
    before = start(fmu, values_of(pair, begin, velocity), 1e-10, "event_driven")["energy.total"]
    for steps in (1, 3):
        run(fmu, values_of(pair, begin, velocity), 0.02, steps, 1e-10)
        check_close("state", state(fmu), reference(pair, beside, 0.02).state, 1e-6)
        check_close("energy", fmu["energy.total"], before, 1e-10 * before)
        assert fmu["solver.steps"] < 200


def test_a_ball_goes_over_the_rim_without_a_jump(opened):
    """A ball that gravity holds to the rim passes from side over rim to cap in one contact."""
    n = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    pair = upright(gravity=tuple(-30.0 * n), stiffness=1e5, damping=500.0, radius=0.3)
    position = np.array([R_D + 0.3 - 2e-4, 0.0, 0.5 * LENGTH - 0.02])
    velocity = [0.0, 0.0, 2.58]
    fmu = opened("SphereCylinder")
    values = values_of(pair, position, velocity)
    expected = reference(pair, np.concatenate([position, np.zeros(3), velocity, np.zeros(3)]), 0.55)
    for steps in (1, 997):
        seen = {"force": [], "zone": []}

        def note(fmu, seen=seen):
            seen["force"].append(fmu["contact.normal_force"])
            seen["zone"].append(fmu["contact.zone"])

        run(fmu, values, 0.55, steps, 1e-10, each=note)
        check_close(f"{steps} steps", state(fmu), expected.state, 1e-9)
    assert list(dict.fromkeys(seen["zone"])) == ["side", "rim", "cap"]
    assert [zone for _, zone in expected.zones] == ["side", "rim", "cap"]
    assert fmu["contact.onsets"] == 1
    assert np.max(np.abs(np.diff(seen["force"]))) < 0.3 * np.max(seen["force"])


def test_given_motion_over_the_rim(opened):
    """The importer leads the ball along a line that cuts all three zones: impulse and work by quadrature."""
    pair = upright(damping=30.0, dashpot="unclamped")
    begin, rate = np.array([0.59, 0.0, 0.42]), np.array([-0.5, 0.0, 0.7])
    values = values_of(pair, begin, np.zeros(3)) | {
        "source.motion": "prescribed",
        "source.prescribed_velocity": list(rate),
        "source.prescribed_displacement.derivatives": [list(rate), [0.0, 0.0, 0.0]],
    }

    def force(t):
        y = np.concatenate([begin + t * rate, np.zeros(3), rate, np.zeros(3)])
        gap, speed, n = pair.gap_and_rate(y)
        return (pair.force(gap, speed, "full") if gap < 0 else 0.0) * n

    def place(t):
        return np.concatenate([begin + t * rate, np.zeros(9)])

    def gap(t):
        return pair.gap_and_rate(place(t))[0]

    places = np.linspace(0.0, 0.4, 4001)
    assert {pair.zone(place(t)) for t in places} == {"side", "rim", "cap"}
    edges = [0.08 / 0.7, 0.09 / 0.5]  # beyond the cap's plane, within the side's
    between = pairwise(places)
    kinks = [brentq(gap, a, b) for a, b in between if gap(a) * gap(b) < 0]
    expected = [
        quad(
            lambda t, i=i: force(t)[i], 0.0, 0.4, points=edges + kinks, epsabs=1e-13, epsrel=1e-13, limit=200
        )[0]
        for i in range(3)
    ]
    fmu = opened("SphereCylinder")
    run(fmu, values, 0.4, 1, 1e-12)
    check_close("impulse", 0.4 * fmu["contact.mean_force"], expected, 1e-9)


def test_automatic_location_is_outside(opened):
    fmu = opened("SphereCylinder")
    start(fmu, values_of(upright(), [0.0, 0.0, 0.5 * LENGTH + R_S + 0.2], np.zeros(3)))
    check_close("gap above the cap", fmu["contact.gap"], 0.2, 1e-15)
    assert fmu["contact.zone"] == "none"
