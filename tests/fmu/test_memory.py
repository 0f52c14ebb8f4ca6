"""The importer's memory functions are used, all memory comes back, and too little of it is told."""

import ctypes
import os
from ctypes import byref, c_int, c_void_p
from pathlib import Path

import pytest

from support.fmi2 import raw
from support.fmi2.heap import Heap
from support.fmi2.raw import ALLOCATE, CO_SIMULATION, DISCARD, ERROR, FREE, LOGGER, OK, Callbacks
from support.fmi2.runs import RUNS, begin, go_on


@pytest.mark.parametrize("name", RUNS)
def test_the_importers_memory_is_used_and_all_of_it_comes_back(name):
    heap = Heap()
    run = RUNS[name]
    instance = begin(run, memory=heap.functions)
    assert heap.count >= 2
    after_initialization = heap.count
    go_on(instance, run, 0)
    assert heap.count == after_initialization, "allocated during steps"
    state = instance.taken()
    assert state.value in heap.living
    blob = instance.save()
    assert instance.deserialize(blob[:-1])[0] == ERROR
    instance.restore(blob)
    instance.ok("FreeFMUstate", byref(state))
    instance.ok("Reset")
    instance.free()
    assert (heap.living, heap.foreign) == ({}, [])


def test_states_the_importer_forgot_come_back_with_the_instance(fmu):
    """Of four states one is freed and three are left; to one of them no pointer leads any more"""
    heap = Heap()
    instance = raw.Instance(fmu, memory=heap.functions).initialize()
    before = set(heap.living)
    blob = instance.save()
    assert set(heap.living) == before
    states = [instance.taken() for _ in range(3)]
    status, brought = instance.deserialize(blob)
    assert status == OK
    instance.ok("FreeFMUstate", byref(states[1]))
    states[0].value = None
    left = set(heap.living) - before
    assert len(left) == 3
    assert {states[2].value, brought.value} < left
    instance.free()
    assert (heap.living, heap.foreign) == ({}, [])


def initialize_in_two_attempts(instance: raw.Instance) -> int:
    """How many attempts were refused for want of memory: none or one"""
    instance.enter_initialization()
    status = instance.call("ExitInitializationMode")
    if status == OK:
        return 0
    assert status == ERROR
    assert "memory" in instance.messages[0].text
    instance.ok("ExitInitializationMode")
    return 1


def test_a_failing_importer_gets_a_refusal_and_its_memory_back(fmu):
    """Each allocation fails once, up to a run in which none does"""
    refusals = 0
    for failing in range(100):
        heap = Heap(failing)
        instance = raw.Instance(fmu, memory=heap.functions)
        if instance.component is None:
            refusals += 1
            assert "memory" in instance.messages[0].text
        else:
            refusals += initialize_in_two_attempts(instance)
            instance.run([0.1])
            state = c_void_p()
            status = instance.call("GetFMUstate", byref(state))
            if status != OK:
                refusals += 1
                assert (status, state.value) == (ERROR, None)
                assert "memory" in instance.messages[0].text
                instance.ok("GetFMUstate", byref(state))
            instance.run([0.1], start=0.1)
            instance.ok("FreeFMUstate", byref(state))
            instance.free()
        assert (heap.living, heap.foreign) == ({}, [])
        if heap.count <= failing:
            break
    assert refusals == failing >= 3


def test_instances_come_and_go_without_growth(fmu):
    """A thousand instances, initialized and thrown away in every phase"""

    def cycle(count: int) -> None:
        for index in range(count):
            with raw.Instance(fmu, with_logger=False) as instance:
                if index % 3:
                    instance.initialize()
                if index % 3 == 2:
                    instance.run([0.1])

    cycle(200)
    before = _resident()
    cycle(1000)
    assert _resident() - before < 1_000_000


def _resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_a_state_of_a_running_instance_opens_a_solver_in_a_fresh_one(universal):
    heap = Heap()
    with raw.Instance(universal) as instance:
        instance.initialize()
        instance.run([0.1])
        blob = instance.save()
        fresh = raw.Instance(universal, memory=heap.functions)
        fresh.restore(blob)
        assert fresh.run([0.1], start=0.1) == instance.run([0.1], start=0.1)
        fresh.free()
    assert (heap.living, heap.foreign) == ({}, [])


def test_getting_and_setting_needs_no_memory(fmu):
    heap = Heap()
    with raw.Instance(fmu, memory=heap.functions) as instance:
        instance.initialize()
        before = heap.count
        instance.bits()
        for variable in fmu.select("input"):
            assert instance.set_one(variable, 0.0) == OK
        assert instance.set_one(fmu.select("input")[0], float("nan")) == DISCARD
        assert instance.call("GetInteger", raw.array(raw.c_uint, [0]), 1, (c_int * 1)()) == ERROR
        assert heap.count == before


# In the next tests callbacks are missing or gone. test_logging.py tests what a logger may call.


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


def test_the_callbacks_may_go_once_the_instance_is_made(instance):
    """The functions are kept, not the place where the importer named them."""
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
