"""A ball fast enough to pass through the middle of a solid, where the force turns round.

Head-on the penetration obeys m s'' + c s' + k s = 0 up to the centre and again, from that depth, behind it:
parts of an oscillator in closed form. The force jumps at the centre, where event_driven ends a segment."""

import contextlib
import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy.optimize import brentq

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import FMU, check_close, check_relative, impulse_and_peak, run, start
from support.reference.integrator import Reference
from support.scenes.head_on import ACROSS, AXIS, RADII

REACH, SPEED, START, END = 0.6, 3.0, 0.7, 0.7
LED = 1e4  # N/m, where the ball is led


def solid(shape, along, **more):
    values = {**RADII, "source.motion": "free", "destination.motion": "fixed"}
    values |= {"source.center": (-START * along).tolist()}
    values |= {"source.initial_velocity": (SPEED * along).tolist(), "destination.center": [0.0, 0.0, 0.0]}
    values |= {"gravity": [0.0, 0.0, 0.0], "contact.location": "outside"}
    values |= {"contact.penalty_control": "user_defined", "contact.viscous_control": "user_defined"}
    values |= {"contact.dashpot": "unclamped", **more}
    return values | ({"destination.axis": AXIS.tolist()} if shape == "cylinder" else {})


@pytest.mark.parametrize("steps", [1, 20])
def test_a_ball_on_the_axis_of_a_solid_cylinder_is_thrown_out_across_it(opened, steps, method):
    """It keeps its speed along the axis; the energy p_n g^2/2 of the start becomes speed across it."""
    values = solid("cylinder", AXIS, **{"contact.penalty_factor": 100.0, "source.center": [0.0, 0.0, 0.0]})
    values["contact.viscous_penalty_factor"] = 0.0
    fmu = run(opened("SphereCylinder"), values, 1.0, steps, tolerance=1e-12, method=method)
    velocity = fmu["source.velocity"]
    check_relative("along", velocity @ AXIS, SPEED, 1e-9)
    check_relative("across", np.linalg.norm(velocity - (velocity @ AXIS) * AXIS), REACH * 10.0, 1e-9)
    assert fmu["contact.active"] is False
    assert fmu["solver.fallbacks"] == 0


ASIDE = np.cross(ACROSS, AXIS) / np.linalg.norm(np.cross(ACROSS, AXIS))
NEAR_MISSES = [1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-14, 1e-15, 1e-16, 1e-17]


@pytest.mark.parametrize("friction", ["none", "regularized", "elastic"])
@pytest.mark.parametrize("steps", [1, 70])
@pytest.mark.parametrize("miss", [0.0, *NEAR_MISSES])
@pytest.mark.parametrize("stiffness", [0.01, 10.0, 24.0])
def test_a_near_miss_of_the_centre_keeps_energy(opened, shape, stiffness, miss, steps, friction):
    """The normal turns by half a turn within miss / speed. Steps shrink to this time and grow again, each by
    a factor, so that there are some log(size / miss) of them. Without friction there is angular momentum."""
    values = solid(shape, ACROSS, **{"contact.penalty_factor": stiffness, "contact.friction": friction})
    values |= {"contact.viscous_penalty_factor": 0.0, "source.initial_angular_velocity": list(5.0 * ACROSS)}
    values["source.rotation"] = "none" if friction == "none" else "free"
    values["source.center"] = (-START * ACROSS + miss * ASIDE).tolist()
    right = start(opened(FMU[shape]), values)["energy.total"]
    fmu = run(opened(FMU[shape]), values, END, steps, tolerance=1e-9, method="event_driven")
    check_relative("energy", fmu["energy.total"], right, 1e-13 if friction == "none" else 1e-9)
    check_close("onsets", fmu["contact.onsets"], 1, 0)
    if friction == "none":
        place = fmu["source.displacement"] + np.array(values["source.center"])
        place -= (place @ AXIS) * AXIS if shape == "cylinder" else 0.0
        momentum = np.cross(place, fmu["source.velocity"])
        check_close("angular momentum", momentum, miss * SPEED * np.cross(ASIDE, ACROSS), 2e-14)
        assert fmu["solver.steps"] < 200 + 2 * steps and fmu["solver.fallbacks"] == 0


FREE_AND_VISCOUS = {"contact.penalty_control": "viscous_only", "destination.motion": "free"}
FREE_AND_VISCOUS |= {"destination.mass": 4.0, "destination.initial_velocity": [0.25, -0.5, 0.0]}


@pytest.mark.parametrize("dashpot, miss, more", [
    *(("unclamped", 1e-2, {}), ("non_adhesive", 1e-5, {}), ("approach_only", 1e-8, {})),
    ("non_adhesive", 1e-12, FREE_AND_VISCOUS),
])  # fmt: skip
def test_a_near_miss_of_the_centre_ends_where_the_taylor_reference_does(opened, shape, dashpot, miss, more):
    values = solid(shape, ACROSS, **{"contact.dashpot": dashpot, "contact.penalty_factor": 10.0, **more})
    values["contact.viscous_penalty_factor"] = 0.3
    values["source.center"] = (-START * ACROSS + miss * ASIDE).tolist()
    with localcontext(prec=40):
        reference = Reference(values, shape, number=Decimal, order=30).run(END)
        expected = [float(x) for x in reference.position["source"]]
    fmu = run(opened(FMU[shape]), values, END, 1, tolerance=1e-9, method="event_driven")
    check_close("position", fmu["source.displacement"] + values["source.center"], expected, 1e-13)
    check_close("onsets", fmu["contact.onsets"], reference.onsets, 0)


def led(shape, begin, end, miss=0.0, **more):
    """The ball moves along x from `begin` to `end` within a second and misses a solid's centre by `miss`."""
    velocity = ((end - begin) * ACROSS).tolist()
    return solid(shape, ACROSS, **{"contact.penalty_factor": LED, "source.motion": "prescribed"}) | {
        "contact.viscous_penalty_factor": 0.0, "source.initial_velocity": [0.0, 0.0, 0.0],
        "source.center": (begin * ACROSS + miss * ASIDE).tolist(),
        "source.prescribed_velocity": velocity, "source.prescribed_displacement.derivatives": [velocity],
        **more,
    }  # fmt: skip


def stored(x, miss):
    return LED * (REACH - math.hypot(x, miss)) ** 2 / 2


@pytest.mark.parametrize("steps", [1, 7, 13])
@pytest.mark.parametrize("miss", [0.0, 1e-12, 1e-6, 1e-3, 0.1])
def test_a_ball_led_through_a_solid_leaves_the_impulse_of_its_way(opened, shape, miss, steps, method):
    """With x dx = d dd and the miss b, the integrals of F x / d and F b / d over x are p_n (r d - d^2 / 2)
    and p_n b (r asinh(x / b) - x), where r is the reach."""
    begin, end = -0.35, 0.41

    def along(x):
        d = math.hypot(x, miss)
        return LED * (REACH * d - d * d / 2)

    def aside(x):
        return LED * miss * (REACH * math.asinh(x / miss) - x) if miss else 0.0

    fmu = opened(FMU[shape])
    impulse, _ = impulse_and_peak(fmu, led(shape, begin, end, miss), 1.0, steps, 1e-10, method)
    expected = (along(end) - along(begin)) * ACROSS + (aside(end) - aside(begin)) * ASIDE
    size = LED * REACH
    check_close("impulse", impulse, expected / (end - begin), 1e-8 * size)
    check_close("work", fmu["energy.external_work"], stored(end, miss) - stored(begin, miss), 1e-8 * size)
    assert fmu["contact.onsets"] == 1


@pytest.mark.parametrize("dashpot", ["unclamped", "approach_only"])
@pytest.mark.parametrize("damping", [1e7, 1e9])
@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-9])
def test_a_far_overdamped_ball_creeps_off_the_centre_as_with_cvode(opened, shape, off, damping, dashpot):
    """It starts beside the centre and goes past it: which way it leaves is decided within off / SPEED."""
    values = solid(shape, ACROSS, **{"contact.dashpot": dashpot, "source.center": (off * ASIDE).tolist()})
    values |= {"contact.penalty_factor": 2e10, "contact.viscous_penalty_factor": damping}
    fmu = opened(FMU[shape])
    end = 1e-3
    expected = run(fmu, values, end, 1, tolerance=1e-11, method="cvode_bdf")["source.displacement"]
    way = np.linalg.norm(expected)
    fmu = run(fmu, values, end, 1, tolerance=1e-9, method="event_driven")
    # d is known to roundings of the reach, and n to their part of d
    rounded = 64 * np.finfo(float).eps * REACH / off
    check_close("displacement", fmu["source.displacement"], expected, way * (1e-8 + rounded))
    assert fmu["solver.steps"] < 100 and fmu["solver.fallbacks"] == 0


@pytest.mark.parametrize("stop", [0.0, 0.3])
def test_a_ball_led_out_of_the_centre_or_to_it_takes_few_panels(opened, shape, stop):
    """The contact's direction in the centre differs from that on the way."""
    values = led(shape, 0.3 - stop, stop, **{"solver.max_internal_steps": 100})
    fmu = run(opened(FMU[shape]), values, 1.0, 1, tolerance=1e-10, method="event_driven")
    check_close("mean force", fmu["contact.mean_force"], LED * (REACH - 0.15) * ACROSS, 1e-9 * LED)


def test_a_ball_led_past_the_centre_goes_on_from_where_a_limit_stopped_it(opened, shape):
    """The work on the ball is compared, in parts of few panels each."""
    begin, end, miss = -0.3, 0.6, 1e-3
    values = led(shape, begin, end, miss, **{"solver.max_internal_steps": 20})
    fmu = start(opened(FMU[shape]), values, 1e-10, "event_driven")
    stops = [0.0]
    while fmu.time < 1.0:
        with contextlib.suppress(FmuError):
            fmu.step(1.0 - fmu.time)
        assert fmu.time > stops[-1]
        stops.append(fmu.time)
    assert len(stops) > 2
    check_close("work", fmu["energy.external_work"], stored(end, miss) - stored(begin, miss), 1e-8 * LED)


@pytest.mark.parametrize("mass", [1.0, 2e11])
@pytest.mark.parametrize("gravity", [50.0, 84.0, 85.0, 86.0, 200.0])
def test_balls_that_fall_together_pass_their_centre_once(opened, shape, gravity, mass):
    """They fall so far that their positions do not tell any more on which side of it they are. A force
    presses one through the other, against a dashpot that lets go there."""
    force, damping, reach, duration = 6.6e-8, 3.4e-5, 0.0040004, 80.0
    values = {"source.motion": "free", "destination.motion": "free", "source.mass": 0.03}
    values |= {"destination.mass": mass, "source.radius": 4e-7, "destination.radius": 0.004}
    values |= {"source.center": [0.0, 0.0, reach + 5e-8], "source.initial_velocity": [0.0, 0.0, -1e-6]}
    values |= {"source.external_force": [0.0, 0.0, -force], "gravity": [0.0, 0.0, -gravity]}
    values |= {"contact.location": "outside", "contact.penalty_control": "user_defined"}
    values |= {"contact.penalty_factor": 3e-12, "contact.viscous_control": "user_defined"}
    values |= {"contact.viscous_penalty_factor": damping, "contact.dashpot": "non_adhesive"}
    values |= {"destination.axis": [0.0, 1.0, 0.0]} if shape == "cylinder" else {}
    fmu = run(opened(FMU[shape]), values, duration, 1, 1e-9, "event_driven")
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.events"] == 2
    way = fmu["source.displacement"][2] - fmu["destination.displacement"][2]
    decay, pull = 0.03 * mass / (0.03 + mass) / damping, force / 0.03
    speed = math.sqrt(1e-12 + 2 * pull * 5e-8)  # at the touch

    def pressed(t):
        return pull * decay * t - (speed - pull * decay) * decay * math.expm1(-t / decay)

    centre = brentq(lambda t: pressed(t) - reach, 1.0, duration)
    rate = pull * decay + (speed - pull * decay) * math.exp(-centre / decay)
    left = duration - (speed - 1e-6) / pull - centre  # without the dashpot
    check_close("way", way, -5e-8 - reach - rate * left - pull * left**2 / 2, 1e-8)
