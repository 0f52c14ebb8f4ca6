"""The universal FMUs and the force element touch with the values they start with: no setting is needed"""

import pytest

from support.checks import check_close


@pytest.mark.parametrize("name", ["SphereSphere", "SphereCylinder"])
def test_a_run_without_any_setting_bounces(opened, name):
    """A ball of 0.1 m falls half a metre onto a body of 0.5 m, from 1.1 m, and rises again."""
    fmu = opened(name)
    fmu.start()
    fmu.step(0.6)
    assert fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], (2 * 0.5 / 9.81) ** 0.5, 1e-9)
    assert fmu["source.velocity"][2] > 0.9 * (2 * 9.81 * 0.5) ** 0.5 - 9.81 * 0.3


def test_the_force_element_presses_without_any_input(opened):
    """The bodies overlap by 1 mm at 1e6 N/m."""
    fmu = opened("ForceElement")
    fmu.start()
    fmu.step(1e-3)
    check_close("force", fmu["contact.source_force"], [1000.0, 0.0, 0.0], 1e-6)
