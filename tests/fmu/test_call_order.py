"""Every function in every state of the standard: allowed calls work, others are refused as a whole."""

from ctypes import c_double, c_uint, c_void_p

import pytest

from support.caller import Caller, nothing
from support.fmi2 import call_table as table
from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, MODEL_EXCHANGE, OK, array
from support.fmi2.states import NAMES, bring_to

# What an allowed call returns where that is not fmi2OK: no such status or derivative is provided, and what
# was too much for one internal step still is.
ANSWERS = {"GetIntegerStatus": DISCARD, "GetStringStatus": DISCARD, ("DoStep", "failed"): DISCARD}


def faults_in(fmu: raw.Fmu, state: str) -> list[str]:
    faults = []
    for function in table.FUNCTIONS:
        if function != "FreeInstance":
            with raw.Instance(fmu) as instance:
                bring_to(instance, state)
                caller, answer = Caller(instance), ANSWERS.get(function, OK)
                where = f"in phase {NAMES[state]}"
                if function in table.EXCHANGE:
                    where = "on an instance of Co-Simulation, allowed: of Model Exchange"
                right = ANSWERS.get((function, state), answer)
                faults.append(caller.fault(function, table.allowed(function, state), where, right))
                caller.end()
    return [fault for fault in faults if fault]


@pytest.mark.parametrize("state", [state for state in table.STATES if state not in ("start", "failed")])
def test_every_function_in_every_state(fmu, state):
    assert faults_in(fmu, state) == []


# What event_driven could not finish in one internal step it finishes in the next.
@pytest.mark.parametrize("scene", [scene for scene in raw.SOLVER_SCENES if scene not in raw.WITHOUT_CVODE])
def test_every_function_after_a_discarded_step(scene):
    assert faults_in(raw.load(scene), "failed") == []


@pytest.mark.parametrize("state", table.EXCHANGE_STATES)
def test_every_function_of_model_exchange_in_every_state(fmu, state):
    faults = []
    calls = [("SetupExperiment", 0, 0.0, 0.0, 0, 0.0), ("EnterInitializationMode",)]
    calls += [("ExitInitializationMode",), ("EnterContinuousTimeMode",), ("Terminate",)]
    first = {"instantiated": 0, "initialization": 2}.get(state, table.EXCHANGE_STATES.index(state) + 1)
    for function, marks in table.IN_EXCHANGE.items():
        with raw.Instance(fmu, kind=MODEL_EXCHANGE) as instance:
            for call in calls[:first] or calls[: function == "EnterInitializationMode"]:
                instance.ok(*call)
            where = (
                "on an instance of Model Exchange"
                if function in table.FOREIGN
                else f"in phase {NAMES[state]}"
            )
            faults.append(Caller(instance).fault(function, marks[state], where))
    assert [fault for fault in faults if fault] == []


def test_no_function_crashes_without_an_instance(fmu):
    statuses = {
        function: getattr(fmu.library, function)(*map(nothing, arguments))
        for function, arguments in raw.ARGUMENTS.items()
        if arguments and arguments[0] is c_void_p
    }
    assert statuses.pop("fmi2FreeInstance") is None
    assert statuses == dict.fromkeys(statuses, ERROR)


def test_versions_need_no_instance(fmu):
    assert fmu.library.fmi2GetVersion() == b"2.0"
    assert fmu.library.fmi2GetTypesPlatform() == b"default"


def test_the_table_names_every_function():
    without_instance = {"fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate"}
    assert {f"fmi2{function}" for function in table.FUNCTIONS} | without_instance == set(raw.ARGUMENTS)


def test_a_refused_call_does_not_end_the_run(fmu):
    with raw.Instance(fmu) as good, raw.Instance(fmu) as disturbed:
        for instance in (good, disturbed):
            instance.initialize()
        modes = [f"{verb}InitializationMode" for verb in ("Enter", "Exit")]
        for function in ("SetupExperiment", *modes, "CancelStep"):
            assert Caller(disturbed).call(function) == ERROR
        assert good.run([0.1] * 5) == disturbed.run([0.1] * 5)


def test_initialization_needs_an_experiment(instance):
    expected = instance.expect(ERROR, "fmi2EnterInitializationMode", "before fmi2SetupExperiment")
    expected(instance.call("EnterInitializationMode"))
    instance.initialize()


def test_start_values_can_be_read_at_once_and_outputs_cannot(every_fmu):
    with raw.Instance(every_fmu) as instance:
        for variable in every_fmu.select("parameter", "input"):
            assert instance.get_one(variable) == variable.start_value, variable.name
        gap = every_fmu.variables["contact.gap"]
        expected = instance.expect(ERROR, "fmi2GetReal", "contact.gap", "before initialization mode")
        expected(instance.call("GetReal", array(c_uint, [gap.reference]), 1, array(c_double, [0])))


def test_outputs_are_there_in_initialization_mode(instance):
    instance.enter_initialization({"source.center": [0.9, 0.0, 0.3]})
    first = instance.get("contact.gap")
    instance.set({"source.center": [0.8, 0.0, 0.2]})
    assert instance.get("contact.gap") != first
    instance.ok("ExitInitializationMode")


def test_parameters_are_fixed_after_initialization_unless_they_are_tunable(every_fmu):
    with raw.Instance(every_fmu) as instance:
        instance.initialize()
        before = instance.bits()
        for variable in every_fmu.select("parameter"):
            if variable.variability == "tunable":
                assert instance.set_one(variable, variable.start_value) == OK
                continue
            expected = instance.expect(ERROR, variable.name, "fixed after initialization")
            expected(instance.set_one(variable, variable.start_value))
        assert instance.bits() == before


def test_what_is_calculated_cannot_be_set(every_fmu):
    with raw.Instance(every_fmu) as instance:
        for variable in every_fmu.select("output", "calculatedParameter"):
            instance.expect(ERROR, variable.name, "cannot be set")(instance.set_one(variable, 0))
        instance.initialize()
        for variable in every_fmu.select("output", "calculatedParameter"):
            instance.expect(ERROR, variable.name, "cannot be set")(instance.set_one(variable, 0))
