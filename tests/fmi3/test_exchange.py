"""Model Exchange of FMI 3.0: fmpy's CVODE, and an integrator of our own, against references and FMI 2.0."""

import numpy as np
import pytest

from contact_fmus.bench.problems import benchmarks
from contact_fmus.fmu.files import fmu_file
from support.exchange_runs import simulate
from support.fmi2 import raw as raw2
from support.fmi3 import raw
from support.fmi3.raw import DISCARD, ERROR, OK
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
    return lambda t: {name: (rest[name] + a * np.sin(rate * t)).tolist() for name, (a, rate) in waves.items()}


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


# The tests from here on are of Model Exchange of FMI 3.0: they set states one by one, make inputs jump, ask
# for derivatives both ways, save states and pass the stop time.

CONTACT = {"destination.motion": "free", "source.center": [0.4, 0.3, 0.25]}
CONTACT |= {"source.initial_velocity": [-0.3, 0.1, -0.2], "contact.location": "outside"}
CONTACT |= {"contact.penalty_factor": 1e3}


def begun(scene="SphereSphere", values=None):
    return Outside(raw.Instance(raw.load(scene), exchange=True).initialize(values or CONTACT)).begin()


def test_a_state_set_by_its_name_is_that_of_the_vector():
    outside = begun()
    instance = outside.instance
    for event_mode in (False, True):
        if event_mode:
            instance.ok("EnterEventMode")
        for k, name in enumerate(("source.displacement_state", "destination.velocity_state")):
            value = [0.01 + k, -0.02, 0.03 + event_mode]
            instance.set({name: value})
            assert instance.get(name) == value
            row = outside.states()
            at = instance.fmu.roles["state"].index(f"{name}[1]")
            assert row[at : at + 3].tolist() == value
    assert instance.get("destination.velocity") == [1.01, -0.02, 1.03]


def test_what_events_may_change_is_set_between_events_only():
    outside = begun()
    instance = outside.instance
    instance.set({"energy.dissipated_state": 0.25})
    assert instance.get("energy.dissipated") == 0.25
    instance.ok("EnterEventMode")
    refused = instance.expect(ERROR, "energy.dissipated_state", "cannot be set")
    refused(instance.set_one("energy.dissipated_state", 0.5))
    assert outside.update() is False  # set by the importer, changed by no event


def test_a_refused_row_leaves_other_variables_alone():
    """All of it is checked before any is written: a good state beside a bad input"""
    with raw.Instance(raw.load("SphereSphere"), exchange=True) as instance:
        Outside(instance.initialize()).begin()
        chosen = [instance.fmu.variables[name] for name in ("source.velocity_state", "source.external_force")]
        before = instance.get("source.velocity_state")
        values = raw.reals([1.0, 2.0, 3.0, 0.0, np.nan, 0.0])
        refused = instance.expect(DISCARD, "source.external_force[2]")
        refused(instance.call("SetFloat64", raw.references(chosen), 2, values, 6))
        assert instance.get("source.velocity_state") == before
        assert instance.get("source.external_force") == [0.0, 0.0, 0.0]


def test_a_jump_of_an_input_in_event_mode_is_work_and_one_of_a_state():
    start = {"destination.motion": "prescribed", "gravity": [0.0, 0.0, 0.0], "source.center": [0.0, 0.0, 0.7]}
    start |= {"contact.method": "penalty", "contact.penalty_factor": 1e5}
    outside = begun(values=start)
    instance = outside.instance
    instance.ok("EnterEventMode")
    instance.set({"destination.prescribed_displacement": [0.0, 0.0, 0.11]})  # an overlap of 0.01 m
    assert outside.update()
    work = outside.states()[instance.fmu.roles["state"].index("energy.external_work_state")]
    assert work == pytest.approx(0.5 * 1e5 * 0.01**2, rel=1e-12)
    assert instance.get("contact.active")
    assert instance.get("energy.total") == pytest.approx(0.0, abs=1e-12)


def test_a_saved_state_goes_on_with_the_same_bits_in_its_mode():
    for event_mode in (False, True):
        start = {"source.center": [0.02, 0.0, 0.65], "source.initial_velocity": [0.0, 0.0, -1.0]}
        outside = begun(values=start)
        outside.run(0.042, 1e-3)
        assert outside.instance.get("contact.active")
        if event_mode:
            outside.instance.ok("EnterEventMode")
        blob, time = outside.instance.save(), outside.time
        found = []
        for _ in range(2):
            if event_mode:
                outside.update()
                outside.instance.ok("EnterContinuousTimeMode")
            outside.run(0.1, 1e-3)
            found.append((outside.states().tobytes(), outside.instance.bits("output", "local")))
            assert outside.instance.restore(blob) == OK
            outside.time = time
        assert found[0] == found[1]


def unknowns_and_knowns(fmu):
    rates = [fmu.variables[entry.variable.name] for entry in fmu.description.derivatives]
    states = [fmu.variables[entry.variable.derivative.name] for entry in fmu.description.derivatives]
    outputs = [one for one in fmu.select("output", kind="Float64") if "last" not in one.name]
    return rates + outputs, states + fmu.select("input")


def columns(arrays):
    return [one.reference + k for one in arrays for k in range(one.length)]


@pytest.mark.parametrize("event_mode", [False, True])
@pytest.mark.parametrize("scene", ["SphereSphere", "SphereCylinder", "BallInShell", "ForceElement"])
def test_derivatives_are_products_with_the_matrix_of_fmi2(scene, event_mode):
    """Rates and outputs by states and inputs: directional ones bit for bit, adjoint ones of one matrix"""
    fmu = raw.load(scene)
    start = {name: value for name, value in CONTACT.items() if name in fmu.variables}
    outside = begun(scene, start or {"source.center": [0.0, 0.0, 0.0]})
    unknowns, knowns = unknowns_and_knowns(fmu)
    random = np.random.default_rng(5)
    with raw2.Instance(raw2.load(scene), kind=raw2.MODEL_EXCHANGE) as second:
        Outside(second.initialize(start or {"source.center": [0.0, 0.0, 0.0]})).begin()
        if event_mode:
            for one in (second, outside.instance):
                one.ok("EnterEventMode")
        rows, width = columns(unknowns), len(columns(knowns))
        seeds = random.normal(size=width)
        given = outside.instance.product("Directional", unknowns, knowns, seeds)
        values = (raw2.c_double * len(rows))()
        second.ok(
            *("GetDirectionalDerivative", raw2.array(raw2.c_uint, rows), len(rows)),
            *(raw2.array(raw2.c_uint, columns(knowns)), width, raw2.array(raw2.c_double, seeds), values),
        )
        assert given.tobytes() == bytes(values)
    given = [outside.instance.product("Directional", unknowns, knowns, seeds) for seeds in np.eye(width)]
    matrix = np.array(given)
    left = random.normal(size=len(rows))
    allowed = 1e-13 * np.max(np.abs(matrix) @ np.abs(left)) + 1e-300
    adjoint = outside.instance.product("Adjoint", unknowns, knowns, left)
    assert np.allclose(adjoint, matrix @ left, rtol=0.0, atol=allowed)
    assert np.count_nonzero(matrix) > 10


def test_at_communication_points_rates_have_derivatives_too():
    """ContinuousStateDerivative of ModelStructure holds for Co-Simulation as well: the derivatives of an
    instance that steps are those of one which the importer moves there, but for the work of a step."""
    with raw.Instance(raw.load("SphereSphere")) as stepping:
        stepping.initialize({**CONTACT, "solver.method": "event_driven"})
        for k in range(3):
            assert stepping.step(1e-3 * k, 1e-3).status == OK
        assert stepping.get("contact.active")
        outside = begun()
        outside.instance.ok("SetTime", 3e-3)
        fmu = outside.instance.fmu
        unknowns, knowns = unknowns_and_knowns(fmu)
        names = [entry.variable.derivative.name for entry in fmu.description.derivatives]
        row = np.concatenate([np.ravel(stepping.get(name)) for name in names])
        outside.instance.ok("SetContinuousStates", raw.reals(row), len(row))
        unknowns = [one for one in unknowns if not one.name.startswith(("energy.external", "energy.total"))]
        seeds = np.random.default_rng(6).normal(size=len(columns(knowns)))
        inside = stepping.product("Directional", unknowns, knowns, seeds)
        wanted = outside.instance.product("Directional", unknowns, knowns, seeds)
        assert np.allclose(inside, wanted, rtol=1e-9, atol=1e-9 * np.max(np.abs(wanted)))


def test_a_step_past_the_stop_time_is_refused_and_looking_past_it_is_not():
    with raw.Instance(raw.load("SphereSphere"), exchange=True) as instance:
        outside = Outside(instance.initialize(stop=1.0)).begin()
        instance.ok("SetTime", 1.5)
        assert outside.indicators().shape == (len(instance.fmu.roles["indicator"]),)
        instance.ok("SetTime", 1.0)
        instance.complete_step()


def test_time_is_what_was_set():
    outside = begun()
    for time in (0.25, 0.125):
        outside.instance.ok("SetTime", time)
        assert outside.instance.get("time") == time


def test_a_state_that_jumps_by_less_than_another_one_rounds_is_told():
    """An overlap that is given stores 5e-10 J, booked as dissipated, beside external work of 1e9 J"""
    outside = begun("SphereSphere", CONTACT | {"source.center": [0.0, 0.0, 0.601]})
    instance = outside.instance
    instance.set({"source.displacement_state": [0.0, 0.0, -0.001001], "energy.external_work_state": 1e9})
    before = outside.states()
    instance.ok("EnterEventMode")
    jumped = outside.update()
    changed = not np.array_equal(outside.states(), before)
    assert instance.get("contact.active") and changed
    assert jumped == changed
