"""What is contradictory about turning and friction is refused in words, before anything moves."""

import pytest

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import start

TURNS = {"destination.motion": "free", "destination.rotation": "free"}
REFUSED = {  # FMU, values, what the message names
    "mu < 0": ("SpherePlane", {"contact.friction_coefficient": -0.1}, ["contact.friction_coefficient"]),
    "mu_s < mu": (
        "SpherePlane",
        {
            "contact.friction": "elastic",
            "contact.friction_coefficient": 0.4,
            "contact.static_friction_coefficient": 0.3,
        },
        ["contact.static_friction_coefficient", "contact.friction_coefficient"],
    ),
    "v_0 = 0": (
        "SpherePlane",
        {"contact.characteristic_slip_velocity": 0.0},
        ["contact.characteristic_slip_velocity"],
    ),
    "v_0 < 0": (
        "SphereSphere",
        {"contact.characteristic_slip_velocity": -1e-3},
        ["contact.characteristic_slip_velocity"],
    ),
    "largest force < 0": (
        "SphereSphere",
        {"contact.maximum_friction_force": -1.0},
        ["contact.maximum_friction_force"],
    ),
    "k_t <= 0": ("SphereSphere", {"contact.tangential_stiffness": 0.0}, ["contact.tangential_stiffness"]),
    "c_t < 0": ("SphereSphere", {"contact.tangential_damping": -1.0}, ["contact.tangential_damping"]),
    "no axis": ("SphereCylinder", {"destination.axis": [0.0, 0.0, 0.0]}, ["destination.axis"]),
    "no prescribed axis": (
        "SphereCylinder",
        {"destination.rotation": "prescribed", "destination.prescribed_axis": [0.0, 0.0, 0.0]},
        ["destination.prescribed_axis"],
    ),
    "infinite cylinder": (
        "SphereCylinder",
        TURNS,
        ["destination.inertia_control", "destination.finite_length"],
    ),
    "triangle inequality": (
        "SphereCylinder",
        {
            **TURNS,
            "destination.inertia_control": "user_defined",
            "destination.axial_inertia": 1.0,
            "destination.transverse_inertia": 0.49,
        },
        ["destination.transverse_inertia", "destination.axial_inertia"],
    ),
    "no inertia": (
        "SphereSphere",
        {
            "source.rotation": "free",
            "source.inertia_control": "user_defined",
            "source.axial_inertia": 0.0,
        },
        ["source.axial_inertia"],
    ),
    "a free plane does not turn": ("SpherePlane", {"destination.rotation": "free"}, ["destination.rotation"]),
}


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused_in_words(opened, name):
    fmu_name, values, named = REFUSED[name]
    with pytest.raises(FmuError) as refused:
        start(opened(fmu_name), values)
    for variable in named:
        assert variable in str(refused.value)


def test_an_axis_of_zero_is_refused_between_steps_and_not_in_force(opened):
    fmu = start(
        opened("SphereCylinder"),
        {
            "source.motion": "fixed",
            "destination.rotation": "prescribed",
            "destination.axis": [0.0, 0.0, 1.0],
            "destination.prescribed_axis": [0.0, 0.0, 2.0],
        },
    )
    fmu.step(0.1)
    fmu["destination.prescribed_axis"] = [0.0, 0.0, 0.0]
    with pytest.raises(FmuError, match=r"destination\.prescribed_axis"):
        fmu.step(0.1)


@pytest.mark.parametrize(
    "axis, rate, spin, warned",
    [  # omega x e_x = (0, omega_z, -omega_y); the length of the axis and its own rate do not matter
        ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [3.0, 0.0, 0.5], False),
        ([2.0, 0.0, 0.0], [0.3, 1.0, -0.4], [-1.0, 0.2, 0.5], False),
        ([2.0, 0.0, 0.0], [0.3, 1.0, -0.4], [-1.0, 0.2, 0.4], True),
        ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0], True),
        ([1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5 + 1e-9], False),
    ],
)
def test_an_axis_that_turns_otherwise_than_its_body_is_warned_of_once(opened, axis, rate, spin, warned):
    fmu = start(
        opened("SphereCylinder"),
        {
            "source.motion": "fixed",
            "destination.rotation": "prescribed",
            "destination.axis": [1.0, 0.0, 0.0],
            "destination.prescribed_axis": axis,
            "destination.prescribed_axis.derivatives": [rate],
            "destination.prescribed_angular_velocity": spin,
        },
    )
    for _ in range(3):
        fmu["destination.prescribed_axis"] = axis
        fmu.set_derivative("destination.prescribed_axis", rate, order=1)
        fmu.step(0.01)
    found = [message.text for message in fmu.messages if message.category == "logStatusWarning"]
    assert len(found) == (1 if warned else 0), found
    words = "destination.prescribed_axis", "destination.prescribed_angular_velocity", "Given once"
    assert all(word in text for text in found for word in words)
