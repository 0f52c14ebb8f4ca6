"""Every function in every state of the standard: allowed calls work, others are refused as a whole."""

from ctypes import c_double, c_int, c_size_t, c_uint, c_void_p

import pytest

from support.fmi2 import raw
from support.fmi2.call_table import EXCHANGE, FUNCTIONS, STATES, allowed
from support.fmi2.caller import Caller
from support.fmi2.raw import DISCARD, ERROR, OK, array
from support.fmi2.states import bring_to

PHASE_NAMES = {
    "instantiated": "instantiated",
    "initialization": "initialization mode",
    "complete": "step mode",
    "failed": "step mode",
    "terminated": "terminated",
    "error": "error",
    "fatal": "fatal",
}
# What an allowed call returns where that is not fmi2OK: no such status or derivative is provided, and what
# was too much for one internal step still is.
ANSWERS = {
    "GetIntegerStatus": DISCARD,
    "GetStringStatus": DISCARD,
    ("DoStep", "failed"): DISCARD,
}


def refusal_fault(instance: raw.Instance, function: str, state: str, status: int) -> str | None:
    """What is wrong about the way a call out of order was refused"""
    texts = instance.texts()
    if status != ERROR or len(texts) != 1:
        return f"{function}: status {status}, messages {texts}"
    where = (
        f"in phase {PHASE_NAMES[state]}" if function not in EXCHANGE else "on an instance of Co-Simulation"
    )
    if f"fmi2{function} called {where}" not in texts[0]:
        return f"{function}: the message does not say what was called when: {texts[0]}"
    return None


def faults_in(fmu: raw.Fmu, state: str, function: str) -> str | None:
    with raw.Instance(fmu) as instance:
        bring_to(instance, state)
        caller = Caller(instance)
        caller.prepare()
        arguments = getattr(caller, function, tuple)()
        del instance.messages[:]
        status = instance.call(function, *arguments)
        fault = None
        if not allowed(function, state):
            fault = refusal_fault(instance, function, state, status)
            if fault is None and caller.bytes and instance.save() != caller.bytes:
                fault = f"{function}: refused, yet it changed the instance"
        elif status != ANSWERS.get((function, state), ANSWERS.get(function, OK)):
            fault = f"{function}: status {status}, {instance.texts()}"
        caller.end()
        return fault


@pytest.mark.parametrize("state", [state for state in STATES if state not in ("start", "failed")])
def test_every_function_in_every_state(fmu, state):
    functions = [function for function in FUNCTIONS if function != "FreeInstance"]
    assert [fault for function in functions if (fault := faults_in(fmu, state, function))] == []


# What event_driven could not finish in one internal step it finishes in the next.
@pytest.mark.parametrize("scene", [scene for scene in raw.SOLVER_SCENES if scene not in raw.WITHOUT_CVODE])
def test_every_function_after_a_discarded_step(scene):
    fmu = raw.load(scene)
    functions = [function for function in FUNCTIONS if function != "FreeInstance"]
    assert [fault for function in functions if (fault := faults_in(fmu, "failed", function))] == []


def test_no_function_crashes_without_an_instance(fmu):
    nothing = {
        function: [None if kind not in (c_int, c_double, c_size_t) else 0 for kind in arguments]
        for function, arguments in raw.ARGUMENTS.items()
        if arguments and arguments[0] is c_void_p
    }
    statuses = {
        function: getattr(fmu.library, function)(*arguments) for function, arguments in nothing.items()
    }
    assert statuses.pop("fmi2FreeInstance") is None
    assert statuses == dict.fromkeys(statuses, ERROR)


def test_versions_need_no_instance(fmu):
    assert fmu.library.fmi2GetVersion() == b"2.0"
    assert fmu.library.fmi2GetTypesPlatform() == b"default"


def test_the_table_names_every_function():
    without_instance = {"fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate"}
    assert {f"fmi2{function}" for function in FUNCTIONS} | without_instance == set(raw.ARGUMENTS)


def test_a_refused_call_does_not_end_the_run(fmu):
    with raw.Instance(fmu) as good, raw.Instance(fmu) as disturbed:
        for instance in (good, disturbed):
            instance.initialize()
        for function in (
            "SetupExperiment",
            "EnterInitializationMode",
            "ExitInitializationMode",
            "CancelStep",
        ):
            assert Caller(disturbed).call(function) == ERROR
        assert good.run([0.1] * 5) == disturbed.run([0.1] * 5)


def test_initialization_needs_an_experiment(fmu):
    with raw.Instance(fmu) as instance:
        with instance.expect(ERROR, "fmi2EnterInitializationMode", "before fmi2SetupExperiment") as got:
            got(instance.call("EnterInitializationMode"))
        instance.initialize()


def test_start_values_can_be_read_at_once_and_outputs_cannot(every_fmu):
    with raw.Instance(every_fmu) as instance:
        for variable in every_fmu.select("parameter", "input"):
            assert instance.get_one(variable) == variable.start_value, variable.name
        gap = every_fmu.variables["contact.gap"]
        with instance.expect(ERROR, "fmi2GetReal", "contact.gap", "before initialization mode") as got:
            got(instance.call("GetReal", array(c_uint, [gap.reference]), 1, array(c_double, [0])))


def test_outputs_are_there_in_initialization_mode(fmu):
    with raw.Instance(fmu) as instance:
        instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        instance.set({"source.center": [0.9, 0.0, 0.3]})
        instance.ok("EnterInitializationMode")
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
            with instance.expect(ERROR, variable.name, "fixed after initialization") as got:
                got(instance.set_one(variable, variable.start_value))
        assert instance.bits() == before


def test_what_is_calculated_cannot_be_set(every_fmu):
    with raw.Instance(every_fmu) as instance:
        for variable in every_fmu.select("output", "calculatedParameter"):
            with instance.expect(ERROR, variable.name, "cannot be set") as got:
                got(instance.set_one(variable, 0))
        instance.initialize()
        for variable in every_fmu.select("output", "calculatedParameter"):
            with instance.expect(ERROR, variable.name, "cannot be set") as got:
                got(instance.set_one(variable, 0))
