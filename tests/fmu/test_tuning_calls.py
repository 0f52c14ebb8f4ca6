"""Tunable parameters of FMI 2.0: between steps in Co-Simulation, in event mode in Model Exchange."""

import numpy as np
import pytest

from support.checks import check_close
from support.fmi2 import raw
from support.fmi2.raw import ERROR, MODEL_EXCHANGE, OK, SCENES
from support.outside import Outside
from support.reference.integrator import TunedMotion

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
            with instance.expect(ERROR, variable.name, "tunable parameter", "event mode") as got:
                got(instance.set_one(variable, variable.start_value))


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
