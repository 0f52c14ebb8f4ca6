"""Bodies that turn and rub against closed forms: sliding, rolling, back-spin, tubes, bowls, turntables."""

import math

import numpy as np
import pytest

from contact_fmus.bench.problems import turning_problems
from support.checks import METHODS, check_close, check_relative, run, start
from support.scenes import turning_cases as cases
from support.scenes.scene_checks import FMU

CVODE = METHODS[1:]
ALLOWED = {"event_driven": 1e-9, "cvode_bdf": 1e-7, "cvode_adams": 1e-7}
# Explicit where it is stiff, Adams' method cannot follow a slip that dies away within 1e-6 s.
SMALL = {"event_driven": (1e-3, 1e-6, 1e-9), "cvode_bdf": (1e-3, 1e-6, 1e-9), "cvode_adams": (1e-2,)}
METHOD_AND_SMALL = [(method, v_0) for method in METHODS for v_0 in SMALL[method]]


def ended(opened, case, method="event_driven", tolerance=1e-10, steps=3):
    return run(opened(FMU[case.shape]), case.values, case.end, steps, tolerance, method)


def agrees(fmu, case, allowed):
    for variable, expected in case.expected.items():
        size = max(1.0, float(np.max(np.abs(expected))))
        check_close(variable, fmu[variable], expected, allowed * size)


@pytest.mark.parametrize("method, v_0", METHOD_AND_SMALL)
@pytest.mark.parametrize("speed, spin", [(2.0, 0.0), (1.0, -60.0), (0.5, 30.0)])
def test_a_ball_slides_until_it_rolls(opened, method, v_0, speed, spin):
    """At any v_0: also before it rolls, and with spin that drives it."""
    for end in (0.3, None):
        case = cases.slide_to_roll(v_0, speed, spin, end=end)
        agrees(ended(opened, case, method), case, ALLOWED[method])


def test_the_way_approaches_that_of_coulomb_in_second_order(opened):
    """(2/7) (pi^2/6) v_0^2/((7/2) mu g) beyond sliding with mu g and rolling with 5/7 v."""
    beyond = []
    for v_0 in (2e-2, 1e-2):
        fmu = ended(opened, cases.slide_to_roll(v_0, 2.0, end=1.0))
        begins = 2 * 2.0 / (7 * 0.2 * cases.G)
        beyond.append(fmu["source.position"][0] - 12 * 4.0 / (49 * 0.2 * cases.G) - 10 / 7 * (1.0 - begins))
    check_relative("order 2", beyond[0] / beyond[1], 4.0, 1e-3)
    check_relative("factor", beyond[1], 2 / 7 * math.pi**2 / 6 * 1e-4 / (3.5 * 0.2 * cases.G), 1e-3)


@pytest.mark.parametrize("method, v_0", METHOD_AND_SMALL)
@pytest.mark.parametrize("slope", [0.1, 0.4, 0.8, 0.9, 1.2])
def test_a_ball_rolls_down_an_incline_or_slides(opened, method, v_0, slope):
    """It rolls where tan <= 7 mu/2 = 1.05, by 5/7 g sin and a creep of order v_0; beyond, it slides too."""
    case = cases.incline(v_0, slope)
    agrees(ended(opened, case, method), case, ALLOWED[method])


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e7])
def test_a_ball_comes_up_again_in_a_tube_at_any_penetration(opened, stiffness):
    """Trajectory to 1e-9 in the limit of v_0, and the period to 1e-8: sqrt(7/2) orbits."""
    orbits = math.sqrt(7 / 2)
    few = {"solver.max_internal_steps": 20_000}  # of what does not grow as v_0 falls
    case = cases.golfers_tube(5e-10, stiffness=stiffness, turns=orbits, **few)
    fmu = ended(opened, case, steps=7)
    agrees(fmu, case, 1e-9)
    # At the top again it is at rest in height, and falls with 5/7 g.
    check_close("period", fmu["source.velocity"][2] / (5 / 7 * cases.G), 0.0, 1e-8 * case.end)
    half = cases.golfers_tube(5e-10, stiffness=stiffness, turns=0.5 * orbits, **few)
    check_close("lowest", ended(opened, half)["source.position"][2], -5 * cases.G / 64, 1e-9)


@pytest.mark.parametrize("made", [cases.turntable, lambda v_0: cases.incline(v_0, 0.4, end=10.0)])
def test_rolling_costs_no_more_where_less_slip_is_needed(opened, made):
    """Internal steps and their evaluations at v_0 = 1e-6 and 1e-9 m/s are at most twice those at 1e-3."""
    steps, evaluations = [], []
    for v_0 in (1e-3, 1e-6, 1e-9):
        fmu = ended(opened, made(v_0))
        steps.append(fmu["solver.steps"])
        evaluations.append(fmu["solver.force_evaluations"])
    assert max(steps) <= 2 * steps[0], steps
    assert max(evaluations) <= 2 * evaluations[0], evaluations


@pytest.mark.parametrize("name", ["F2", "F3"])
def test_few_steps_of_rolling_are_rejected(opened, name):
    """In a bowl for 10 s, and in the golfer's tube; and few are made where v_0 is the rounding of speeds."""
    problem = turning_problems()[name]
    rounding = {"contact.characteristic_slip_velocity": 1e-12, "solver.max_internal_steps": 1_000}
    run(opened(problem.fmu), problem.start | rounding, problem.stop, steps=1, tolerance=1e-9)
    fmu = run(opened(problem.fmu), problem.start, problem.stop, steps=1, tolerance=1e-8)
    check_close("position", fmu["source.position"], problem.position, 1e-10)
    assert 3 * fmu["solver.rejected_steps"] <= fmu["solver.steps"] <= 250
    fmu = run(opened(problem.fmu), problem.start, problem.stop, steps=997, tolerance=1e-12)
    assert fmu["solver.steps"] <= 500  # with a point at the end of every step there were 1,002 or more


def test_springs_are_solved_with_the_forces(opened):
    """In the golfer's tube, with dashpots. With the states as unknowns they took 16,981 evaluations."""
    problem = turning_problems()["F3"]
    more = {"friction": "elastic", "rolling": "elastic", "tangential_damping": 63.0, "rolling_damping": 0.063}
    more |= {"tangential_stiffness": 8e4, "rolling_stiffness": 80.0, "rolling_coefficient": 0.05}
    values = problem.start | {f"contact.{name}": value for name, value in more.items()}
    fmu = run(opened(problem.fmu), values, problem.stop, steps=1, tolerance=1e-9)
    assert fmu["solver.force_evaluations"] <= 12_000


LIMITS = {  # case of v_0, largest v_0
    "golfer's tube": (lambda v_0: cases.golfers_tube(v_0, turns=1.0), 1e-3),
    "turntable": (cases.turntable, 1e-3),
    "bowl": (lambda v_0: cases.bowl(v_0, 100 / v_0), 1e-3),
    "lying tube": (lambda v_0: cases.bowl(v_0, 100 / v_0, "cylinder"), 1e-3),
    "bowl, to and fro": (lambda v_0: cases.bowl(v_0, 100 / v_0, quarters=3, angle=1.4), 1e-3),
}


@pytest.mark.parametrize("name", LIMITS)
def test_rolling_is_approached_in_first_order_of_the_slip_velocity(opened, name):
    """Of v_0 alone, or of v_0 and 1/p_n alike."""
    made, largest = LIMITS[name]
    errors = []
    for v_0 in (largest, largest / 2, largest / 1024):
        case = made(v_0)
        error = ended(opened, case)["source.position"] - case.expected["source.position"]
        errors.append(float(np.linalg.norm(error)))
    check_relative("order 1", errors[0] / errors[1], 2.0, 0.02)
    check_relative("order 1, far", errors[0] / errors[2], 1024.0, 0.05)


@pytest.mark.parametrize("mu", [0.11, 0.5, 5.0])
def test_an_impact_on_springs_with_two_sevenths_turns_the_slip_round(opened, method, mu):
    """v_c = 0.707 m/s sticks throughout where it is at most 7/2 mu v_n = 7 mu."""
    case = cases.oblique_impact(mu=mu)
    agrees(ended(opened, case, method, 1e-12), case, 1e-10 if method == "event_driven" else 1e-8)


@pytest.mark.parametrize("factor", [1.0, 100.0])
def test_balls_with_opposite_spins_do_not_rub(opened, factor):
    """Chung and Ooi 7. They yield by delta, and omega delta is slip: the change falls with p_n's root."""
    case = cases.opposite_spin()
    fmu = ended(opened, case._replace(values={**case.values, "contact.penalty_factor": factor * 1e7}))
    agrees(fmu, case, 5e-5 / math.sqrt(factor))


@pytest.mark.parametrize("friction", ["regularized", "elastic"])
def test_no_torque_and_no_change_without_a_coefficient(opened, method, friction):
    case = cases.slide_to_roll(1e-3, 2.0, -30.0)
    none = {"contact.friction_coefficient": 0.0, "contact.static_friction_coefficient": 0.0}
    fmu = ended(opened, case._replace(values=case.values | none | {"contact.friction": friction}), method)
    check_close("velocity", fmu["source.velocity"][:2], [2.0, 0.0], 0.0)
    check_close("spin", fmu["source.angular_velocity"], [0.0, -30.0, 0.0], 0.0)
    check_close("torque", fmu["contact.source_torque"], [0.0, 0.0, 0.0], 0.0)
    check_close("energy.friction", fmu["energy.friction"], 0.0, 0.0)


def test_a_contact_without_spring_and_dashpot_does_not_rub(opened, method):
    """A slip that reverses ends no sliding where there is no normal force."""
    values = {"contact.penalty_control": "viscous_only", "contact.viscous_penalty_factor": 0.0}
    values |= {"contact.friction": "elastic", "source.center": [0.0, 0.0, 0.1], "source.rotation": "free"}
    values |= {"source.initial_velocity": [0.4, 0.0, -0.6], "source.external_force": [-20.0, 0.0, 9.81]}
    fmu = run(opened("SpherePlane"), values, 0.05, 1, 1e-9, method)
    check_close("velocity", fmu["source.velocity"], [-0.6, 0.0, -0.6], 1e-9)


def test_a_slip_that_is_rounding_sticks_at_the_touch(opened, method):
    """Under Hertz's law it ends 1e-20 s after the touch."""
    values = {"contact.law": "hertz", "contact.hertz_stiffness": 1e5, "contact.tangential_stiffness": 3e3}
    values |= {"contact.friction": "elastic", "source.rotation": "free", "source.center": [0.0, 0.0, 0.601]}
    values |= {"source.initial_velocity": [1e-9, 0.0, -1.0], "destination.axis": [1.0, 0.0, 0.0]}
    fmu = run(opened("SphereCylinder"), values, 0.1, 1, 1e-10, method)
    check_close("velocity", fmu["source.velocity"][:2], [0.0, 0.0], 1e-8)


def test_an_impact_that_tips_a_cylinder_takes_one_step(opened):
    """Orientations follow the forces in the same iteration; one behind, longer attempts do not converge."""
    fmu = run(opened("TippingRoller"), {}, 1.0, 1, 1e-9)
    assert fmu["contact.onsets"] == 1
    assert (fmu["solver.steps"], fmu["solver.rejected_steps"]) == (1, 0)


def test_a_cylinder_tumbles_as_the_closed_form_says(opened):
    """1,000 turns of its angular momentum, in one step and in many."""
    for steps in (1, 13):
        case = cases.rotor(2000 * math.pi / 6.0)
        fmu = ended(opened, case, steps=steps)
        q, right = fmu["destination.orientation"], case.expected["destination.orientation"]
        check_close("orientation", q * np.sign(q @ right), right, 1e-12)
        # An angle of 6,283 rad is a multiple of 9.1e-13 rad; two such roundings are allowed.
        for name, allowed in (("current_axis", 1.9e-12), ("angular_velocity", 13e-12)):
            check_close(name, fmu[f"destination.{name}"], case.expected[f"destination.{name}"], allowed)


@pytest.mark.parametrize("mu", [0.0, 2.0, 20.0, 200.0])
def test_a_ball_leaves_a_sphere_at_ten_seventeenths_or_two_thirds(opened, mu):
    """Rolling to the end needs ever more friction as the force ends: the error falls with mu."""
    case = cases.leaving(1e8, mu)
    fmu = ended(opened, case)
    assert fmu["contact.onsets"] == 1
    found = cases.left_at(fmu, case.end)
    check_close("cosine", found, case.expected["cosine"], 1e-6 + (0.05 / mu if mu else 0.0))


@pytest.mark.parametrize("friction, count", [("regularized", 100), ("elastic", 1000)])
def test_a_free_pair_keeps_its_momenta_over_many_impacts(opened, friction, count):
    case = cases.shell(friction)
    fmu = opened(FMU["sphere"])
    start(fmu, case.values, 1e-10)
    before, energy = cases.momenta(fmu, case.values), fmu["energy.total"]
    while fmu["contact.onsets"] < count and fmu.time < 2000.0:
        fmu.step(case.end / 10)
    assert fmu["contact.onsets"] >= count
    # Of the bodies' own: 1 kg at 7 m/s, half a metre off the middle.
    after = cases.momenta(fmu, case.values)
    check_close("momentum", after[0], before[0], 1e-12 * 7.0)
    check_close("angular momentum", after[1], before[1], 1e-12 * 3.5)
    check_relative("energy", fmu["energy.total"], energy, 1e-9)


def test_a_slow_push_on_a_body_that_turns_freely_has_its_impulse(opened):
    """F_n = k_h (v t)^(3/2): no free body shows the impulse, and the energies are below the tolerance."""
    fmu, z = opened("SpherePlane"), np.array([0.0, 0.0, 1.0])
    values = {"source.motion": "prescribed", "source.rotation": "free", "contact.method": "penalty"}
    values |= {"contact.friction": "none", "contact.law": "hertz", "contact.hertz_stiffness": 1e-3}
    values |= {"source.radius": 5.0, "source.center": 5.0 * z, "source.prescribed_velocity": -1e-6 * z}
    start(fmu, values, 1e-10)
    fmu.set_derivative("source.prescribed_displacement", -1e-6 * z)
    impulse = sum((fmu.step(step), step * fmu["contact.mean_force"][2])[1] for step in (450.0, 550.0))
    check_relative("impulse", impulse, 1e-12 * 1000.0**2.5 / 2.5, 1e-7)
