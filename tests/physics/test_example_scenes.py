"""The example scenes, whose choices are compiled in, move as the reference does."""

import pytest

from support.checks import METHODS, check_close, run
from support.reference.integrator import Reference
from support.scenes.benchmarks import BENCHMARKS

FREE_ON_FIXED = {"source.motion": "free", "destination.motion": "fixed"}
EXAMPLES = {  # shape, everything pinned and everything set, end
    "BallOnSphere": (
        "sphere",
        {**BENCHMARKS["P2"].configuration, "contact.location": "outside"},
        1.5,
    ),
    "BallInShell": (
        "sphere",
        {
            **FREE_ON_FIXED,
            "contact.location": "inside",
            "source.center": [0.2, 0.0, 0.1],
            "source.initial_velocity": [0.0, 0.5, 0.0],
            "contact.penalty_control": "automatic",
            "contact.penalty_multiplier": 1e-4,
            "contact.viscous_control": "automatic",
            "contact.characteristic_time": 1e-4,
        },
        1.0,
    ),
    "BallOffRoller": (
        "cylinder",
        {
            **FREE_ON_FIXED,
            "contact.location": "outside",
            "source.center": [0.02, 0.0, 0.61],
            "source.initial_velocity": [0.0, 1.0, 0.0],
            "destination.axis": [0.0, 1.0, 0.0],
            "destination.finite_length": True,
            "destination.length": 1.0,
            "contact.penalty_factor": 1e5,
            "contact.viscous_penalty_factor": 50.0,
        },
        1.0,
    ),
}
EXAMPLES["BouncingBall"] = (
    "plane",
    {
        **FREE_ON_FIXED,
        "source.initial_velocity": [0.1, 0.0, 0.0],
        "contact.viscous_penalty_factor": 148.71019419528124,
    },
    1.5,
)
EXAMPLES["PinnedEvent"] = EXAMPLES["BallOffRoller"]
# The methods that an example offers.
OFFERED = [
    (name, method)
    for name in EXAMPLES
    for method in METHODS
    if name not in ("PinnedEvent", "BouncingBall") or method == "event_driven"
]


@pytest.mark.parametrize(("name", "method"), OFFERED)
def test_an_example_scene_moves_as_the_reference(opened, name, method):
    shape, configuration, end = EXAMPLES[name]
    fmu = opened(name)
    own = {n: value for n, value in configuration.items() if n in fmu}
    run(fmu, own, end, 10, method=method if "solver.method" in fmu else None)
    expected = Reference(configuration, shape).run(end)
    check_close("source.position", fmu["source.position"], expected.position["source"], 1e-6)
    check_close("source.velocity", fmu["source.velocity"], expected.velocity["source"], 1e-5)
    assert fmu["contact.onsets"] == expected.onsets
