"""Callbacks that are missing or gone. What a logger may call is test_meddling_logger.py's."""

import ctypes
from ctypes import byref

import pytest

from support.fmi2 import raw
from support.fmi2.heap import Heap
from support.fmi2.raw import ALLOCATE, CO_SIMULATION, DISCARD, ERROR, FREE, LOGGER, OK, Callbacks


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
        assert instance.call("Terminate") == OK
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
