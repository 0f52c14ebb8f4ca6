"""Many communication steps where bodies turn or rub: one internal step goes on beyond several of them."""

import numpy as np
import pytest

from support.checks import check_close, run, start
from support.scenes import turning_cases as cases
from support.scenes.scene_checks import FMU

MANY = 400


def positions(fmu, case, steps, **options):
    rows = []
    run(fmu, case.values, case.end, steps, each=lambda fmu: rows.append(fmu["source.position"]), **options)
    return np.array(rows)


def test_positions_within_a_step_are_those_of_the_closed_form(opened):
    """At the default tolerance: what is read within a step is as good as what the tolerance asks for."""
    case = cases.golfers_tube(5e-10, turns=1.0)
    read = positions(opened(FMU[case.shape]), case, MANY, tolerance=1e-8)
    closed = np.array([
        cases.golfers_tube(5e-10, turns=k / MANY).expected["source.position"] for k in range(1, MANY + 1)
    ])  # fmt: skip
    check_close("position", read[1:], closed, 2e-9)


def test_peaks_are_those_of_each_communication_step(opened):
    """A ball that bounces in a bowl, with peaks of force in the midst of steps: compared with those of short
    steps, whose ends are next to any peak."""
    case = cases.bowl(1e-3, 1e3)
    values = case.values | {"source.initial_velocity": [0.0, 0.0, -0.5]}
    peaks = {}
    for steps in (20, 2000):
        of_step = []

        def note(fmu, rows=of_step):
            rows.append([fmu["contact.peak_force"], fmu["contact.peak_penetration"]])

        run(opened(FMU[case.shape]), values, 0.2, steps, each=note)
        peaks[steps] = np.array(of_step[1:])
    short = peaks[2000].reshape(20, 100, 2).max(axis=1)
    assert np.ptp(short[:, 0]) > 0.1 * short[:, 0].max()
    check_close("force", peaks[20][:, 0], short[:, 0], 1e-6 * short[:, 0].max())
    check_close("penetration", peaks[20][:, 1], short[:, 1], 1e-6 * short[:, 1].max())


@pytest.mark.parametrize("changes", [0, 1, 7])
def test_inputs_end_the_step_that_goes_on(opened, changes):
    """Forces that change at a few communication points, among many or at these alone."""
    case = cases.turntable(1e-3)
    forces = [[0.1 * k, -0.2, 0.0] for k in range(changes + 1)]
    ended = []
    for steps in (1, 60):
        fmu = start(opened(FMU[case.shape]), case.values, tolerance=1e-8)
        for k, force in enumerate(forces):
            for i in range(steps):
                fmu["source.external_force"] = force
                fmu.step((k + (i + 1) / steps) * case.end / len(forces) - fmu.time)
        ended.append(np.concatenate([fmu["source.position"], fmu["source.angular_velocity"]]))
    check_close("position and spin", ended[1], ended[0], 1e-9)
