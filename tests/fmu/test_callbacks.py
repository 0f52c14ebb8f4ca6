"""Callbacks that are missing, and a logger that calls back into the FMU while it is being told something."""

import ctypes
from ctypes import byref, c_double, c_int, c_uint, c_void_p

import pytest
import raw
from call_table import FUNCTIONS
from caller import Caller
from heap import Heap
from raw import ALLOCATE, CO_SIMULATION, DISCARD, ERROR, FREE, LOGGER, OK, Callbacks, array
from runs import RUNS, begin, go_on


@pytest.mark.parametrize("logger", [False, True])
@pytest.mark.parametrize("allocate", [False, True])
@pytest.mark.parametrize("free", [False, True])
def test_any_callback_may_be_missing(fmu, logger, allocate, free):
    """A whole life, refusals included; memory functions are used only as a pair"""
    heap = Heap()
    memory = (heap.functions[0] if allocate else ALLOCATE(), heap.functions[1] if free else FREE())
    with raw.Instance(fmu, memory=memory, with_logger=logger, logging=True) as instance:
        instance.initialize()
        assert instance.call("DoStep", 0.0, -1.0, 1) == DISCARD
        assert (
            instance.call(
                "Terminate",
            )
            == OK
        )
        instance.ok("Reset")
        instance.initialize()
        instance.run([0.1])
        instance.restore(instance.save())
        assert bool(instance.messages) == logger
    assert (heap.living, heap.foreign) == ({}, [])
    assert (heap.count > 0) == (allocate and free)


def test_callbacks_all_null_make_an_instance_and_none_at_all_does_not(fmu):
    guid = fmu.guid.encode()
    component = fmu.library.fmi2Instantiate(b"quiet", CO_SIMULATION, guid, None, byref(Callbacks()), 0, 1)
    assert component is not None
    assert fmu.library.fmi2DoStep(component, 0.0, 0.1, 1) == ERROR
    fmu.library.fmi2FreeInstance(component)
    assert fmu.library.fmi2Instantiate(b"quiet", CO_SIMULATION, guid, None, None, 0, 1) is None
    assert fmu.library.fmi2Instantiate(b"quiet", CO_SIMULATION, b"?", None, byref(Callbacks()), 0, 1) is None


def test_the_callbacks_may_go_once_the_instance_is_made(fmu):
    """The functions are kept, not the place where the importer named them."""
    with raw.Instance(fmu) as instance:
        ctypes.memset(byref(instance.callbacks), 0xA5, ctypes.sizeof(instance.callbacks))
        instance.initialize()
        assert instance.call("DoStep", 0.0, -1.0, 1) == DISCARD
        assert len(instance.messages) == 1


class Meddler(raw.Instance):
    """Its logger reads values, saves states, asks for derivatives and makes wrong calls"""

    meddling = 0

    def _log(self, environment, name, status, category, message) -> None:
        super()._log(environment, name, status, category, message)
        if self.meddling or getattr(self, "component", None) is None:
            return
        self.meddling += 1
        kept = list(self.messages)
        self.meddle()
        self.messages[:] = kept
        self.meddling -= 1

    calls = 0

    def meddle(self) -> None:
        self.calls += 1
        gap = array(c_uint, [self.fmu.variables["contact.gap"].reference])
        self.call("GetReal", gap, 1, array(c_double, [0.0]))
        self.call("GetRealOutputDerivatives", gap, 1, array(c_int, [1]), array(c_double, [0.0]))
        self.call("GetReal", array(c_uint, [4_000_000_000]), 1, array(c_double, [0.0]))
        self.call("GetStatus", 0, byref(c_int()))
        state = c_void_p()
        if self.call("GetFMUstate", byref(state)) == OK:
            self.call("FreeFMUstate", byref(state))


def test_a_logger_may_call_back_while_it_is_told_of_a_refusal(fmu):
    """Every function in step mode is answered as without the meddling, and the run goes the same way."""
    with Meddler(fmu) as meddled, raw.Instance(fmu) as plain:
        for instance in (meddled, plain):
            instance.initialize()
            instance.run([0.1])
        for function in FUNCTIONS:
            if function in ("FreeInstance", "Reset", "Terminate", "SetFMUstate", "DeSerializeFMUstate"):
                continue
            told = []
            for instance in (meddled, plain):
                caller = Caller(instance)
                caller.prepare()
                arguments = getattr(caller, function, tuple)()
                del instance.messages[:]
                status = instance.call(function, *arguments)
                told.append((status, [message.status for message in instance.messages]))
                caller.end()
            assert told[0] == told[1], function
        assert meddled.calls > 0
        assert meddled.bits() == plain.bits()


@pytest.mark.parametrize(
    "name", ["sphere in contact", "adams in contact", "on a shaken sphere", "ball off roller"]
)
def test_a_logger_may_read_during_the_events_of_a_step(name):
    """Event messages come from inside fmi2DoStep; a saved state lets the integrator start afresh there."""
    run = RUNS[name]
    with begin(run, logging=True) as plain:
        go_on(plain, run, 0)
        meddled = Meddler(raw.load(run.scene), logging=True)
        meddled.initialize({**run.values, **run.inputs(0.0)}, tolerance=run.tolerance)
        with meddled:
            go_on(meddled, run, 0)
            assert meddled.calls > 0
            assert meddled.get("contact.onsets") == plain.get("contact.onsets")
            assert meddled.get("source.position") == pytest.approx(plain.get("source.position"), abs=1e-6)


def test_a_logger_may_be_told_of_a_failed_instantiation_and_instantiate(fmu):
    """Another instance, made while the first is refused"""
    made = []

    def log(_environment, _name, _status, _category, _message):
        if not made:
            made.append(raw.Instance(fmu))

    callbacks = Callbacks()
    callbacks.logger = LOGGER(log)
    assert fmu.library.fmi2Instantiate(b"a", CO_SIMULATION, b"wrong", None, byref(callbacks), 0, 0) is None
    (other,) = made
    with other:
        other.initialize()
        other.run([0.1])
