"""Capped cylinders: event_driven against an independent integration over side, cap and rim, starts on the
edge and within the solid. Approaches over the edge and edge-on impacts are the atlas's."""

import random
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from support.checks import check_close, run, start
from support.reference.hertz import FULL, factors, follow, pair_of, precise
from support.scenes.agreement import seeds
from support.scenes.random_scenes import moved_by

R_S, R_D, LENGTH = 0.1, 0.5, 1.0
FMU = "SphereCylinder"


def capped(position, velocity=(0.0, 0.0, 0.0), **more):
    """A slightly damped ball is at an upright cylinder. Names in `more` have _ in place of the first dot."""
    values = {"source.radius": R_S, "source.center": list(position)}
    values |= {"source.initial_velocity": list(velocity), "destination.radius": R_D}
    values |= {"destination.finite_length": True, "destination.length": LENGTH, "destination.ends": "capped"}
    values |= {"destination.axis": [0.0, 0.0, 1.0], "gravity": [0.0, 0.0, 0.0], "contact.penalty_factor": 1e5}
    values |= {"contact.viscous_penalty_factor": 20.0, "solver.absolute_tolerance": 1e-13}
    return values | {name.replace("_", ".", 1): value for name, value in more.items()}


def vector(choose):
    return np.array([choose.gauss(0, 1) for _ in range(3)])


def linear_or_hertz(hertz, stiffness, damping):
    if hertz:
        law = {"contact.law": "hertz", "contact.hertz_stiffness": stiffness}
        return law | {"contact.hunt_crossley_factor": damping}
    return {"contact.penalty_factor": stiffness, "contact.viscous_penalty_factor": damping}


def random_law(choose, mass):
    """Returns the linear or Hertz's law, from no damping to twice the critical one of the reduced mass."""
    law = {"contact.dashpot": choose.choice(["non_adhesive", "unclamped", "approach_only"])}
    if choose.random() < 0.3:
        return law | linear_or_hertz(True, 10 ** choose.uniform(5, 8), choose.choice([0, 0.1, 1.0]))
    stiffness = 10 ** choose.uniform(4, 6.5)
    critical = 2 * np.sqrt(stiffness * mass)
    return law | linear_or_hertz(False, stiffness, critical * choose.choice([0, 0.1, 0.5, 2.0]))


def scene(seed):
    """A ball starts near the rim, at it or a little within, and moves any way. Also returns the end."""
    choose = random.Random(seed)
    axis, outward = vector(choose), vector(choose)
    axis /= np.linalg.norm(axis)
    outward -= (outward @ axis) * axis
    outward /= np.linalg.norm(outward)
    masses = [10 ** choose.uniform(-1, 1) for _ in range(2)]
    free = choose.random() < 0.3
    radius, other = choose.choice([0.02, 0.1, 0.3]), choose.uniform(0.2, 0.6)
    length = choose.uniform(0.3, 1.2)
    angle = choose.uniform(-0.3, 1.87)  # from the side's normal to the cap's and beyond
    n = np.cos(angle) * outward + np.sin(angle) * axis
    over = other * choose.choice([0.0, 10 ** choose.uniform(-12, -1), choose.uniform(-0.2, 0.2)])
    gap = choose.choice([choose.uniform(0, 0.1), 0.0, choose.uniform(0, 2e-3)])
    rim = (other - over) * outward + (length / 2 - choose.choice([0, over])) * axis
    velocity = -choose.uniform(0.2, 2) * n + 0.7 * vector(choose)
    values = capped(rim + (radius + gap) * n, velocity) | {"source.radius": radius, "source.mass": masses[0]}
    values |= {"destination.radius": other, "destination.mass": masses[1]}
    values |= {"destination.motion": "free" if free else "fixed", "destination.length": length}
    values |= {"destination.axis": list(axis)}
    values |= {"gravity": list(choose.choice([np.zeros(3), -9.81 * n, 5 * vector(choose)]))}
    mass = masses[0] * masses[1] / sum(masses) if free else masses[0]
    return values | random_law(choose, mass), choose.uniform(0.02, 0.2)


def state(fmu):
    rows = [f"{body}.{row}" for row in ("position", "velocity") for body in ("source", "destination")]
    return np.concatenate([fmu[row] for row in rows])


def check_scene(fmu, what, values, end, allowed=1e-8):
    expected, events = follow(FMU, values, end)
    before = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    run(fmu, values, end, 3, 1e-10)
    check_close(what, state(fmu), expected[:12], allowed)
    scale = abs(before) + fmu["energy.kinetic"] + fmu["energy.dissipated"] + 1.0
    check_close(f"energy of {what}", fmu["energy.total"], before, 1e-10 * scale)
    assert fmu["contact.onsets"] <= sum(branch == FULL for _, branch in events) + 1
    assert fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("seed", seeds(20))
def test_random_scenes_end_where_the_reference_does(opened, seed):
    check_scene(opened(FMU), f"scene {seed}", *scene(seed))


@pytest.mark.parametrize("along", [(0.0, 1.0), (0.5, 0.0), (-0.5, 0.0), (0.01, 0.3)])
@pytest.mark.parametrize("hertz, stiffness, damping", [(True, 1e6, 0), (True, 1e6, 0.1), (False, 1e5, 20)])
@pytest.mark.parametrize("over", [0.0, 1e-12, -1e-12])
def test_from_the_edge_of_the_cap_it_goes_along_or_across(opened, over, hertz, stiffness, damping, along):
    values = capped((R_D * (1 + over), 0.0, 0.5 * LENGTH + R_S), (*along, -1.0))
    fmu = opened(FMU)
    check_scene(fmu, "edge", values | linear_or_hertz(hertz, stiffness, damping), 0.02, 1e-10)
    assert fmu["contact.onsets"] == 1


def test_a_ball_rests_balanced_on_the_rim(opened):
    """Gravity acts along the rim's normal, and the depth balances it: nothing moves."""
    n = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    position = np.array([R_D, 0.0, 0.5 * LENGTH]) + (R_S - 9.81 / 1e5) * n
    fmu = opened(FMU)
    run(fmu, capped(position, gravity=(-9.81 * n).tolist()), 0.02, 2, 1e-10)
    check_close("position", fmu["source.position"], position, 1e-13)
    assert fmu["contact.zone"] == "rim"
    check_close("force", fmu["contact.normal_force"], 9.81, 1e-9)


@pytest.mark.parametrize("place", [(0.47, 0.0, 0.42), (0.45, 0.0, 0.48), (0.1, 0.2, 0.3), (0, 0.48, -0.499)])
def test_starts_within_the_solid_leave_by_the_nearest_face(opened, place):
    values = capped(place, contact_penalty_factor=1e3, contact_viscous_penalty_factor=0.0)
    fmu = opened(FMU)
    check_scene(fmu, f"inside {place}", values, 0.05)
    assert fmu["contact.within_extents"]


@pytest.mark.parametrize("hertz", [False, True])
def test_a_ball_shot_through_the_circle_of_the_rim_goes_on(opened, hertz, dashpot):
    """All zones meet at the circle. The ball goes on over the cap, as one beside it does."""
    begin = np.array([R_D + 0.03, 0.0, 0.5 * LENGTH])
    law = linear_or_hertz(hertz, 2e5 if hertz else 4.3e4, 0.01 if hertz else 5.0)
    values = capped(begin, (-7.7, 0.0, 0.0), source_radius=0.02, contact_dashpot=dashpot) | law
    beside, _ = follow(FMU, values | {"source.center": begin - [0.0, 0.0, 1e-9]}, 0.02)
    fmu = opened(FMU)
    before = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    for steps in (1, 3):
        run(fmu, values, 0.02, steps, 1e-10)
        check_close("state", state(fmu), beside[:12], 1e-6)
        check_close("energy", fmu["energy.total"], before, 1e-10 * before)
        assert fmu["solver.steps"] < 200


def test_a_ball_goes_over_the_rim_without_a_jump(opened):
    """A ball that gravity holds to the rim passes from side over rim to cap in one contact."""
    gravity = [-30.0 * np.sqrt(0.5), 0.0, -30.0 * np.sqrt(0.5)]
    values = capped((R_D + 0.3 - 2e-4, 0.0, 0.5 * LENGTH - 0.02), (0.0, 0.0, 2.58), source_radius=0.3)
    values |= {"gravity": gravity, "contact.viscous_penalty_factor": 500.0}
    expected, _ = follow(FMU, values, 0.55)
    fmu = opened(FMU)
    for steps in (1, 997):
        seen = {"force": [], "zone": []}

        def note(fmu, seen=seen):
            seen["force"].append(fmu["contact.normal_force"])
            seen["zone"].append(fmu["contact.zone"])

        run(fmu, values, 0.55, steps, 1e-10, each=note)
        check_close(f"{steps} steps", state(fmu), expected[:12], 1e-9)
    assert list(dict.fromkeys(seen["zone"])) == ["side", "rim", "cap"]
    assert fmu["contact.onsets"] == 1
    assert np.max(np.abs(np.diff(seen["force"]))) < 0.3 * np.max(seen["force"])


def test_given_motion_over_the_rim(opened):
    """The importer leads the ball along a line that cuts all three zones: impulse and work by quadrature."""
    begin, rate = np.array([0.59, 0.0, 0.42]), np.array([-0.5, 0.0, 0.7])
    values = capped(begin, contact_viscous_penalty_factor=30.0, contact_dashpot="unclamped")
    pair = precise(pair_of(FMU, values, *factors(values))[0])
    values |= moved_by("source", rate)

    def force(t):
        depth, speed, n = gap(t)
        return -(pair.force(depth, speed, FULL) if depth < 0 else 0.0) * n

    def gap(t):
        return pair.gap_and_rate(np.concatenate([begin + t * rate, np.zeros(3), rate, np.zeros(3)]))

    edges = [0.08 / 0.7, 0.09 / 0.5]  # beyond the cap's plane, within the side's
    between = pairwise(np.linspace(0.0, 0.4, 4001))
    kinks = [brentq(lambda t: float(gap(t)[0]), a, b) for a, b in between if gap(a)[0] * gap(b)[0] < 0]
    assert gap(0.0)[0] < 0.0 and edges[0] < edges[1] < min(kinks)  # it touches from side over rim to cap
    expected = [
        quad(
            lambda t, i=i: force(t)[i], 0.0, 0.4, points=edges + kinks, epsabs=1e-13, epsrel=1e-13, limit=200
        )[0]
        for i in range(3)
    ]
    fmu = opened(FMU)
    run(fmu, values, 0.4, 1, 1e-12)
    check_close("impulse", 0.4 * fmu["contact.mean_force"], expected, 1e-9)


def test_automatic_location_is_outside(opened):
    fmu = opened(FMU)
    start(fmu, capped((0.0, 0.0, 0.5 * LENGTH + R_S + 0.2)))
    check_close("gap above the cap", fmu["contact.gap"], 0.2, 1e-15)
    assert fmu["contact.zone"] == "none"
