"""What only shows with time or at the edge: huge steps."""

import math

import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import check_close, run, start


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
