"""Directional derivatives in initialization mode: all Real unknowns of it, energies and peaks too, against
differences through the FMU. There the inputs move the start: no work is done, automatic factors follow."""

import numpy as np
import pytest

from support.fmi2 import raw
from support.fmi2.jacobian import checked_jacobian

# Bodies that overlap (the gap is -0.04 m) and move; the free one has kinetic and potential energy.
TOUCHING = {
    "source.center": [0.3, 0.1, 0.45], "destination.prescribed_displacement": [0.01, -0.02, 0.0],
    "destination.prescribed_velocity": [0.2, 0.0, 1.5], "source.prescribed_velocity": [0.0, 0.1, -0.4],
    "source.initial_velocity": [0.3, 0.2, -1.0], "contact.penalty_factor": 2e3,
    "contact.viscous_penalty_factor": 5.0,
}  # fmt: skip
LYING = {"destination.axis": [0.3, 1.0, 0.2]}
STARTS = {
    "a moved destination": {"destination.motion": "prescribed"},
    "a moved source": {"source.motion": "prescribed", "destination.motion": "free"},
    "both moved": {"source.motion": "prescribed", "destination.motion": "prescribed"},
    "apart": {"destination.motion": "prescribed", "source.center": [0.0, 0.3, 0.9]},
    "inside, apart": {"destination.motion": "prescribed", "source.center": [0.1, 0.2, 0.1]},
    "automatic factors": {
        "destination.motion": "prescribed",
        "contact.penalty_control": "automatic",
        "contact.viscous_control": "automatic",
        "contact.reference_modulus": 2e3,
    },
    "automatic stiffness": {
        "destination.motion": "prescribed",
        "contact.penalty_control": "automatic",
        "contact.reference_modulus": 2e3,
    },
    "automatic damping": {
        "destination.motion": "prescribed",
        "contact.viscous_control": "automatic",
        "contact.reference_modulus": 2e3,
    },
    "viscous only": {
        "destination.motion": "prescribed",
        "contact.penalty_control": "viscous_only",
        "contact.viscous_control": "automatic",
        "contact.reference_modulus": 1e6,
    },
    "no dashpot": {"destination.motion": "prescribed", "contact.method": "penalty"},
    # Receding fast: p_n g + p_nv g' > 0
    "pulling": {"destination.motion": "prescribed", "contact.dashpot": "unclamped",
                "source.initial_velocity": [6.0, 2.0, 9.0], "contact.viscous_penalty_factor": 50.0},
    "clipped": {"destination.motion": "prescribed", "contact.dashpot": "non_adhesive",
                "source.initial_velocity": [6.0, 2.0, 9.0], "contact.viscous_penalty_factor": 50.0},
    "restitution": {"destination.motion": "prescribed", "contact.dashpot": "approach_only",
                 "source.initial_velocity": [6.0, 2.0, 9.0], "contact.viscous_penalty_factor": 50.0},
}  # fmt: skip


MADE_OF_THE_DIAGONAL = ("automatic factors", "automatic stiffness")


@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder"])
@pytest.mark.parametrize("name", STARTS)
def test_derivatives_of_the_start_are_those_of_difference_quotients(scene, name):
    fmu = raw.load(scene)
    with raw.Instance(fmu) as instance:
        instance.enter_initialization(
            {**TOUCHING, **(LYING if scene == "SphereCylinder" else {}), **STARTS[name]}
        )
        unknowns = fmu.select("output", "calculatedParameter", kind="Real")
        knowns = fmu.select("input", kind="Real")
        given = checked_jacobian(instance, unknowns, knowns)
        names = [variable.name for variable in unknowns]
        felt = {names[i] for i in np.argwhere(given != 0.0)[:, 0]}
        touching = bool(instance.get("contact.active"))
        assert touching == ("apart" not in name)
        assert "contact.gap" in felt
        assert ("contact.peak_penetration" in felt) == touching
        assert ("contact.effective_penalty_factor" in felt) == (name in MADE_OF_THE_DIAGONAL)
