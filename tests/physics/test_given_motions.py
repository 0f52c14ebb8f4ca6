"""Contacts of which no body is free: events, onset, duration, energies, impulse and peaks of two given
motions passing by, against the closed form of the gap (given_motions.py).
"""

import numpy as np
import pytest

from support.checks import METHODS, check_close, start
from support.reference.passing import Passing
from support.scenes.given_motions import END, FAMILIES, STEPS, measured, scene

SEEDS, CHUNK = 480, 40
RELATIVE = 1e-8  # of energies and impulses: the quadrature is asked for 1e-10


def check_passing(values, steps, measures, truth):
    """Counts exactly, times to 1e-12 s, integrals and peaks to RELATIVE of their size."""
    for name in ("events", "onsets"):
        assert measures[name] == getattr(truth, name), name
    for name in ("onset", "duration"):
        check_close(name, measures[name], getattr(truth, name), 1e-12)
    turned = 0.5 * truth.k * truth.peak_penetration**2 + truth.peak_force * truth.peak_penetration
    size = turned + abs(truth.work) + abs(truth.dissipated)
    check_close("energy.dissipated", measures["dissipated"], truth.dissipated, RELATIVE * size)
    check_close("energy.external_work", measures["work"], truth.work, RELATIVE * size)
    check_close("energy.total", measures["total"], truth.stored(0.0, truth.pieces[0][2]), RELATIVE * size)
    for name in ("impulse", "peak_force", "peak_penetration"):
        expected = getattr(truth, name)
        check_close(name, measures[name], expected, RELATIVE * np.max(np.abs(expected)))


@pytest.mark.parametrize("first", range(0, SEEDS, CHUNK))
def test_two_given_motions_pass_by(opened, first):
    for seed in range(first, first + CHUNK):
        name, values, steps = scene(seed)
        measures = measured(opened(name), values, steps, END, "event_driven", 1e-10)
        try:
            check_passing(values, steps, measures, Passing(values, END))
        except AssertionError as wrong:
            raise AssertionError(f"seed {seed}: {wrong}") from None


def test_the_random_scenes_are_what_they_are_meant_to_be():
    scenes = [scene(seed) for seed in range(SEEDS)]
    truths = [Passing(values, END) for _, values, _ in scenes[::16]]
    assert {steps for _, _, steps in scenes} == set(STEPS)
    assert {name for name, _, _ in scenes} == set(FAMILIES.values())
    assert sum(truth.onsets > 0 for truth in truths) > len(truths) // 2
    assert sum(truth.events > 2 for truth in truths) > len(truths) // 10


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("method", METHODS)
def test_a_straight_pass_of_start_values(opened, method, steps):
    """Once it released and pressed again ten million times at one instant."""
    fmu = start(
        opened("SphereSphere"),
        {
            "source.motion": "prescribed",
            "source.center": [-1.0, 0.1, 0.0],
            "source.prescribed_velocity": [3.0, 0.0, 0.0],
        },
        1e-10,
        method,
    )
    for k in range(steps):
        fmu.step(END * (k + 1) / steps - fmu.time)
    assert fmu["solver.events"] == 3 and fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], 0.136130673896680, 1e-14)
    check_close("duration", fmu["contact.last_duration"], 0.394405318873308, 1e-14)
    check_close("dissipated", fmu["energy.dissipated"], 270.72014, 5e-6)
    check_close("total", fmu["energy.total"], 0.0, 1e-7)
