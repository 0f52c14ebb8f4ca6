"""Contacts that are brief beside the communication step and begin without a force, as under Hertz's law, or
between bodies that fly past each other: the general segment feels them, however long the step is. The
reference is three_balls.py.
"""

import numpy as np
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from support.checks import check_close
from support.reference.three_balls import BRIEF, reference

BALLS = ("left", "middle", "right")


def values_of(case):
    values = {"solver.method": "event_driven", "gravity": [0, 0, 0]}
    for contact, law, stiffness in zip(("first", "second"), case.laws, case.stiffness, strict=True):
        factor = "hertz_stiffness" if law == "hertz" else "penalty_factor"
        values |= {f"{contact}.law": law, f"{contact}.penalty_control": "user_defined"}
        values |= {f"{contact}.method": "penalty", f"{contact}.{factor}": stiffness}
    for k, ball in enumerate(BALLS):
        values |= {f"{ball}.center": case.places[k], f"{ball}.initial_velocity": case.velocities[k]}
        values |= {f"{ball}.mass": case.masses[k], f"{ball}.radius": case.radii[k]}
    return values


@pytest.mark.parametrize("steps", [1, 2, 40])
@pytest.mark.parametrize("name", BRIEF)
def test_a_brief_contact_is_felt_however_long_the_step(built, name, steps):
    case, expected = BRIEF[name], reference(name)
    with ContactFmu(built["ThreeBalls"]) as fmu:
        fmu.start(values_of(case), tolerance=1e-9)
        energy, moving = fmu["energy.total"], fmu["energy.kinetic"]
        for _ in range(steps):
            fmu.step(case.end / steps)
        check_close("energy", fmu["energy.total"], energy, 1e-9 * moving)
        assert fmu["solver.fallbacks"] > 0  # the general segment had its part
        size = np.abs(expected[:9]).max()
        for k, ball in enumerate(BALLS):
            check_close(f"{ball}.position", fmu[f"{ball}.position"], expected[3 * k : 3 * k + 3], 1e-8 * size)
