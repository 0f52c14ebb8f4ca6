"""A prescribed displacement whose given derivative is not the prescribed velocity: each is taken at its word,
one warning says so, and nothing hangs. What agrees up to rounding is not warned of."""

import numpy as np
import pytest
from scipy.integrate import quad

from support.checks import check_close, run, start

FALLING = {  # a ball that falls on a ball that is led away
    "destination.motion": "prescribed",
    "source.center": [0.14, 0.18, 0.65],
    "contact.penalty_factor": 1e6,
    "contact.viscous_penalty_factor": 1e4,
    "destination.prescribed_displacement.derivatives": [[-0.9, 0.1, 0.1], [-3.0, 5.0, 3.0]],
}
PASSING = {"source.motion": "prescribed", "source.center": [-1.0, 0.1, 0.0], "contact.penalty_factor": 1e4}
PASSING |= {"contact.viscous_penalty_factor": 1e2, "gravity": [0.0, 0.0, 0.0]}
WARNED = "destination.prescribed_displacement", "destination.prescribed_velocity", "Given once"


def warnings(fmu):
    return [message for message in fmu.messages if message.category == "logStatusWarning"]


# Computed once by cvode_adams with a tolerance of 1e-13, to the digits that hold at 1e-12 too.
DURATION = {"non_adhesive": 1.83996919e-3, "approach_only": 1.48625523e-3, "unclamped": 1.84146345e-3}


@pytest.mark.parametrize("dashpot", DURATION)
def test_a_ball_on_a_contradiction(opened, dashpot, method):
    fmu = run(opened("SphereSphere"), {**FALLING, "contact.dashpot": dashpot}, 2.0, 1, 1e-9, method)
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.events"] == (2 if dashpot == "unclamped" else 3)
    assert fmu["solver.steps"] < (10 if method == "event_driven" else 5000)
    check_close("last_duration", fmu["contact.last_duration"], DURATION[dashpot], 1e-10)
    check_close("peak_penetration", fmu["contact.peak_penetration"], 9.34455164e-5, 1e-12)
    (warning,) = warnings(fmu)
    assert all(word in warning.text for word in WARNED)


@pytest.mark.parametrize("steps", [1, 7, 200])
@pytest.mark.parametrize("velocity", [0.0, 3.0, -2.0, 2.9])
def test_the_gap_follows_the_displacement(opened, velocity, method, steps):
    """The centres come as near as 0.1 m, whatever velocity the law sees."""
    rate = [3.0, 0.0, 0.0]
    values = {**PASSING, "source.prescribed_velocity": [velocity, 0.0, 0.0]}
    values |= {"source.prescribed_displacement.derivatives": [rate]}
    fmu = start(opened("SphereSphere"), values, 1e-10, method)
    deepest = 0.0
    for k in range(steps):
        fmu.step(1.0 * (k + 1) / steps - fmu.time)
        deepest = max(deepest, fmu["contact.peak_penetration"])
    reach = fmu["source.radius"] + fmu["destination.radius"]
    half = np.sqrt(reach**2 - 0.1**2) / 3.0
    check_close("peak_penetration", deepest, reach - 0.1, 1e-12)
    check_close("onset", fmu["contact.last_onset_time"], 1.0 / 3.0 - half, 1e-12)
    check_close("duration", fmu["contact.last_duration"], 2 * half, 1e-12)
    assert len(warnings(fmu)) == (velocity != 3.0)

    def gap_and_force(time):
        x = 3.0 * time - 1.0
        distance = np.hypot(x, 0.1)
        gap, gap_rate = distance - reach, x * velocity / distance
        return distance, x, max(-(1e4 * gap + 1e2 * gap_rate), 0.0)

    def power(time):  # of what moves the source: along its velocity
        distance, x, force = gap_and_force(time)
        return -force * x / distance * velocity

    expected = quad(power, 1.0 / 3.0 - half, 1.0 / 3.0 + half, points=[1.0 / 3.0], limit=500)[0]
    check_close("external_work", fmu["energy.external_work"], expected, 1e-6 * (1.0 + abs(expected)))


AGREEING = {
    "no derivatives": {"source.prescribed_velocity": [3.0, 0.0, 0.0]},
    "the same": {"source.prescribed_velocity": [3.0, 1.0, 0.0],
        "source.prescribed_displacement.derivatives": [[3.0, 1.0, 0.0], [5.0, 0.0, 0.0]]},
    "the same up to rounding": {"source.prescribed_velocity": [3.0, 1.0, 0.0],
        "source.prescribed_displacement.derivatives": [[3.0 * (1 + 1e-9), 1.0, 2e-16]]},
    "at rest": {"source.prescribed_displacement.derivatives": [[0.0, 0.0, 0.0]]},
    "at rest up to rounding": {"source.prescribed_velocity": [1e-17, 0.0, 0.0],
        "source.prescribed_displacement.derivatives": [[0.0, 0.0, 0.0]]},
    "force element": {"destination.motion": "prescribed", "source.prescribed_velocity": [3.0, 0.0, 0.0],
        "destination.prescribed_velocity": [0.0, 1.0, 0.0]},
    "force element with derivatives of zero": {"destination.motion": "prescribed",
        "source.prescribed_velocity": [3.0, 0.0, 0.0],
        "source.prescribed_displacement.derivatives": [[0.0, 0.0, 0.0]]},
}  # fmt: skip


@pytest.mark.parametrize("case", AGREEING)
def test_what_agrees_is_not_warned_of(opened, case):
    fmu = start(opened("SphereSphere"), {**PASSING, **AGREEING[case]}, 1e-8)
    for k in range(10):
        if "derivatives" not in str(AGREEING[case]):  # the normal importer: values at communication points
            fmu["source.prescribed_displacement"] = [0.3 * k, 0.0, 0.0]
            fmu["source.prescribed_velocity"] = [3.0, 0.0, 0.0]
        fmu.step(0.1)
    assert not warnings(fmu)


def test_a_swing_given_with_derivatives_is_not_warned_of(opened):
    fmu = start(opened("SphereSphere"), PASSING, 1e-8)
    for k in range(40):
        t = 0.05 * k
        fmu["source.prescribed_displacement"] = [np.sin(7 * t), 0.0, np.cos(7 * t)]
        fmu["source.prescribed_velocity"] = [7 * np.cos(7 * t), 0.0, -7 * np.sin(7 * t)]
        fmu.set_derivative("source.prescribed_displacement", [7 * np.cos(7 * t), 0.0, -7 * np.sin(7 * t)])
        fmu.step(0.05)
    assert not warnings(fmu)


def test_the_warning_is_part_of_the_state(opened):
    """A reset, or a restored state from before the warning, lets the warning come again."""
    fmu = start(opened("SphereSphere"), FALLING, 1e-8, "event_driven")
    before = fmu.save()
    fmu.step(0.1)
    after = fmu.save()
    assert len(warnings(fmu)) == 1

    def contradict():
        fmu.set_derivative("destination.prescribed_displacement", [1.0, 0.0, 0.0])
        fmu.step(0.1)
        return len(warnings(fmu))

    assert contradict() == 1
    fmu.restore(after)
    assert contradict() == 1
    fmu.restore(before)
    assert contradict() == 2
    start(fmu, FALLING, 1e-8, "event_driven").step(0.1)
    assert len(warnings(fmu)) == 1
