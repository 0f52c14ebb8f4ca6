"""A prescribed axis that is zero or turns otherwise than its body: refused, and warned of, between steps."""

import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import start

TURNED = {"source.motion": "fixed", "destination.rotation": "prescribed"}


def test_an_axis_of_zero_is_refused_between_steps_and_not_in_force(opened):
    values = TURNED | {"destination.axis": [0.0, 0.0, 1.0], "destination.prescribed_axis": [0.0, 0.0, 2.0]}
    fmu = start(opened("SphereCylinder"), values)
    fmu.step(0.1)
    fmu["destination.prescribed_axis"] = [0.0, 0.0, 0.0]
    with pytest.raises(FmuError, match=r"destination\.prescribed_axis"):
        fmu.step(0.1)


@pytest.mark.parametrize("axis, rate, spin, warned", [
    # omega x e_x = (0, omega_z, -omega_y); the length of the axis and its own rate do not matter
    ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [3.0, 0.0, 0.5], False),
    ([2.0, 0.0, 0.0], [0.3, 1.0, -0.4], [-1.0, 0.2, 0.5], False),
    ([2.0, 0.0, 0.0], [0.3, 1.0, -0.4], [-1.0, 0.2, 0.4], True),
    ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0], True),
    ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5 + 1e-9], False),
])  # fmt: skip
def test_an_axis_that_turns_otherwise_than_its_body_is_warned_of_once(opened, axis, rate, spin, warned):
    values = TURNED | {"destination.axis": [1.0, 0.0, 0.0], "destination.prescribed_axis": axis}
    values |= {"destination.prescribed_axis.derivatives": [rate]}
    fmu = start(opened("SphereCylinder"), values | {"destination.prescribed_angular_velocity": spin})
    for _ in range(3):
        fmu["destination.prescribed_axis"] = axis
        fmu.set_derivative("destination.prescribed_axis", rate, order=1)
        fmu.step(0.01)
    found = [message.text for message in fmu.messages if message.category == "logStatusWarning"]
    assert len(found) == (1 if warned else 0), found
    words = "destination.prescribed_axis", "destination.prescribed_angular_velocity", "Given once"
    assert all(word in text for text in found for word in words)
