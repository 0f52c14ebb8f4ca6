"""contact.peak_force and contact.peak_penetration of contacts whose rounding counts: right, or refused"""

import math

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import check_close, run, start
from support.scenes.head_on import FMU, GEOMETRIES, head_on
from support.scenes.stiff_scenes import SCENES, stiff_scene

METHOD = "event_driven"
TOLERANCE = 1e-10
STIFF = (1e23, 1e25, 1e26, 1e27, 1e28, 1e30, 1e33, 1e50, 1e100)


def peaks_or_none(fmu, stiffness):
    """Force, and penetration times the stiffness; None where both are refused"""
    peaks = []
    for name, scale in (("contact.peak_force", 1.0), ("contact.peak_penetration", stiffness)):
        try:
            peaks.append(fmu[name] * scale)
        except FmuError as error:
            if f"{name} is not known: " not in str(error):
                raise
    assert len(peaks) != 1
    return peaks or None


def peaks_of_steps(fmu, name, stiffness, share, steps):
    _, values, end = stiff_scene(name, stiffness, share)
    fmu = start(fmu, values, TOLERANCE, METHOD)
    peaks = []
    for k in range(steps):
        fmu.step(end * (k + 1) / steps - fmu.time)
        peaks.append(peaks_or_none(fmu, stiffness))
        assert math.isfinite(fmu["contact.normal_force"]) and math.isfinite(fmu["energy.total"])
    return peaks


@pytest.mark.parametrize("steps", [1, 5, 37])
@pytest.mark.parametrize("share", [0.1, 1.0, 1.2, 5.0])
@pytest.mark.parametrize("name", SCENES)
def test_peaks_are_right_or_refused(opened, name, share, steps):
    """In each step as at 1e22 N/m, where rounding does not count yet, or refused: only of the step in which
    the contact begins, and not below 1e26 N/m"""
    fmu = opened(FMU[SCENES[name][0]])
    expected = peaks_of_steps(fmu, name, 1e22, share, steps)
    assert None not in expected
    for stiffness in STIFF:
        peaks = peaks_of_steps(fmu, name, stiffness, share, steps)
        assert None not in peaks[1:]
        assert stiffness >= 1e26 or peaks[0]
        for now, then in zip(peaks, expected, strict=True):
            if now:
                check_close(f"force at {stiffness} N/m", now[0], then[0], 1e-6 * then[0])
                check_close(f"depth at {stiffness} N/m", now[1], then[1], 1e-6 * then[1])


@pytest.mark.parametrize("stiffness", [1e22, 1e33, 1e54, 1e70, 1e100])
def test_an_undamped_oscillation_keeps_its_amplitude(opened, stiffness):
    """P3 starts where the load is a fifth of that at the bottom, and oscillates by it ever after: the force
    is largest at the bottom, 5 m g / 2 in all"""
    shape, values, end = stiff_scene("P3", stiffness, 0.0)
    fmu = run(opened(FMU[shape]), values, end, 1, TOLERANCE, METHOD)
    largest = peaks_or_none(fmu, stiffness)
    check_close("force", largest[0], 2.4525, 1e-7)
    check_close("depth", largest[1], 2.4525, 1e-7)


def test_a_set_down_ball_whose_speed_is_rounding_is_refused_until_it_settles(opened):
    """Its speed along n is 1e-16 m/s by rounding, which makes as much force as the load"""
    shape, values, _ = stiff_scene("tilted cylinder", 1e33, 0.5)
    fmu = start(opened(FMU[shape]), values, TOLERANCE, METHOD)
    fmu.step(0.1)
    assert peaks_or_none(fmu, 1e33) is None
    fmu.step(0.1)
    assert peaks_or_none(fmu, 1e33) is not None


@pytest.mark.parametrize("stiffness", [1e7, 1e20, 1e33, 1e70, 1e100])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_the_peak_of_an_impact_is_known_at_any_stiffness(opened, shape, location, stiffness):
    """v sqrt(m k): the touch is an event, the gap zero there"""
    values = head_on(
        shape, location, source_mass=2.0, contact_method="penalty_dynamic", contact_penalty_factor=stiffness,
        contact_viscous_penalty_factor=0.0,
    )  # fmt: skip
    fmu = start(opened(FMU[shape]), values, TOLERANCE, METHOD)
    speed = np.linalg.norm(np.array(values["source.initial_velocity"]))
    fmu.step(1.0)
    assert fmu["contact.onsets"] >= 1
    expected = speed * math.sqrt(2.0 * stiffness)
    check_close("force", fmu["contact.peak_force"] / expected, 1.0, 1e-9)
