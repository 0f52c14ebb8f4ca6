"""Two given motions that pass by, from the values that everybody starts with. Others are a family of
support/scenes/scene_families.py.
"""

import pytest

from support.checks import METHODS, check_close, start

END = 2.0


@pytest.mark.parametrize("steps", [1, 20, 2000])
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
