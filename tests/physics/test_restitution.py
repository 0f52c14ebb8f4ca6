"""contact.restitution of the linear law: the speed after a free head-on impact over the speed before it is
that number, with the p_nv of the closed form.
"""

import math

import pytest

from support.checks import check_close, check_relative, run, start
from support.reference.law import ReferenceContact
from support.scenes.head_on import DASHPOTS, FMU, GEOMETRIES, of_size, shared_out, speed_after

MASSES = {  # motions, masses, reduced mass
    "source free": ("free", "fixed", 0.3, 7.0, 0.3),
    "destination free": ("fixed", "free", 5.0, 40.0, 40.0),
    "one prescribed": ("free", "prescribed", 1e-3, 1.0, 1e-3),
    "both free": ("free", "free", 1e-3, 1e3, 1e-3 * 1e3 / (1e-3 + 1e3)),
}
STATES = [(1e-6, 1e12), (1e-6, 1e2), (1.0, 1e6), (30.0, 1e9), (1e3, 1e12), (1e3, 1e2)]  # m/s, N/m
COEFFICIENTS = [0.05, 0.3, 0.5, 0.8, 0.97, 1.0]


def impact(shape, location, dashpot, restitution, speed, stiffness, masses):
    """Bodies as large as the impact asks for, a tenth of a radius apart; the values, and when it is over."""
    *moving, reduced = MASSES[masses]
    depth = speed * math.sqrt(reduced / stiffness)
    radius = max(0.1, 100 * depth)
    gap = 0.1 * radius
    values = of_size(shape, location, radius, gap, speed)
    values = shared_out(values, *moving) | {
        "contact.method": "penalty_dynamic",
        "contact.penalty_factor": stiffness,
        "contact.viscous_control": "restitution",
        "contact.restitution": restitution,
        "contact.dashpot": dashpot,
    }
    return values, gap / speed + 50 * depth / speed / max(restitution, 0.05)


@pytest.mark.parametrize("masses", MASSES)
@pytest.mark.parametrize("dashpot", DASHPOTS)
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_head_on_impact_leaves_that_part_of_the_speed(opened, shape, location, dashpot, masses):
    fmu = opened(FMU[shape])
    for speed, stiffness in STATES:
        for restitution in COEFFICIENTS:
            values, end = impact(shape, location, dashpot, restitution, speed, stiffness, masses)
            run(fmu, values, end, 1)
            what = f"v = {speed}, p_n = {stiffness}, e = {restitution}"
            assert (fmu["contact.onsets"], fmu["contact.active"]) == (1, False), what
            check_relative(what, speed_after(fmu, location), restitution * speed, 1e-10)


@pytest.mark.parametrize("method", ["cvode_bdf", "cvode_adams"])
@pytest.mark.parametrize("dashpot", DASHPOTS)
def test_cvode_gives_it_too(opened, dashpot, method):
    for restitution in (0.05, 0.6):
        values, end = impact("sphere", "outside", dashpot, restitution, 2.0, 1e7, "both free")
        fmu = run(opened("SphereSphere"), values, end, 1, method=method)
        check_relative("speed", speed_after(fmu, "outside"), restitution * 2.0, 1e-7)


@pytest.mark.parametrize("control", ["user_defined", "automatic"])
@pytest.mark.parametrize("dashpot", DASHPOTS)
def test_the_factor_shown_is_that_of_the_closed_form(opened, dashpot, control):
    for restitution in (0.05, 0.35, 0.3679, 0.7, 0.99):
        values, _ = impact("sphere", "outside", dashpot, restitution, 1.0, 3e5, "both free")
        values["contact.penalty_control"] = control
        fmu = start(opened("SphereSphere"), values)
        p_nv = fmu["contact.effective_viscous_penalty_factor"]
        check_relative("p_nv", p_nv, ReferenceContact(values, "sphere").viscous, 1e-14)


def test_zero_is_critical_damping_or_a_millionth(opened):
    fmu = opened("SphereSphere")
    for dashpot in DASHPOTS:
        values, end = impact("sphere", "outside", dashpot, 0.0, 1.0, 1e6, "source free")
        start(fmu, values)
        if dashpot == "unclamped":
            critical = 2 * math.sqrt(1e6 * MASSES["source free"][-1])
            check_relative("p_nv", fmu["contact.effective_viscous_penalty_factor"], critical, 1e-15)
        run(fmu, values, 1e4 * end, 1)
        check_close("speed", speed_after(fmu, "outside"), 0.0 if dashpot == "unclamped" else 1e-6, 1e-14)


def test_without_a_dashpot_it_is_of_no_effect(opened):
    values, end = impact("sphere", "outside", "non_adhesive", 0.5, 1.0, 1e6, "source free")
    values |= {"contact.method": "penalty"}
    fmu = run(opened("SphereSphere"), values, end, 1)
    check_relative("speed", speed_after(fmu, "outside"), 1.0, 1e-10)
