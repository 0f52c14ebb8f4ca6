"""Model Exchange of FMI 3.0: fmpy's CVODE, and an integrator of our own, against references and FMI 2.0."""

import numpy as np
import pytest

from contact_fmus.bench.problems import benchmarks
from contact_fmus.fmu.files import fmu_file
from support.exchange_runs import simulate
from support.fmi2 import raw as raw2
from support.fmi3 import raw
from support.outside import Outside

MOTION = ["displacement", "velocity", "orientation", "angular_velocity"]
ENERGY = ["energy.total", "energy.dissipated", "solver.events"]


def components(name):
    return [f"{name}[{k}]" for k in (1, 2, 3)]


@pytest.mark.parametrize("name", ["P1", "P2", "P3", "P3b"])
def test_cvode_outside_reaches_the_references_by_the_steps_it_takes_with_fmi2(name):
    problem = benchmarks()[name]
    path = raw.FMUS / f"{problem.fmu}.fmu"
    third = simulate(path, problem.start, problem.stop, ["source.position", *ENERGY])
    assert problem.error(third["source.position"][-1]) < 1e-6
    assert np.ptp(third["energy.total"]) < 1e-6
    assert third["solver.events"][-1] >= 1
    names = [*components("source.position"), *ENERGY]
    second = simulate(fmu_file(problem.fmu), problem.start, problem.stop, names)
    for k, one in enumerate(components("source.position")):
        assert np.array_equal(third["source.position"][:, k], second[one]), one
    for one in ENERGY:
        assert np.array_equal(third[one], second[one]), one


# The pin's own contact is so stiff that an importer's integrator takes it for noise.
SOFT = {"contact.penalty_factor": 1e4, "contact.characteristic_slip_velocity": 1e-2}


@pytest.mark.parametrize("scene", raw.SCENES)
def test_every_scene_runs_to_its_end_as_in_co_simulation(scene):
    """Two integrators that share no code come to the same place; one scene goes on over a cylinder's end."""
    names = ["contact.gap", "contact.normal_force", "source.position", "energy.dissipated", "energy.total"]
    names = [name for name in names if name in raw.load(scene).variables]
    path, stop = raw.FMUS / f"{scene}.fmu", 0.8 if scene == "BallOffRoller" else 0.45
    start = SOFT if scene == "PinJoint" else {}
    outside, inside = (simulate(path, start, stop, names, kind) for kind in ("ModelExchange", "CoSimulation"))
    for name in names:
        size = np.max(np.abs(inside[name])) + 1e-3
        assert np.max(np.abs(outside[name][-1] - inside[name][-1])) < 1e-6 * size, name


TWO = {"destination.motion": "free", "destination.mass": 2.5, "gravity": [0.0, 0.0, 0.0]}
THROWN = {"source.initial_velocity": [0.0, 0.0, -1.0], "source.center": [0.0, 0.0, 0.61]}
THROWN |= {"contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 60.0}


@pytest.mark.parametrize("dashpot", ["none", "non_adhesive", "unclamped", "approach_only"])
def test_cvode_outside_keeps_momentum_and_closes_the_balance_and_bodies_come_to_rest(dashpot):
    start = THROWN | {"contact.dashpot": dashpot}
    if dashpot == "none":
        thrown = {"source.center": [0.1, 0.0, 1.1], "source.initial_velocity": [0.0, 0.0, -3.0]}
        start = TWO | thrown | {"contact.method": "penalty"}
    names = ["source.velocity", "destination.velocity", "contact.normal_force", "energy.kinetic", *ENERGY]
    made = simulate(raw.FMUS / "SphereSphere.fmu", start, 0.5 if dashpot == "none" else 1.5, names)
    # CVODE's own errors in two hundred steps of 1e-11 each of 4.5 J
    assert np.ptp(made["energy.total"]) < (1e-7 if dashpot == "none" else 1e-8)
    if dashpot == "none":
        momentum = made["source.velocity"][-1] + 2.5 * made["destination.velocity"][-1]
        assert np.allclose(momentum, [0.0, 0.0, -3.0], rtol=0.0, atol=1e-9)
        assert made["solver.events"][-1] == 2
        assert abs(made["energy.kinetic"][-1] - 4.5) < 1e-7  # nothing is lost
    else:
        assert made["energy.dissipated"][-1] > 0.5
        assert abs(made["contact.normal_force"][-1] - 9.81) < 1e-3


def moving(fmu, seed):
    """Inputs that change with time, of every vector that is an input"""
    random = np.random.default_rng(seed)
    size = {"displacement": 0.02, "velocity": 0.5, "force": 3.0, "torque": 0.1, "axis": 1.0}
    waves = {
        one.name: (size[one.name.rpartition("_")[2]] * random.uniform(-1.0, 1.0, 3), random.uniform(1.0, 9.0))
        for one in fmu.select("input")
    }
    rest = {name: [0.0, 0.0, 2.0] if name.endswith("_axis") else np.zeros(3) for name in waves}
    return lambda time: {
        name: (rest[name] + wave * np.sin(rate * time)).tolist() for name, (wave, rate) in waves.items()
    }


def values(instance, fmu3):
    """Bytes of all outputs and local variables, by the names of the arrays"""
    return {
        one.name: np.ravel(np.asarray(instance.get(one.name), float)).tobytes()
        for one in fmu3.select("output", "local", "calculatedParameter")
    }


STARTS = {
    "SphereSphere": {"destination.motion": "free", "destination.mass": 2.5, "source.center": [0.1, 0.0, 0.7]},
    "SphereCylinder": {"destination.motion": "prescribed", "source.center": [0.1, 0.0, 0.65],
        "destination.axis": [0.1, 1.0, 0.2], "contact.penalty_factor": 1e4},
    "PinJoint": SOFT,
}  # fmt: skip


@pytest.mark.parametrize("scene", raw.SCENES)
def test_a_loop_of_fixed_steps_gives_the_bits_of_fmi2(scene):
    """The same classical Runge-Kutta loop with events around both versions, inputs that move, each value of
    every output, state, rate and indicator at every step"""
    fmu3 = raw.load(scene)
    inputs = moving(fmu3, len(scene))
    start = STARTS.get(scene, {})
    with (
        raw2.Instance(raw2.load(scene), kind=raw2.MODEL_EXCHANGE) as second,
        raw.Instance(fmu3, exchange=True) as third,
    ):
        runs = [Outside(one.initialize(start), inputs).begin() for one in (second, third)]
        roles = [len(names) for names in fmu3.roles.values()]
        assert roles == [len(names) for names in raw2.load(scene).roles.values()]
        for k in range(40):
            for run in runs:
                run.step(2e-3) if roles[0] else run.feed(2e-3 * k)
            for read in (Outside.states, Outside.indicators):
                assert read(runs[0]).tobytes() == read(runs[1]).tobytes()
            assert values(second, fmu3) == values(third, fmu3)
        assert runs[0].time == runs[1].time


def test_arrays_are_the_states_and_their_rates():
    """A vector of the model is one state with one derivative, in the order of the state vector."""
    fmu = raw.load("SphereSphere")
    about = fmu.description
    states = [entry.variable.derivative.name for entry in about.derivatives]
    assert states == [
        *(f"{body}.{state}_state" for body in ("source", "destination") for state in MOTION),
        *(f"contact.{kind}spring_state" for kind in ("", "rolling_", "spinning_")),
        *("energy.dissipated_state", "energy.external_work_state", "energy.friction_state"),
    ]
    assert [fmu.variables[name].length for name in states] == [3, 3, 4, 3, 3, 3, 4, 3, 3, 3, 3, 1, 1, 1]
    with raw.Instance(fmu, exchange=True) as instance:
        start = {"destination.motion": "free", "source.initial_velocity": [1.0, 2.0, 3.0]}
        outside = Outside(instance.initialize(start)).begin()
        row = np.ravel(np.concatenate([np.ravel(instance.get(name)) for name in states]))
        assert outside.states().tobytes() == row.tobytes()
        rates = [entry.variable.name for entry in about.derivatives]
        row = np.concatenate([np.ravel(instance.get(name)) for name in rates])
        assert outside.read(instance.RATES).tobytes() == row.tobytes()
        indicators = [instance.get(entry.variable.name) for entry in about.eventIndicators]
        assert outside.indicators().tolist() == indicators
