"""Rest stays rest: steps of 1 ms leave a ball where it lay, to a nanometre, and give it no energy; for an
hour of simulated time where nothing damps it. Steps may be huge."""

import ctypes
import math

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import check_close, run, start

METHOD = "event_driven"
STEP = 1e-3  # s
HOUR, MINUTES = 3600, 120  # s
STILL = 1e-9  # m
GAINED = 1e-12  # J
TILTED = np.array([2.0, -1.0, -2.0]) / 3.0  # where gravity pulls to, along no axis of the world
AXIS = np.array([1.0, 2.0, 0.0]) / math.sqrt(5.0)  # across it
WEIGHT = 9.81
BALL = {"source.radius": 0.1, "source.mass": 1.0, "destination.radius": 0.5}
DAMPED = {"contact.viscous_penalty_factor": 200.0}
UNDAMPED = {"contact.method": "penalty"}


def on_top(stiffness=1e6, **more):
    """A ball lies on a ball, as deep as its weight presses: only from there rounding cannot roll it off."""
    depth = WEIGHT / stiffness
    values = {**BALL, "contact.penalty_factor": stiffness, "source.center": [0.0, 0.0, 0.6]}
    values |= {"source.initial_displacement": [0.0, 0.0, -depth], **more}
    return values


def at_the_bottom(stiffness=1e6, depth=None, **more):
    """A ball lies in a hollow body."""
    depth = WEIGHT / stiffness if depth is None else depth
    return {
        **BALL, "contact.location": "inside", "contact.penalty_factor": stiffness,
        "source.center": (0.4 * TILTED).tolist(),
        "source.initial_displacement": (depth * TILTED).tolist(),
        "gravity": (WEIGHT * TILTED).tolist(),
        **more,
    }  # fmt: skip


def pressed_together(**more):
    """Two free balls are pushed towards each other."""
    force = 5.0
    values = {**on_top(**more), "source.initial_displacement": [0.0, 0.0, -force / 1e6]}
    values |= {"destination.motion": "free", "destination.mass": 2.0}
    values |= {"source.external_force": [0.0, 0.0, -force], "destination.external_force": [0.0, 0.0, force]}
    values |= {"gravity": [0.0, 0.0, 0.0]}
    return values


STATES = {
    "on a ball": ("SphereSphere", on_top(**DAMPED), MINUTES),
    "in a hollow cylinder, undamped": ("SphereCylinder",
        at_the_bottom(**UNDAMPED, **{"destination.axis": AXIS.tolist()}), HOUR),
    "on a ball, undamped": ("SphereSphere", on_top(**UNDAMPED), MINUTES),
    "in a hollow ball": ("SphereSphere", at_the_bottom(**DAMPED), MINUTES),
    "in a hollow ball, undamped": ("SphereSphere", at_the_bottom(**UNDAMPED), MINUTES),
    "in a hollow ball, dashpot of approach": ("SphereSphere",
        at_the_bottom(**DAMPED, **{"contact.dashpot": "approach_only"}), MINUTES),
    "in a hollow ball, overdamped": ("SphereSphere", at_the_bottom(**{"contact.viscous_penalty_factor": 5e3}),
        MINUTES),
    "two balls pressed together": ("SphereSphere", pressed_together(**DAMPED), MINUTES),
    "stiff": ("SphereSphere", at_the_bottom(1e10, **{"contact.viscous_penalty_factor": 2e4}), MINUTES // 10),
}  # fmt: skip


def stepper(fmu):
    """Calls fmi2DoStep without fmpy's wrapping, which would take longer than the step."""
    do_step = fmu.slave.dll.fmi2DoStep
    do_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int]
    do_step.restype = ctypes.c_int
    component = fmu.slave.component

    def run_steps(first, count):
        for k in range(first, first + count):
            if do_step(component, k * STEP, STEP, 0):
                raise AssertionError(f"fmi2DoStep at {k * STEP} s: {fmu.messages[-1:]}")
        fmu.time = (first + count) * STEP

    return run_steps


@pytest.mark.parametrize("state", STATES)
def test_a_ball_at_rest_neither_drifts_nor_gains_energy(opened, state):
    name, values, duration = STATES[state]
    fmu = run(opened(name), values, STEP, 1, None, METHOD)
    place, onsets, events = fmu["source.position"], fmu["contact.onsets"], fmu["solver.events"]
    energy = fmu["energy.total"] - fmu["energy.dissipated"]
    total = fmu["energy.total"]
    assert onsets == 1
    run_steps, parts = stepper(fmu), 12
    count = round(duration / STEP / parts)
    for part in range(parts):
        run_steps(1 + part * count, count)
        check_close(f"position at {fmu.time} s", fmu["source.position"], place, STILL)
        check_close("energy.total", fmu["energy.total"], total, GAINED)
        assert fmu["energy.total"] - fmu["energy.dissipated"] <= energy + GAINED
        assert fmu["energy.kinetic"] <= GAINED
        assert fmu["contact.active"] is True
    assert fmu["contact.onsets"] == onsets
    assert fmu["solver.events"] <= events + 1  # the dashpot of approach may find that there is none any more
    check_close("last_duration", fmu["contact.last_duration"], fmu.time, 1e-9)
    check_close("time", fmu.time, duration + STEP, STEP / 2)


def test_a_step_beyond_the_range_of_numbers_is_refused_and_nothing_is_lost(opened, method):
    fmu = opened("SphereSphere")
    fmu.start({"solver.method": method, "source.center": [3, 0, 1.1]})  # falls past the other ball
    fmu.step(0.1)
    for size in (1e160, 1e300):
        with pytest.raises(FmuError, match="beyond the range of numbers"):
            fmu.step(size)
    check_close("time", fmu.time, 0.1, 0.0)
    fmu.step(0.1)
    check_close("position", fmu["source.position"][2], 1.1 - 9.81 * 0.2**2 / 2, 1e-15)
    assert math.isfinite(fmu["energy.total"])


@pytest.mark.parametrize("step", [1e2, 1e17, 1e40, 1e80, 1e120, 1e300])
@pytest.mark.parametrize("motion", ["free", "prescribed"])
def test_a_contact_is_met_however_long_the_step(opened, method, motion, step):
    """A ball moves on a line at 0.3 m from the centre of another one. Their radii add up to 0.6 m."""
    velocity = [1.0, 0.0, 0.0]
    values = {"source.motion": motion, "destination.motion": "fixed", "source.center": [-2.0, 0.3, 0.0]}
    values |= {"contact.location": "outside", "contact.penalty_factor": 1e5, "gravity": [0.0, 0.0, 0.0]}
    if motion == "free":
        values["source.initial_velocity"] = velocity
    else:
        values |= {
            "source.prescribed_velocity": velocity,
            "source.prescribed_displacement.derivatives": [velocity],
        }
    fmu = run(opened("SphereSphere"), values, step, 1, 1e-9, method)
    assert fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], 2.0 - math.sqrt(0.6**2 - 0.3**2), 1e-14)
    assert fmu["contact.last_duration"] > 1e-3
    assert fmu["source.position"][1] > 0.299


@pytest.mark.parametrize("friction", ["regularized", "elastic"])
def test_a_ball_at_rest_takes_few_steps_however_long(opened, friction):
    """The general segment takes them. Rounding of the weight, left to itself for so long, moves it 0.1 km."""
    values = {"source.rotation": "free", "contact.friction": friction, "contact.location": "inside"}
    fmu = start(opened("SphereSphere"), values | {"source.center": [0.0, 0.0, -0.4]}, 1e-9)
    for size in (1e3, 1e5, 1e7):
        fmu.step(size)
    assert fmu["solver.steps"] < 500 and fmu["solver.fallbacks"] > 0
    check_close("gap", fmu["contact.gap"], -9.81e-6, 1e-12)
