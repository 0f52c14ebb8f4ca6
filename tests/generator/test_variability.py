"""What modelDescription.xml says of when a variable changes, and of its start."""

import pytest

from support.generator.generated import SCENES, SUMS_UP, describe, whole

TUNABLE = {
    "penalty_multiplier", "penalty_factor", "characteristic_time", "viscous_penalty_factor", "dashpot",
    "reference_modulus", "gravity", "relative_tolerance", "absolute_tolerance", "max_internal_steps",
    "effective_penalty_factor", "effective_viscous_penalty_factor", "effective_hertz_stiffness",
    "hertz_stiffness", "hunt_crossley_factor", "restitution",
}  # fmt: skip


@pytest.mark.parametrize("scene", SCENES)
def test_variability_and_initial_follow_from_causality(scene):
    """What sums up a step changes at communication points only: nobody is to ask for its derivatives."""
    for name, entry in describe(scene).items():
        field = whole(name).rpartition(".")[2]
        sums_up = field in SUMS_UP
        varies = "continuous" if entry["base"] == "Real" and not sums_up else "discrete"
        fixed = "tunable" if field in TUNABLE else "fixed"
        assert (entry["variability"], entry["initial"]) == {
            "parameter": (fixed, "exact"),
            "calculatedParameter": (fixed, "calculated"),
            "input": (varies, None),
            "output": (varies, "calculated"),
            "local": (varies, "calculated"),
        }[entry["causality"]], name
