"""Resistance to rolling and spinning: closed forms, an independent integration, momenta, every interface."""

import math

import numpy as np
import pytest

from support.checks import METHODS, by_methods, check_close, check_relative, run, start
from support.exchange_runs import check_exchange
from support.fmi3 import raw
from support.reference.turning import follow
from support.scenes import turning_cases as cases
from support.scenes.agreement import seeds
from support.scenes.scene_checks import FMU
from support.scenes.turning_checks import failures
from support.scenes.turning_scenes import FRICTIONS, PLACES, driven_scene, random_turning_scene, resistance

# The reference begins sliding without a dashpot from free bodies only.
DRIVEN = [
    seed
    for seed in range(len(PLACES) * len(FRICTIONS))
    if FRICTIONS[seed // len(PLACES)] not in ("elastic", "elastic, static")
]
G, RADIUS, MU = 9.81, 0.1, 0.05
BOTH = {f"contact.{kind}": "regularized" for kind in ("rolling", "spinning")}
YIELDING = {
    f"contact.{kind}{name}": value
    for kind in ("rolling", "spinning")
    for name, value in (("", "elastic"), ("_coefficient", 0.1), ("_stiffness", 5.0), ("_damping", 0.02))
}
BALL = {
    "source.rotation": "free",
    "source.center": [0.0, 0.0, RADIUS - G / 1e6],  # lies on its spring
    **BOTH, "contact.rolling_coefficient": MU, "contact.spinning_coefficient": MU,
}  # fmt: skip
RUBS = {
    "regularized": {"contact.slip_velocity_control": "user_defined",
        "contact.characteristic_slip_velocity": 1e-7},
    "elastic": {"contact.tangential_damping": 500.0},
}  # fmt: skip
# The slip of regularized friction is 1e-7 m/s, which Adams' method cannot follow; springs yield by 1e-6 m.
ROLLS = [(rubs, method) for rubs in RUBS for method in METHODS]
ROLLS.remove(("regularized", METHODS[2]))


def way_of_rolling(opened, friction, method, rate, speed=1.0):
    """How far a ball rolls on a plane until it stops"""
    values = BALL | RUBS[friction]
    values |= {"source.initial_velocity": [speed, 0.0, 0.0]}
    values |= {"source.initial_angular_velocity": [0.0, speed / RADIUS, 0.0], "contact.friction": friction}
    values |= {"contact.characteristic_rolling_rate": rate}
    fmu = run(opened("SpherePlane"), values, 8.0, 3, 1e-10, method)
    assert np.linalg.norm(fmu["source.velocity"]) < 1e-6
    check_close("energy balance", fmu["energy.total"], fmu["energy.potential"] + fmu["energy.friction"], 1e-4)
    return fmu["source.position"][0]


@pytest.mark.parametrize("friction, method", ROLLS)
def test_a_ball_that_rolls_stops_where_the_closed_form_says(opened, friction, method):
    """Without slip (7/5) m r^2 omega' = -mu r m g (1 - exp(-omega/omega_0)), so that the way is
    7/(5 mu g) (v^2/2 + (pi r omega_0)^2/6) where the start is far above omega_0."""
    coulomb = 7 / (10 * MU * G)
    for rate in (1e-3, 0.5):
        more = 7 / (5 * MU * G) * (math.pi * RADIUS * rate) ** 2 / 6
        way = way_of_rolling(opened, friction, method, rate)
        check_close("way", way, coulomb + more, 2e-6)
        assert way - coulomb < RADIUS * rate


def test_a_ball_that_spins_slows_down_at_a_constant_rate(opened, method):
    """By a = 5 mu g/(2 r), and near rest by u' = -a (1 - exp(-u/omega_0)), which has a closed form."""
    first, rate, a = 40.0, 1e-2, 5 * MU * G / (2 * RADIUS)
    values = BALL | {
        "source.initial_angular_velocity": [0.0, 0.0, first],
        "contact.characteristic_spinning_rate": rate,
    }
    for end in (1.0, first / a - 1e-3, first / a + 2e-3):
        left = (first - a * end) / rate
        expected = rate * (left + math.log1p(math.exp(-left)) if left > 0 else math.log1p(math.exp(left)))
        fmu = run(opened("SpherePlane"), values, end, 2, 1e-10, method)
        check_close("spin", fmu["source.angular_velocity"], [0.0, 0.0, expected], 1e-7)
        check_close("spinning_rate", fmu["contact.spinning_rate"], -expected, 1e-7)
        lost = 0.5 * 0.4 * RADIUS**2 * (first**2 - expected**2)
        check_relative("energy.friction", fmu["energy.friction"], lost, 1e-9)


# The last one ends while a spring of rolling relaxes without a normal force.
@pytest.mark.parametrize("law", ["regularized", "elastic"])
@pytest.mark.parametrize("seed", [*seeds(30), 7033])
def test_a_scene_goes_as_the_reference_says(opened, seed, law):
    scene = random_turning_scene(seed)
    values = scene.values | resistance(np.random.default_rng([27, seed]), law)
    right = follow(values, scene.shape, scene.end)
    run_of = (opened(FMU[scene.shape]), values, scene.end, scene.steps)
    wrong = by_methods(lambda method: failures(*run_of, method, right))
    assert not wrong, f"{wrong}\n{scene}"


def test_the_elastic_scenes_stick_and_slide():
    """Each motion breaks away and sticks again in some of the first scenes."""
    seen = set()
    for seed in range(12):
        scene = random_turning_scene(seed)
        values = scene.values | resistance(np.random.default_rng([27, seed]), "elastic")
        seen |= set(follow(values, scene.shape, scene.end)["events"])
    assert {f"{kind} {does}" for kind in ("rolling", "spinning") for does in ("sticks", "slips")} <= seen


@pytest.mark.parametrize("law", ["regularized", "elastic"])
@pytest.mark.parametrize("seed", DRIVEN)
def test_a_given_motion_has_the_torques_that_the_reference_says(opened, seed, law):
    """In every other one rolling and spinning pass zero; in 27 they do so at a node of the quadrature."""
    shape, values, end, _ = driven_scene(seed)
    values |= resistance(np.random.default_rng([28, seed]), law)
    if seed % 2:
        name = "source.prescribed_angular_velocity"
        values[f"{name}.derivatives"] = [(-2.0 / end * np.array(values[name])).tolist()]
    lines = failures(opened(FMU[shape]), values, end, 1, "event_driven", follow(values, shape, end))
    assert not lines, f"{lines}\n{values}"


IN_A_SHELL = BALL | {"source.center": [0.25, 0.0, -0.3122]}
IN_A_SHELL |= {"source.initial_angular_velocity": [3.0, -20.0, 8.0], "destination.radius": 0.5}
IN_A_SHELL |= {"contact.location": "inside", "contact.penalty_factor": 1e5, "contact.friction": "regularized"}
IN_A_SHELL |= {"contact.slip_velocity_control": "user_defined", "contact.characteristic_slip_velocity": 1e-2}
IN_A_SHELL |= {"contact.characteristic_rolling_rate": 2e-2, "contact.characteristic_spinning_rate": 2e-2}


def test_a_ball_that_swings_to_rest_passes_every_standstill(opened, shape):
    """In a hollow sphere and in a lying tube: it turns back several times, and stops spinning."""
    values = IN_A_SHELL | ({"destination.axis": [0.0, 1.0, 0.0]} if shape == "cylinder" else {})
    lines = failures(opened(FMU[shape]), values, 1.5, 4, "event_driven", follow(values, shape, 1.5))
    assert not lines, lines


def test_a_torque_that_turns_nobody_is_right(opened):
    """Of two spheres that do not turn: nothing but the mean torque feels the torque of the resistance."""
    values = {"source.rotation": "prescribed", "source.radius": 0.7, "source.mass": 2e4, "gravity": [0.0] * 3}
    values |= {"source.center": [0.0, 0.0, 1.2], "source.initial_velocity": [0.4, 0.0, -0.6]}
    values |= {"contact.penalty_factor": 3e7, "contact.viscous_penalty_factor": 5e4}
    values |= {"contact.friction": "regularized", "contact.rolling": "regularized"}
    means = []
    for steps in (1, 40):
        fmu, torque = start(opened("SphereSphere"), values, 1e-10), "contact.mean_source_torque"
        means.append(sum((fmu.step(0.2 / steps), fmu[torque] / steps)[1] for _ in range(steps)))
    check_relative("mean torque", means[0], means[1], 1e-9)


def test_a_grain_that_may_turn_bounces_in_a_few_steps(opened):
    """The torque of a force through its centre is rounding, and so is its spin, 1e-12 rad/s."""
    values = BOTH | {"source.rotation": "free", "contact.friction": "none", "contact.method": "penalty"}
    values |= {"source.radius": 1e-5, "source.mass": 1e-11, "source.center": [4.8e-6, 3.6e-6, 8e-6]}
    values |= {"source.initial_velocity": [6.0, 0.0, -8.0], "destination.axis": [0.48, 0.36, 0.8]}
    values |= {"gravity": [0.0, 0.0, 0.0], "solver.absolute_tolerance": 1e-15}
    fmu = run(opened("SpherePlane"), values, 3e-8, 1, 1e-8)
    check_close("velocity", fmu["source.velocity"], [9.3792, 2.5344, -2.368], 1e-7)
    assert fmu["solver.steps"] < 20


@pytest.mark.parametrize("resistance", [BOTH, YIELDING], ids=["regularized", "elastic"])
@pytest.mark.parametrize("friction", ["none", "regularized", "elastic"])
def test_a_free_pair_keeps_its_momenta(opened, friction, resistance):
    case = cases.shell(friction)
    values = case.values | resistance
    values |= {"contact.rolling_coefficient": 0.1, "contact.spinning_coefficient": 0.3}
    fmu = start(opened(FMU["sphere"]), values, 1e-10)
    before, energy = cases.momenta(fmu, values), fmu["energy.total"]
    while fmu["contact.onsets"] < 50:
        fmu.step(case.end / 40)
    after = cases.momenta(fmu, values)
    check_close("momentum", after[0], before[0], 1e-12 * 7.0)
    check_close("angular momentum", after[1], before[1], 1e-12 * 3.5)
    check_relative("energy", fmu["energy.total"], energy, 1e-9)


EXCHANGED = {
    "SpherePlane": BALL | {"source.initial_velocity": [0.5, 0.0, 0.0],
        "source.initial_angular_velocity": [0.0, 5.0, 3.0], "contact.friction": "elastic",
        "contact.tangential_damping": 100.0},
    "SphereSphere": IN_A_SHELL,
    "CylinderCylinder": {"source.rotation": "free", "source.center": [0.1, 0.0, 0.5916],
        "source.initial_angular_velocity": [0.0, 9.0, 0.0], "contact.penalty_factor": 1e5,
        "contact.rolling": "regularized", "contact.rolling_coefficient": 0.2},
    "SphereTorus": {"source.rotation": "free", "source.center": [1.02, 0.0, 0.5999],
        "source.initial_angular_velocity": [2.0, 9.0, 5.0], "contact.penalty_factor": 1e5, **BOTH,
        "contact.rolling_coefficient": 0.2},
}  # fmt: skip
EXCHANGED |= {  # name of a case: its values, by which the scene is known
    f"{scene}, elastic": EXCHANGED[scene]
    | {name: value for name, value in YIELDING.items() if scene != "CylinderCylinder" or "spin" not in name}
    | ({"contact.rolling_damping": 0.0, "contact.rolling_coefficient": 0.5} if scene == "SpherePlane" else {})
    for scene in list(EXCHANGED)
}
EXCHANGED["SpherePlane, clipped"] = {  # falls back before it has left the plane
    "source.rotation": "free", "source.center": [0.0, 0.0, 0.1], "source.initial_velocity": [1.0, 0.0, -0.4],
    "contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 60.0, "contact.friction": "elastic",
    "contact.tangential_stiffness": 2e3, "contact.tangential_damping": 40.0,
}  # fmt: skip
SEEN = ["source.position", "source.velocity", "source.angular_velocity"]


@pytest.mark.parametrize("case", EXCHANGED)
def test_model_exchange_and_fmi_3_agree_with_co_simulation(opened, case):
    """CVODE of fmpy moves both Model Exchange FMUs; Co-Simulation of FMI 3.0 has the same bits."""
    scene, values, end = case.partition(",")[0], EXCHANGED[case], 0.3
    fmu = run(opened(scene), values, end, 1, 1e-10)
    assert fmu["energy.friction"] > 1e-4
    with raw.Instance(raw.load(scene)) as third:
        third.initialize(values, 1e-10)
        assert third.step(0.0, end).status == raw.OK
        for name in [*SEEN, "contact.rolling_torque", "contact.rolling_rate", "energy.friction"]:
            assert np.array_equal(third.get(name), fmu[name]), name
    check_exchange(fmu, scene, values, end, SEEN)


def test_no_resistance_where_nothing_turns(opened):
    """Without a body that turns both choices change no bit."""
    ends = []
    for more in ({}, BOTH, YIELDING):
        fmu = run(opened("SphereSphere"), {"source.center": [0.03, 0.0, 0.62]} | more, 0.3)
        ends.append([fmu[name].tobytes() for name in SEEN[:2]] + [fmu["solver.steps"]])
    assert ends[0] == ends[1] == ends[2]


def test_a_force_that_comes_back_finds_springs_at_rest(opened, method):
    """A dashpot alone presses a ball that hardly spins; its factor is zero for a while."""
    values = {"source.motion": "prescribed", "source.rotation": "free", "source.center": [0.0, 0.0, 0.09]}
    values |= {"source.prescribed_displacement.derivatives": [[0.0, 0.0, -0.1]], "gravity": [0.0, 0.0, 0.0]}
    values |= {"source.prescribed_velocity": [0.0, 0.0, -0.1], "contact.penalty_control": "viscous_only"}
    values |= {"source.initial_angular_velocity": [0.0, 0.0, 1e-12], "contact.viscous_penalty_factor": 1e3}
    values |= YIELDING | {"contact.spinning_damping": 0.0, "contact.dashpot": "unclamped"}
    fmu = start(opened("SpherePlane"), values, 1e-10, method)
    for factor in (0.0, 1e3, 1e3):
        fmu.step(0.1)
        fmu["contact.viscous_penalty_factor"] = factor
    assert fmu["contact.normal_force"] == pytest.approx(100.0)
    assert np.linalg.norm(fmu["source.angular_velocity"]) < 1e-9
