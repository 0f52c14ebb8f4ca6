"""Derivatives of an input set at a communication point without its value, which goes on from where it is."""

import pytest

from support.checks import METHODS, check_close, start


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["SphereSphere", "SphereCylinder"])
@pytest.mark.parametrize("order", [1, 2])
def test_a_force_whose_rate_changes_goes_on_from_its_present_value(opened, name, order, method):
    """1 kg, far from contact: 1 N, growing by 2 N/s to 3 N at 1 s, from there on with other derivatives"""
    values = {
        "source.motion": "free",
        "destination.motion": "fixed",
        "source.mass": 1.0,
        "source.center": [50.0, 0.0, 0.0],
        "gravity": [0.0, 0.0, 0.0],
        "source.external_force": [1.0, 0.0, 0.0],
        "source.external_force.derivatives": [[2.0, 0.0, 0.0]],
    }
    fmu = start(opened(name), values, tolerance=1e-10, method=method)
    fmu.step(1.0)
    check_close("velocity at 1 s", fmu["source.velocity"], [2.0, 0.0, 0.0], 1e-8)
    fmu.set_derivative("source.external_force", [-1.0, 0.0, 0.0], order=order)
    fmu.step(1.0)
    # 3 N - t, or, the rate left at 2 N/s, 3 N + 2 t - t^2 / 2
    grown = 3.0 - 0.5 if order == 1 else 3.0 + 1.0 - 1.0 / 6.0
    check_close("velocity at 2 s", fmu["source.velocity"], [2.0 + grown, 0.0, 0.0], 1e-8)
