"""Parameters that contradict each other are refused at the end of initialization, naming both, by FMI 2.0 and
by FMI 3.0; values that make no sense are refused as they are set."""

import pytest

from support.fmi2 import raw as fmi2
from support.fmi2.raw import DISCARD, ERROR
from support.fmi3 import raw as fmi3

PAIR = ("SphereSphere", "SphereCylinder")
CYLINDER, PLANE = ("SphereCylinder",), ("SpherePlane",)
HERTZ = {"contact.law": "hertz"}
TURNS = {"destination.motion": "free", "destination.rotation": "free"}
CAPPED = {"destination.ends": "capped", "destination.finite_length": True, "source.center": [0.0, 0.0, 2.0]}
RADII = ("contact.location", "source.radius", "destination.radius")
SMALLER = {"source.radius": 0.1}
# FMUs, values, what the message names, and what repairs them
CONTRADICTIONS = [
    (PAIR, {"contact.location": "inside", "source.radius": 0.5, "destination.radius": 0.5}, RADII, SMALLER),
    (PAIR, {"contact.location": "inside", "source.radius": 0.7}, RADII, SMALLER),
    (PAIR, {"contact.method": "penalty", "contact.penalty_control": "viscous_only"},
        ("contact.method", "contact.penalty_control"), {"contact.penalty_control": "user_defined"}),
    (PAIR, {"contact.viscous_control": "restitution", "contact.penalty_control": "viscous_only"},
        ("contact.viscous_control", "contact.penalty_control"), {"contact.penalty_control": "user_defined"}),
    (PAIR, {"contact.viscous_control": "restitution", "source.motion": "prescribed"},
        ("contact.viscous_control", "source.motion", "destination.motion"), {"destination.motion": "free"}),
    (PAIR, {"contact.viscous_control": "restitution", "contact.penalty_factor": 0.0},
        ("contact.viscous_control", "contact.penalty_factor"), {"contact.penalty_factor": 1.0}),
    (("BallInShell",), {"source.radius": 0.6}, ("source.radius", "destination.radius", "inside"), SMALLER),
    (PAIR, HERTZ | {"contact.penalty_control": "viscous_only"}, ("contact.penalty_control", "contact.law"),
        {"contact.penalty_control": "user_defined"}),
    (PAIR, HERTZ | {"contact.viscous_control": "restitution", "contact.hertz_stiffness": 0.0},
        ("contact.viscous_control", "contact.hertz_stiffness"), {"contact.hertz_stiffness": 1e6}),
    (PAIR,
        HERTZ | {"contact.penalty_control": "automatic", "contact.location": "inside", "source.radius": 0.5},
        RADII, SMALLER),
    (PLANE, {"contact.friction": "elastic", "contact.friction_coefficient": 0.4,
        "contact.static_friction_coefficient": 0.3}, ("contact.static_friction_coefficient",
        "contact.friction_coefficient"), {"contact.static_friction_coefficient": 0.4}),
    (PLANE, {"contact.friction": "elastic", "contact.tangential_law": "mindlin"},
        ("contact.tangential_law", "contact.law"), {"contact.law": "hertz"}),
    (CYLINDER, {"destination.axis": [0.0, 0.0, 0.0], "source.center": [1.1, 0.0, 0.0]}, ("destination.axis",),
        {"destination.axis": [0.0, 2.0, 0.0]}),
    (CYLINDER, {"destination.rotation": "prescribed", "destination.prescribed_axis": [0.0, 0.0, 0.0]},
        ("destination.prescribed_axis",), {"destination.prescribed_axis": [0.0, 0.0, 1.0]}),
    (CYLINDER, TURNS, ("destination.inertia_control", "destination.finite_length"),
        {"destination.finite_length": True}),
    (CYLINDER, {**TURNS, "destination.inertia_control": "user_defined", "destination.axial_inertia": 1.0,
        "destination.transverse_inertia": 0.49}, ("destination.transverse_inertia",
        "destination.axial_inertia"), {"destination.transverse_inertia": 0.5}),
    (PLANE, {"destination.rotation": "free"}, ("destination.rotation",), {"destination.rotation": "none"}),
    (CYLINDER, CAPPED | {"destination.finite_length": False},
        ("destination.ends", "destination.finite_length"), {"destination.finite_length": True}),
    (CYLINDER, CAPPED | {"contact.location": "inside"}, ("contact.location", "destination.ends"),
        {"contact.location": "outside"}),
]  # fmt: skip
ROWS = [(scene, *row) for scenes, *row in CONTRADICTIONS for scene in scenes]


@pytest.mark.parametrize("version", [fmi2, fmi3], ids=["FMI 2.0", "FMI 3.0"])
@pytest.mark.parametrize(("scene", "values", "named", "repair"), ROWS)
def test_contradictory_parameters_are_refused_naming_both(scene, values, named, repair, version):
    with version.Instance(version.load(scene)) as instance:
        instance.enter_initialization({"source.center": [0.3, 0.0, 0.0]} | values)
        instance.expect(ERROR, *named)(instance.call("ExitInitializationMode"))
        instance.set(repair)
        instance.ok("ExitInitializationMode")
        told = instance.step(0.0, 0.01).status if version is fmi3 else instance.call("DoStep", 0.0, 0.01, 1)
        assert told == version.OK


# Beyond the ranges of the description, whose ends test_bad_input.py has
SENSELESS = {"contact.friction_coefficient": [-0.1], "contact.characteristic_slip_velocity": [0.0, -1e-3]}
SENSELESS |= {"contact.maximum_friction_force": [-1.0], "contact.tangential_stiffness": [0.0]}
SENSELESS |= {"contact.tangential_ratio": [0.0], "contact.tangential_damping": [-1.0]}
SENSELESS |= {"contact.rolling_stiffness": [0.0], "contact.spinning_damping": [-1.0]}
SENSELESS |= {"contact.restitution": [1.01, -0.01], "source.poissons_ratio": [0.51, -1.0]}
SENSELESS |= {"source.youngs_modulus": [0.0], "source.axial_inertia": [0.0]}


@pytest.mark.parametrize("scene", [*PAIR, *PLANE])
@pytest.mark.parametrize("name", SENSELESS)
def test_what_makes_no_sense_is_refused_by_name(scene, name):
    with fmi2.Instance(fmi2.load(scene)) as instance:
        for value in SENSELESS[name]:
            expected = instance.expect(DISCARD, name, f"{value:g} refused", "allowed: ")
            expected(instance.set_one(instance.fmu.variables[name], value))
