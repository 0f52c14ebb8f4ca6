"""Every function in every state of the standard: allowed calls work, others are refused in words."""

from ctypes import byref, c_void_p

import pytest

from support.caller import Caller, nothing
from support.fmi2.states import NAMES, PHASES, forge
from support.fmi3 import raw
from support.fmi3.call_table import FOREIGN, FUNCTIONS, STATES, allowed
from support.fmi3.raw import ARGUMENTS, ERROR, OK, WITHOUT_INSTANCE, Instance
from support.outside import Outside

REASONS = {"Clock": "no clocks", "Interval": "no clocks", "Shift": "no clocks"}
REASONS |= {"Configuration": "no structural parameters"}
REASONS |= {"ModelPartition": "Scheduled Execution is not provided"}
REASONS |= {"Evaluate": "providesEvaluateDiscreteStates is false"}
REASONS |= {"Dependencies": "providesPerElementDependencies is false"}
SCENES = ["SphereCylinder", "PinnedEvent"]
KINDS = {"CoSimulation": "Co-Simulation", "ModelExchange": "Model Exchange"}
EVERY_STATE = [(kind, state) for kind, states in STATES.items() for state in states]


def bring_to(instance, state):
    """From instantiated on, as an importer goes; `error` and `fatal` are enter_forged's"""
    if state == "instantiated":
        return
    instance.enter_initialization()
    if state == "initialization":
        return
    instance.ok("ExitInitializationMode")
    if state == "event":
        return
    if instance.exchange:
        Outside(instance).begin()
    else:
        instance.handle_event(enter=False)
        assert instance.step(0.0, 0.001).status == OK
    if state == "terminated":
        instance.ok("Terminate")


def enter_forged(instance, state):
    """Into a phase that only a forged state leads to; nothing can be freed any more in a fatal one."""
    blob = forge(instance.save(), phase=PHASES[state])
    handle = c_void_p()
    instance.ok("DeserializeFMUState", blob, len(blob), byref(handle))
    instance.ok("SetFMUState", handle)


def instance_of(fmu, kind):
    events = kind == "CoSimulation"
    return Instance(fmu, event_mode=events, early_return=events, exchange=not events)


def fault_of(fmu, kind, state, function):
    """What is wrong about the answer, or None"""
    with instance_of(fmu, kind) as instance:
        bring_to(instance, state)
        caller = Caller(instance)
        if state in ("error", "fatal"):
            enter_forged(instance, state)
        where = f"in phase {NAMES[state]}"
        if function in FOREIGN[kind]:
            where = f"on an instance of {KINDS[kind]}, allowed: of "
        return caller.fault(function, allowed(function, state, kind), where)


@pytest.mark.parametrize("kind, state", EVERY_STATE)
@pytest.mark.parametrize("scene", SCENES)
def test_every_function_in_every_state(scene, kind, state):
    fmu = raw.load(scene)
    assert [fault for name in FUNCTIONS if (fault := fault_of(fmu, kind, state, name))] == []


def test_what_is_not_provided_says_so(fmu):
    said = 0
    with Instance(fmu) as instance:
        instance.initialize()
        for function in FUNCTIONS:
            reason = next((text for part, text in REASONS.items() if part in function), None)
            if reason and not any(allowed(function, state, kind) for kind, state in EVERY_STATE):
                expected = instance.expect(ERROR, f"fmi3{function}", reason)
                expected(instance.call(function, *map(nothing, ARGUMENTS[function])))
                said += 1
    assert said == 16


def test_no_function_crashes_without_an_instance(fmu):
    for function in FUNCTIONS:
        call = getattr(fmu.library, f"fmi3{function}")
        assert call(None, *map(nothing, ARGUMENTS[function])) == ERROR, function
    assert fmu.library.fmi3FreeInstance(None) is None


def test_the_version_needs_no_instance(fmu):
    assert fmu.library.fmi3GetVersion() == b"3.0"


def test_scheduled_execution_is_not_offered(fmu):
    told = []
    function = "InstantiateScheduledExecution"
    arguments = [nothing(argument) for argument in ARGUMENTS[function]]
    arguments[0] = b"tested"
    logger = raw.LOGGER(lambda _environment, status, _category, text: told.append((status, text.decode())))
    arguments[6] = logger
    assert getattr(fmu.library, f"fmi3{function}")(*arguments) is None
    ((status, text),) = told
    assert status == ERROR and "Co-Simulation or Model Exchange" in text and f"fmi3{function}" in text


@pytest.mark.parametrize("exchange", [False, True])
@pytest.mark.parametrize("wrong", [{"name": None}, {"name": b""}, {"token": None}, {"token": b"{other}"}])
def test_a_nameless_instance_or_a_wrong_token_is_refused(fmu, wrong, exchange):
    with Instance(fmu, **wrong, exchange=exchange) as instance:
        assert instance.component is None
        assert ("instanceName" if "name" in wrong else "instantiationToken") in instance.texts()[0]


def test_the_table_names_every_function():
    assert {*FUNCTIONS, *WITHOUT_INSTANCE, "FreeInstance"} == set(ARGUMENTS)
    assert sum(allowed(name, "step") for name in FUNCTIONS) == 14 + 2 * 13
    assert sum(allowed(name, "continuous", "ModelExchange") for name in FUNCTIONS) == 21 + 1 + 13
    assert {len(FOREIGN["CoSimulation"]), len(FOREIGN["ModelExchange"])} == {10, 3}
