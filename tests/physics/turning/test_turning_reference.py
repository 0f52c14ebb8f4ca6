"""The reference for bodies that turn and rub (support/reference/turning_run.py) against closed forms,
before anything else is compared with it. No FMU is run here.
"""

import numpy as np
import pytest

from support.checks import check_close, check_relative
from support.reference.turning_run import TurningRun
from support.scenes import turning_cases as cases
from support.scenes import turning_impacts as impacts
from support.scenes.turning_scenes import random_turning_scene

EXACT = {
    "slides, then rolls": (cases.slide_to_roll(1e-2), 1e-11),
    "back-spin": (cases.slide_to_roll(1e-2, 1.0, -60.0, end=0.6), 1e-10),
    "rolls down an incline": (cases.incline(1e-2, 0.4, end=0.5), 1e-9),
    "slides down an incline": (cases.incline(1e-2, 1.2, end=0.5), 1e-9),
    "oblique impact on springs": (impacts.oblique_impact(), 1e-11),
    "tumbling cylinder": (impacts.rotor(3.0), 1e-11),
}


def figures(case):
    return TurningRun(case.values, case.shape).run(case.end).figures()


@pytest.mark.parametrize("name", EXACT)
def test_the_reference_is_the_closed_form(name):
    case, allowed = EXACT[name]
    found = figures(case)
    for variable, expected in case.expected.items():
        check_close(f"{name}, {variable}", found[variable], expected, allowed)


LIMITS = {  # the case of a small number, one such number, the order in it
    "turntable": (lambda v_0: cases.turntable(v_0, end=0.5), 2e-2, 1),
    "golfer's tube": (lambda v_0: cases.golfers_tube(v_0, turns=0.1, stiffness=1e3), 4e-2, 1),
    "bowl": (lambda v_0: cases.bowl(v_0, 100 / v_0), 4e-2, 1),
    "lying tube": (lambda v_0: cases.bowl(v_0, 100 / v_0, "cylinder"), 4e-2, 1),
}


@pytest.mark.parametrize("name", LIMITS)
def test_the_reference_approaches_the_limit_in_its_order(name):
    made, small, order = LIMITS[name]
    errors = []
    for v_0 in (small, 0.5 * small):
        case = made(v_0)
        errors.append(np.linalg.norm(figures(case)["source.position"] - case.expected["source.position"]))
    assert errors[1] < 0.05
    check_relative(f"{name}: errors {errors}", errors[0] / errors[1], 2.0**order, 0.1)


def test_opposite_spins_change_nothing_where_balls_do_not_yield():
    """They yield by delta, and omega delta is slip: a tenth where p_n is a hundred times as large."""
    changes = []
    for factor in (1.0, 100.0):
        case = impacts.opposite_spin()
        values = {**case.values, "contact.penalty_factor": factor * 1e7}
        found = TurningRun(values, case.shape).run(case.end).figures()
        changes.append(abs(found["source.angular_velocity"][1] - 25.0))
    check_relative("order 1/2", changes[0] / changes[1], 10.0, 0.05)
    assert changes[1] < 1e-4


@pytest.mark.parametrize("seed", [0, 3, 6, 15, 21, 23, 34])
def test_momentum_and_energy_of_the_reference_stay(seed):
    """With friction and whatever else; of free pairs without forces from outside the momenta too."""
    scene = random_turning_scene(seed)
    run = TurningRun(scene.values, scene.shape)
    run.run(scene.end)
    energies = run.energies()
    size = max(1.0, *(abs(value) for value in energies.values()))
    check_close("energy", energies["total"], run.begin, 1e-11 * size)
    assert energies["friction"] >= 0


@pytest.mark.parametrize("friction", ["regularized", "elastic"])
def test_a_free_pair_keeps_its_momenta_in_the_reference(friction):
    case = impacts.shell(friction)
    run = TurningRun({**case.values, "contact.characteristic_slip_velocity": 0.1}, case.shape)
    before = impacts.momenta(run.figures(), case.values)
    after = impacts.momenta(run.run(0.3).figures(), case.values)
    assert len(run.onset_times) >= 2
    for name, old, new in zip(("momentum", "angular momentum"), before, after, strict=True):
        check_close(name, new, old, 1e-12)
