"""Parameters that contradict each other are refused at the end of initialization, naming both."""

import pytest

from support.fmi2 import raw
from support.fmi2.raw import ERROR

CONTRADICTIONS = [
    (
        {"contact.location": "inside", "source.radius": 0.5, "destination.radius": 0.5},
        ("contact.location", "source.radius", "destination.radius"),
        {"source.radius": 0.1},
    ),
    (
        {"contact.location": "inside", "source.radius": 0.7},
        ("contact.location", "source.radius", "destination.radius"),
        {"source.radius": 0.1},
    ),
    (
        {"contact.method": "penalty", "contact.penalty_control": "viscous_only"},
        ("contact.method", "contact.penalty_control"),
        {"contact.penalty_control": "user_defined"},
    ),
    (
        {"contact.viscous_control": "restitution", "contact.penalty_control": "viscous_only"},
        ("contact.viscous_control", "contact.penalty_control"),
        {"contact.penalty_control": "user_defined"},
    ),
    (
        {"contact.viscous_control": "restitution", "source.motion": "prescribed"},
        ("contact.viscous_control", "source.motion", "destination.motion"),
        {"destination.motion": "free"},
    ),
    (
        {"contact.viscous_control": "restitution", "contact.penalty_factor": 0.0},
        ("contact.viscous_control", "contact.penalty_factor"),
        {"contact.penalty_factor": 1.0},
    ),
]


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder"])
@pytest.mark.parametrize(("values", "named", "repair"), CONTRADICTIONS)
def test_contradictory_parameters_are_refused_naming_both(scene, values, named, repair):
    with raw.Instance(raw.load(scene)) as instance:
        instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        instance.set({"source.center": [0.3, 0.0, 0.0]} | values)
        instance.ok("EnterInitializationMode")
        with instance.expect(ERROR, *named) as got:
            got(instance.call("ExitInitializationMode"))
        instance.set(repair)
        instance.ok("ExitInitializationMode")
        instance.run([0.01])


def test_a_shell_smaller_than_its_ball_is_refused_where_inside_is_pinned():
    with raw.Instance(raw.load("BallInShell")) as instance:
        instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        instance.set({"source.radius": 0.6})
        instance.ok("EnterInitializationMode")
        with instance.expect(ERROR, "source.radius", "destination.radius", "inside") as got:
            got(instance.call("ExitInitializationMode"))
