"""contact.restitution of the linear law shows the p_nv of the closed form, is critical damping or a millionth
at zero, and of no effect without a dashpot. That it is the speed after an impact over the speed before it is
families/test_head_on.py's and the atlas's claim."""

import math

import pytest

from support.checks import check_close, check_relative, run, start
from support.reference.law import ReferenceContact
from support.scenes.head_on import head_on, speed_after

MASS, STIFFNESS = 0.3, 1e6


def impact(dashpot, restitution, **more):
    """A ball meets another one, which is fixed, with 1 m/s."""
    return head_on(
        "sphere", "outside", source_mass=MASS, contact_method="penalty_dynamic",
        contact_penalty_factor=STIFFNESS, contact_viscous_control="restitution",
        contact_restitution=restitution, contact_dashpot=dashpot,
    ) | more  # fmt: skip


@pytest.mark.parametrize("control", ["user_defined", "automatic"])
def test_the_factor_shown_is_that_of_the_closed_form(opened, dashpot, control):
    both = {"destination.motion": "free", "destination.mass": 1e3, "contact.penalty_control": control}
    for restitution in (0.05, 0.35, 0.3679, 0.7, 0.99):
        values = impact(dashpot, restitution, **both)
        p_nv = start(opened("SphereSphere"), values)["contact.effective_viscous_penalty_factor"]
        check_relative("p_nv", p_nv, ReferenceContact(values, "sphere").viscous, 1e-14)


def test_zero_is_critical_damping_or_a_millionth(opened, dashpot):
    fmu = start(opened("SphereSphere"), impact(dashpot, 0.0))
    if dashpot == "unclamped":
        critical = 2 * math.sqrt(STIFFNESS * MASS)
        check_relative("p_nv", fmu["contact.effective_viscous_penalty_factor"], critical, 1e-15)
    run(fmu, impact(dashpot, 0.0), 6e3, 1)
    check_close("speed", speed_after(fmu, "outside"), 0.0 if dashpot == "unclamped" else 1e-6, 1e-14)


def test_without_a_dashpot_it_is_of_no_effect(opened):
    fmu = run(opened("SphereSphere"), impact("non_adhesive", 0.5, **{"contact.method": "penalty"}), 0.2, 1)
    check_relative("speed", speed_after(fmu, "outside"), 1.0, 1e-10)
