"""Forces and given motions that grow from exactly nothing, at all damping: what is small at the start of a
step says nothing about the rest of it.
"""

import pytest

from support.checks import METHODS, check_close, run


def ramp_from_zero(force=0.0, **more):
    return {
        "source.center": [0.404, 0.0, 0.0],
        "source.external_force": [force, 0.0, 0.0],
        "source.external_force.derivatives": [[100.0, 100.0, 0.0]],
        "contact.location": "inside",
        "contact.method": "penalty_dynamic",
        "contact.dashpot": "unclamped",
        "contact.penalty_factor": 250.0,
        "contact.viscous_penalty_factor": 150.0,
        "gravity": [0.0, 0.0, 0.0],
        **more,
    }


@pytest.mark.parametrize("method", METHODS)
def test_a_ramp_beyond_critical_damping(opened, method):
    fmu = run(opened("SphereSphere"), ramp_from_zero(), 0.15, 1, 1e-10, method)
    allowed = 1e-12 if method == "event_driven" else 1e-7
    right = [0.406656168423122, 0.054633893477733, 0.0]
    check_close("position", fmu["source.position"], right, allowed)
    check_close("energy", fmu["energy.total"], 0.5 * 250.0 * 0.004**2, 10 * allowed)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_an_error_at_zero_force_is_that_at_hardly_any(opened, tolerance):
    """The error depends on the tolerance asked for, not on whether the start is exactly zero."""
    fmu = run(opened("SphereSphere"), ramp_from_zero(), 0.15, 1, tolerance, "event_driven")
    zero = list(fmu["source.position"])
    fmu = run(opened("SphereSphere"), ramp_from_zero(force=1e-13), 0.15, 1, tolerance, "event_driven")
    right = [0.406656168423122, 0.054633893477733, 0.0]
    check_close("from zero", zero, right, max(1e-3 * tolerance, 1e-14))
    check_close("from next to zero", fmu["source.position"], right, max(1e-3 * tolerance, 1e-14))
