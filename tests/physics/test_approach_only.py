"""Lasting contact with a dashpot that acts on approach only, under a load that sways: as many events as the
true motion has, few steps, and the right place."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contact_fmus.stability.motions import GEOMETRIES, PLANE, HeadOn
from support.checks import FMU, check_close, run, start
from support.reference.stiff_motion import StiffContact
from support.scenes.agreement import seeds

TOLERANCES = [1e-6, 1e-8, 1e-10]


def sliding(shape, inside, stiffness, ratio, mass, angle, speed):
    """The ball is set down at the balance of load and spring, with a speed across the slope and an end."""
    reach, height = (0.4, -1.0) if inside else (0.6, 1.0)
    turn = speed / reach if shape == "sphere" else 0.0
    load = mass * (9.81 * math.cos(angle) + (reach * turn**2 if inside else -reach * turn**2))
    d = reach + load / stiffness * (1.0 if inside else -1.0)
    values = {"contact.location": "inside" if inside else "outside", "contact.method": "penalty_dynamic"}
    values |= {"contact.dashpot": "approach_only", "contact.penalty_factor": stiffness}
    values |= {"contact.viscous_penalty_factor": 2.0 * ratio * math.sqrt(stiffness * mass)}
    values |= {"source.mass": mass, "source.center": [d * math.sin(angle), 0.0, d * height * math.cos(angle)]}
    values |= {"source.initial_velocity": [0.0, speed, 0.0], "gravity": [0.0, 0.0, -9.81]}
    if shape == "cylinder":
        values["destination.axis"] = [0.0, 1.0, 0.0]
    return values, 2.0 if inside else 0.3


def stiff_end(values, shape, end):
    """The dashpot moves the ball by no more than it holds it back along the normal: it ends as if
    undamped."""
    return StiffContact({**values, "contact.method": "penalty"}, shape).end(end)


@pytest.mark.parametrize("seed", seeds(12))
def test_stiffness_costs_no_events(opened, seed):
    """For each turn of the load the gap rate touches zero in a few turns of the oscillation. A heavier
    dashpot holds the ball for more turns. Their number does not grow with the stiffness."""
    draw = np.random.default_rng(seed)
    shape, inside = str(draw.choice(list(FMU))), bool(draw.random() < 0.7)
    mass, ratio = 10.0 ** draw.uniform(-1.0, 1.0), math.exp(draw.uniform(math.log(0.5), math.log(100.0)))
    stiffness = mass * 10.0 ** draw.uniform(9.3, 12.0)
    angle = draw.uniform(0.2, 1.2) if inside else draw.uniform(0.02, 0.2)
    speed = float(draw.choice([0.0, 0.1, 0.5]))
    values, end = sliding(shape, inside, stiffness, ratio, mass, angle, speed)
    right = stiff_end(values, shape, end)
    assert right.left_out < 1e-9 and right.least_push > 0.0
    for tolerance in (None, *TOLERANCES):
        fmu = run(opened(FMU[shape]), values, end, 1, tolerance, "event_driven")
        assert fmu["contact.onsets"] == 1
        assert fmu["solver.events"] <= 12 + 4 * ratio + 20 / ratio  # and until the oscillation has died away
        assert fmu["solver.steps"] <= 120 + 8 * ratio
        check_close("position", fmu["source.position"], right.position, 1e-9)
        energy = mass * (9.81 * values["source.center"][2] + 0.5 * speed**2)
        check_close("energy", fmu["energy.total"], energy, 1e-12 * mass + 50.0 * mass**2 / stiffness)


@pytest.mark.parametrize(
    "stiffness, damping, tolerance, turns",
    [(1e9, 75894.66, None, 7), (1e9, 75894.66, 1e-10, 7), (1e10, 1e6, 1e-10, 11)],
)
def test_a_load_that_sways_turns_a_few_times(opened, stiffness, damping, tolerance, turns):
    """A ball slides through a hollow sphere to and fro for two seconds. Where it is let go deeper than load
    and spring balance, it rises first, which the expansion does not know: as high as the spring throws it."""
    values, end = sliding("sphere", True, stiffness, 1.0, 1.0, math.pi / 3, 0.1)
    values["contact.viscous_penalty_factor"] = damping
    balance = math.hypot(*values["source.center"]) - 0.4
    values["source.center"] = [0.3464101658439025, 0.0, -0.2000000025]
    deeper = math.hypot(*values["source.center"]) - 0.4 - balance
    rise = stiffness * deeper**2 / (2.0 * 9.81 * math.cos(math.pi / 3))
    fmu = run(opened("SphereSphere"), values, end, 1, tolerance, "event_driven")
    assert fmu["solver.events"] <= turns
    assert fmu["solver.steps"] <= 60
    check_close("position", fmu["source.position"], stiff_end(values, "sphere", end).position, 1e-9 + rise)


@pytest.mark.parametrize("penalty", [1e8, 1e10])
@pytest.mark.parametrize("ratio", [0.01, 0.2, 1.5])
@pytest.mark.parametrize("geometry", [*GEOMETRIES, PLANE])
def test_a_ball_set_down_comes_to_rest_as_the_closed_form_says(opened, geometry, ratio, penalty):
    """The error is 1e-7 of the penetration, or the last digits of the place, at any stiffness."""
    one = HeadOn(geometry=geometry, law="approach_only", ratio=ratio, penalty=penalty, gap=0.0, speed=0.0)
    set_down = replace(one, place=-one.reach if one.inside else one.reach, end=40 * one.contact_time())
    right = set_down.expected()
    for steps in (1, 7):
        fmu = run(opened(set_down.fmu), set_down.configuration(), set_down.end, steps, 1e-9, "event_driven")
        allowed = 1e-7 * right.way + right.rounding
        check_close("place", fmu["source.displacement"][2], float(right.displacement["source"][2]), allowed)
        assert fmu["contact.onsets"] == 1


@pytest.mark.parametrize("stiffness", [1e8, 1e14])
@pytest.mark.parametrize("chi", [1.0, 20.0])
@pytest.mark.parametrize("shape", ["SpherePlane", "SphereSphere", "SphereCylinder"])
def test_a_ball_set_down_under_hertz_s_law_swings_as_dop853_says(opened, shape, chi, stiffness):
    """Depths are in units of (load / k_h)^(2/3), and speeds so that the law's number chi is `chi`."""
    load = 9.81
    depth = (load / stiffness) ** (2 / 3)
    unit = math.sqrt(depth / load)
    values = {"contact.law": "hertz", "contact.hertz_stiffness": stiffness}
    values |= {"contact.hunt_crossley_factor": chi * unit / depth, "contact.dashpot": "approach_only"}
    values |= {"source.center": [0.0, 0.0, 0.1 if shape == "SpherePlane" else 0.6]}
    values |= {"source.initial_velocity": [0.0] * 3, "gravity": [0.0, 0.0, -load]}
    if shape == "SphereCylinder":
        values["destination.axis"] = [0.0, 1.0, 0.0]
    fmu = run(opened(shape), values, 30.0 * unit, 1, 1e-9, "event_driven")
    moved = -fmu["source.displacement"][2] / depth
    check_close("depth", moved, settled_depth(chi, 30.0), 1e-7 + 2e-16 / depth)


def settled_depth(chi, end):
    """Solves y'' = 1 - y^(3/2) (1 + chi y') from rest at 0, without chi where y' < 0."""

    def turns(t, y):
        return y[1]

    turns.terminal, time, y, approaches = True, 0.0, [1e-30, 1e-30], True
    while time < end:
        turns.direction = -1.0 if approaches else 1.0
        acts = chi * approaches
        path = solve_ivp(
            lambda t, y, acts=acts: [y[1], 1.0 - max(y[0], 0.0) ** 1.5 * (1.0 + acts * y[1])],
            *((time, end), y, "DOP853"), rtol=1e-12, atol=1e-14, events=turns,
        )  # fmt: skip
        time, y, approaches = path.t[-1], [path.y[0][-1], 0.0], not approaches
    return path.y[0][-1]


@pytest.mark.parametrize("k", [0, 24, 30, 54])
def test_a_source_that_leaves_as_it_passes_the_end_of_a_turning_cylinder_meets_no_dashpot(opened, k):
    """It overlaps the side and moves away from it: only the spring acts, whatever the dashpot. In all but the
    first case rounding puts the source on the far side of the end plane at the touch."""
    fmu = opened("SphereCylinder")
    values = {"source.motion": "free", "destination.rotation": "prescribed", "contact.location": "outside"}
    values |= {"destination.finite_length": True, "destination.length": 1.0, "destination.radius": 0.3}
    values |= {"source.radius": 0.1, "source.center": [0.36, 0.01 * (k % 11) / 7, 0.55 + 0.0013 * k]}
    values |= {"source.initial_velocity": [0.6, 0.0, -1.3], "contact.penalty_factor": 1e4}
    values |= {"gravity": [0.0, 0.0, -9.81], "destination.axis": [0.0, 0.0, 1.0]}
    ends = []
    for dashpot in (0.0, 60.0):
        damped = {"contact.method": "penalty_dynamic", "contact.dashpot": "approach_only"}
        start(fmu, values | damped | {"contact.viscous_penalty_factor": dashpot}, 1e-9)
        fmu["destination.prescribed_angular_velocity"] = [0.1, 0.2 + 0.001 * k, 0.0]
        fmu.step(1.2)
        ends.append(fmu["source.velocity"])
    check_close("velocity", ends[1], ends[0], 1e-12)
    assert fmu["contact.onsets"] == 1
