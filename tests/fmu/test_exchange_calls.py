"""Model Exchange call by call: order, bad input, inputs that move bodies, states saved, derivatives."""

import numpy as np
import pytest

from support.checks import check_close
from support.fmi2 import raw
from support.fmi2.jacobian import jacobian
from support.fmi2.raw import ERROR, MODEL_EXCHANGE, OK, SCENES
from support.outside import Outside
from support.reference.integrator import TunedMotion


def begun(scene: str = "SphereSphere", values: dict | None = None, inputs=lambda _: {}):
    instance = raw.Instance(raw.load(scene), kind=MODEL_EXCHANGE)
    instance.initialize(values)
    return Outside(instance, inputs).begin()


def wall(time: float) -> dict:
    return {
        "destination.prescribed_displacement": [0.0, 0.0, time],
        "destination.prescribed_velocity": [0.0, 0.0, 1.0],
    }


def test_a_wall_that_inputs_move_does_work():
    """From an elastic wall of 1 m/s the ball leaves with 2 m/s: 2 J, all of it external work."""
    start = {"destination.motion": "prescribed", "gravity": [0.0, 0.0, 0.0], "source.center": [0.0, 0.0, 0.7]}
    start |= {"contact.method": "penalty", "contact.penalty_factor": 1e5}
    outside = begun("SphereSphere", start, wall)
    outside.run(0.2, 1e-4)
    get = outside.instance.get
    assert get("source.velocity") == pytest.approx([0.0, 0.0, 2.0], abs=1e-7)
    assert get("energy.external_work") == pytest.approx(2.0, abs=1e-7)
    assert get("energy.total") == pytest.approx(0.0, abs=1e-7)
    assert get("solver.events") == 2
    assert get("contact.onsets") == 1
    assert get("contact.last_onset_time") == pytest.approx(0.1, abs=1e-12)
    assert get("contact.last_duration") == pytest.approx(np.pi * np.sqrt(1.0 / 1e5), abs=1e-7)


def test_a_force_element_is_a_function_of_its_inputs():
    poses = [(0.58, -0.3), (0.61, 0.2), (0.59, 0.4)]
    with raw.Instance(raw.load("ForceElement")) as stepping:
        stepping.initialize({"source.center": [0.0, 0.0, 0.0]})
        outside = begun("ForceElement", {"source.center": [0.0, 0.0, 0.0]})
        for time, (place, speed) in enumerate(poses, 1):
            pose = {
                "source.prescribed_displacement": [place, 0.0, 0.0],
                "source.prescribed_velocity": [speed, 0.0, 0.0],
            }
            outside.instance.ok("SetTime", float(time))
            for instance in (stepping, outside.instance):
                instance.set(pose)
            assert stepping.bits("output") == outside.instance.bits("output")
        assert outside.states().size == outside.indicators().size == 0


CAP = {"source.center": [0.0, 0.34, 0.2], "source.radius": 0.05, "gravity": [0.0, 0.0, 0.0]}
CAP |= {"destination.finite_length": True, "destination.ends": "capped", "destination.length": 0.6}
CAP |= {"destination.radius": 0.3, "destination.axis": [0.0, 0.0, 1.0], "contact.penalty_factor": 1e4}


@pytest.mark.parametrize("scene, start, moved, velocity", [
    ("CrossedRollers", {"source.center": [0.0, 0.0, 0.049]}, [-0.2 - 1e-6, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ("SphereCylinder", CAP, [0.1786, -0.0648, 0.1079], [-0.56, 0.051, -0.686]),
])  # fmt: skip
def test_a_source_that_is_put_beyond_an_edge_takes_the_zone_there(scene, start, moved, velocity):
    """The event iteration ends also where the source moves back towards the zone that it has left."""
    outside = begun(scene, start)
    put = {f"source.displacement_state[{k}]": place for k, place in enumerate(moved, 1)}
    put |= {f"source.velocity_state[{k}]": speed for k, speed in enumerate(velocity, 1)}
    names = outside.instance.fmu.roles["state"]
    outside.put(0.0, np.array([put.get(*one) for one in zip(names, outside.states(), strict=True)]))
    outside.event()
    assert outside.instance.get("solver.events") == 1


@pytest.mark.parametrize("axis", [[0.0, 0.0, 1.0], [0.3, 1.0, 0.2]])
def test_directional_derivatives_are_those_of_differences(dashpot, axis):
    """Of outputs and rates with respect to states and inputs, in contact, one body free and one led."""
    start = {"destination.motion": "free", "source.center": [0.4, 0.3, 0.25]}
    start |= {"source.initial_velocity": [-0.3, 0.1, -0.2], "destination.axis": axis}
    start |= {"contact.location": "outside", "contact.dashpot": dashpot, "contact.penalty_factor": 1e3}
    outside = begun("SphereCylinder", start)
    instance, fmu = outside.instance, outside.instance.fmu
    states = [fmu.variables[name] for name in fmu.roles["state"]]
    forces = [one for one in fmu.select("input", kind="Real") if "external_force" in one.name]
    rates = [fmu.variables[name] for name in fmu.roles["rate"]]
    outputs = [one for one in fmu.select("output", kind="Real") if "last" not in one.name]
    assert instance.get("contact.active") == 1
    here = outside.states()
    given = jacobian(instance, rates + outputs, states + forces)
    step = 1e-5

    def at(k: int, by: float) -> list[float]:
        moved = here.copy()
        if k < len(states):
            moved[k] += by
        else:
            instance.set({forces[k - len(states)].name: by})
        outside.put(0.0, moved)
        values = [instance.get_one(one) for one in rates + outputs]
        if k >= len(states):
            instance.set({forces[k - len(states)].name: 0.0})
        return np.array(values)

    for k, known in enumerate(states + forces):
        expected = (at(k, step) - at(k, -step)) / (2 * step)
        size = 1e-6 * np.max(np.abs(expected)) + 1e-6
        wrong = np.flatnonzero(np.abs(given[:, k] - expected) > size)
        assert [(rates + outputs)[i].name for i in wrong] == [], known.name


# The next tests change tunable parameters of FMI 2.0: in Model Exchange in event mode, else between steps.

TUNABLE = ("penalty_factor", "viscous_penalty_factor", "gravity", "dashpot", "absolute_tolerance")
LAW = {"contact.penalty_factor": 1e5, "contact.viscous_penalty_factor": 60.0, "gravity": [0.0, 0.0, -9.81]}
CHANGES = {
    1e-3: {"gravity": [0.3, 0.0, -40.0]},
    4e-3: {"contact.penalty_factor": 3e5},
    7e-3: {"contact.viscous_penalty_factor": 700.0},  # it would pull
    8e-3: {"contact.dashpot": "approach_only", "contact.penalty_factor": 1e5},
}


def tunable(fmu):
    names = [one.name for one in fmu.select("parameter") if one.name.partition("[")[0].endswith(TUNABLE)]
    assert names
    return [fmu.variables[name] for name in names]


@pytest.mark.parametrize("scene", SCENES)
def test_continuous_time_mode_refuses_them_and_names_event_mode(scene):
    with raw.Instance(raw.load(scene), kind=MODEL_EXCHANGE) as instance:
        instance.initialize()
        reals = [one for one in tunable(instance.fmu) if one.type == "Real"]
        for variable in reals:
            assert instance.set_one(variable, variable.start_value) == OK
        instance.ok("EnterContinuousTimeMode")
        for variable in reals:
            refused = instance.expect(ERROR, variable.name, "tunable parameter", "event mode")
            refused(instance.set_one(variable, variable.start_value))


def test_they_are_parameters_like_others_while_it_is_set_up_and_none_when_it_is_over():
    with raw.Instance(raw.load("SphereSphere")) as instance:
        one = instance.fmu.variables["contact.penalty_factor"]
        assert instance.set_one(one, 1e5) == OK
        instance.initialize()
        assert instance.set_one(one, 2e5) == OK
        instance.ok("Terminate")
        assert instance.set_one(one, 3e5) == ERROR
        assert instance.get("contact.penalty_factor") == 2e5
        instance.ok("Reset")
        assert instance.get("contact.penalty_factor") == one.start_value


def test_an_integrator_outside_goes_on_with_them_and_is_told_of_the_work():
    position, velocity = [0.02, 0.01, 0.6015], [0.1, 0.0, -1.0]
    motion = TunedMotion({**LAW, "contact.dashpot": "non_adhesive"}, position, velocity)
    with raw.Instance(raw.load("SphereSphere"), kind=MODEL_EXCHANGE) as instance:
        instance.initialize({"source.center": position, "source.initial_velocity": velocity, **LAW})
        outside = Outside(instance).begin()
        for time, changes in CHANGES.items():
            outside.run(time, 5e-5)
            instance.ok("EnterEventMode")
            instance.set(changes)
            motion.run(time)
            before = motion.external_work
            motion.change(changes)
            assert outside.update() == (motion.external_work != before)  # a state has jumped
            instance.ok("EnterContinuousTimeMode")
            check_close("work", instance.get("energy.external_work"), motion.external_work, 1e-6)
        outside.run(0.02, 5e-5)
        motion.run(0.02)
        # m: steps of 5e-5 s of fourth order on a spring that swings with 550 rad/s at most, over 10 ms
        check_close("position", instance.get("source.position"), motion.position["source"], 1e-8)
        total = 0.5 * np.dot(velocity, velocity) + 9.81 * position[2]
        check_close("total", instance.get("energy.total"), total, 1e-6)
