"""Lasting contact at the rim of a capped cylinder: as exact, in as few steps, at any stiffness"""

from math import cos, pi, sin, sqrt

import pytest

from support.checks import check_close, check_relative, run, start
from support.reference.rim_motion import RimMotion
from support.reference.rim_motion import run as reference

R_S, R_D, LENGTH, LOAD = 0.1, 0.5, 1.0, 30.0
TILT, TILT_RATE, AZIMUTH_RATE = pi / 4, 0.3, 0.9
END = 0.1


def scene(stiffness, damping=0.0, hertz=False, part=1.0):
    """A load presses a ball on the rim along its normal, `part` of the depth at rest deep. The ball moves
    along the rim and across it. The damping is a part of the critical one."""
    depth = part * (LOAD / stiffness) ** (2 / 3 if hertz else 1)
    gravity = (-LOAD * cos(TILT), 0.0, -LOAD * sin(TILT))
    motion = RimMotion(R_S, R_D, LENGTH / 2, gravity, stiffness, 0.0, hertz)
    factor = 2 * damping * sqrt(motion.slope(-depth))
    if hertz:
        factor /= stiffness * depth**1.5
    return motion._replace(damping=factor), [-depth, 0.0, TILT, TILT_RATE, 0.0, AZIMUTH_RATE]


def values_of(motion, begin):
    state, hertz = motion.state(*begin), motion.hertz
    values = {"source.radius": motion.radius, "source.mass": motion.mass, "source.center": list(state[:3])}
    values |= {"source.initial_velocity": list(state[3:]), "destination.radius": motion.other_radius}
    values |= {"destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": True}
    values |= {"destination.length": 2 * motion.half_length, "destination.ends": "capped"}
    values |= {"gravity": list(motion.gravity), "contact.law": "hertz" if hertz else "linear"}
    values |= {"contact.method": "penalty_dynamic" if motion.damping > 0 else "penalty"}
    values |= {"contact.hertz_stiffness" if hertz else "contact.penalty_factor": motion.stiffness}
    values |= {"contact.hunt_crossley_factor" if hertz else "contact.viscous_penalty_factor": motion.damping}
    values |= {"contact.dashpot": "unclamped", "solver.max_internal_steps": 20_000}
    return values


def check(fmu, motion, begin, most, method="Radau", end=END):
    """Checks motion, force and balance of energy, and that there are at most `most` internal steps."""
    expected = reference(motion, begin, end, method)
    right, values = motion.state(*expected), values_of(motion, begin)
    total = start(fmu, values, 1e-10, "event_driven")["energy.total"]
    for steps in (1, 3):
        run(fmu, values, end, steps, 1e-10)
        check_close("position", fmu["source.position"], right[:3], 1e-10)
        check_close("velocity", fmu["source.velocity"], right[3:], 1e-9)
        check_relative("force", fmu["contact.normal_force"], motion.force(*expected[:2]), 1e-7)
        check_close("energy", fmu["energy.total"], total, 1e-10)
        assert fmu["contact.zone"] == "rim" and fmu["contact.onsets"] == 1
        assert fmu["solver.steps"] <= most


@pytest.mark.parametrize("part", [1.0, 0.4])
@pytest.mark.parametrize("damping", [3.0, 30.0, 1e3, 1e6])
def test_far_beyond_critical_damping(opened, damping, part):
    motion, begin = scene(1e7, damping, part=part)
    check(opened("SphereCylinder"), motion, begin, 40)


@pytest.mark.parametrize("stiffness", [1e8, 1e10, 1e12, 1e14])
def test_stiffness_costs_nothing(opened, stiffness):
    """The softest contact begins with series of two radians each, then takes three steps."""
    motion, begin = scene(stiffness, 0.1)
    check(opened("SphereCylinder"), motion, begin, 10)


def test_an_undamped_oscillation_keeps_its_phase(opened):
    """The reference follows some hundred swings one by one."""
    motion, begin = scene(1e9, part=0.9)
    check(opened("SphereCylinder"), motion, begin, 8, method="DOP853", end=0.02)


@pytest.mark.parametrize("part", [1.0, 0.4])
@pytest.mark.parametrize("damping", [1.0, 30.0, 1e3, 1e6])
def test_damped_under_hertz(opened, damping, part):
    motion, begin = scene(1e9, damping, hertz=True, part=part)
    check(opened("SphereCylinder"), motion, begin, 60)


@pytest.mark.parametrize("stiffness", [1e10, 1e13, 1e16])
def test_stiffness_costs_nothing_under_hertz(opened, stiffness):
    """The dying oscillation costs steps: some twenty swings at a fifth of critical damping."""
    motion, begin = scene(stiffness, 0.2, hertz=True)
    check(opened("SphereCylinder"), motion, begin, 100)


@pytest.mark.parametrize(
    "hertz, stiffness, damping", [(False, 1e6, 1e5), (False, 1e6, 1e9), (True, 1e6, 1e5), (True, 1e6, 1e7)]
)
def test_an_impact_that_hardly_ends(opened, hertz, stiffness, damping):
    """Restitution zero does so with a dashpot that acts on approach only: then the contact creeps."""
    motion, begin = scene(stiffness, hertz=hertz)
    begin[:2] = [-1e-7, -0.24]
    check(opened("SphereCylinder"), motion._replace(damping=damping), begin, 100)
