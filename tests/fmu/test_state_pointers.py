"""State pointers an importer gets wrong, never initialised, freed or another instance's: none is followed."""

import contextlib
import ctypes
from collections.abc import Iterator
from ctypes import byref, c_size_t, c_void_p

import pytest

from support.fmi2 import raw
from support.fmi2.heap import Heap
from support.fmi2.raw import ERROR, OK

# What a stray pointer leads to: more than a state takes, so that the whole of a wrong write shows.
GUARD = bytes(range(256)) * 64
NO_ADDRESS = 8  # nothing is mapped there: reading it would end the process

BRINGING = ["SetFMUstate", "SerializedFMUstateSize", "SerializeFMUstate", "FreeFMUstate"]


@pytest.fixture
def guarded() -> Iterator[int]:
    """The address of the middle of a buffer that stays as it is"""
    buffer = ctypes.create_string_buffer(GUARD, len(GUARD))
    yield ctypes.addressof(buffer) + len(GUARD) // 4
    assert buffer.raw == GUARD


@contextlib.contextmanager
def counted(fmu: raw.Fmu) -> Iterator[tuple[raw.Instance, Heap]]:
    """An instance on a heap that frees nothing twice, and gets all of it back"""
    heap = Heap()
    with raw.Instance(fmu, memory=heap.functions) as instance:
        yield instance.initialize(), heap
    assert (heap.living, heap.foreign) == ({}, [])


def refused(instance: raw.Instance, function: str, address: int) -> None:
    """The call says that it does not know the state; nothing is written anywhere"""
    state = c_void_p(address)
    size = c_size_t(77)
    room = ctypes.create_string_buffer(GUARD, len(GUARD))
    arguments = {"SetFMUstate": (state,), "SerializedFMUstateSize": (state, byref(size))}
    arguments |= {"SerializeFMUstate": (state, room, len(room)), "FreeFMUstate": (byref(state),)}
    instance.expect(ERROR, f"fmi2{function}", "unknown")(instance.call(function, *arguments[function]))
    assert (state.value, size.value, room.raw) == (address, 77, GUARD)


def test_a_state_pointer_is_used_again(instance):
    instance.initialize()
    state = instance.taken()
    address = state.value
    instance.run([0.1])
    instance.ok("GetFMUstate", byref(state))
    assert state.value == address
    blob = instance.save()
    instance.run([0.1], start=0.1)
    instance.ok("DeSerializeFMUstate", blob, len(blob), byref(state))
    assert state.value == address
    instance.ok("SetFMUstate", state)
    assert instance.save() == blob
    instance.ok("FreeFMUstate", byref(state))
    assert state.value is None


@pytest.mark.parametrize("function", ["GetFMUstate", "DeSerializeFMUstate"])
def test_a_pointer_never_initialised_is_not_followed(fmu, guarded, function):
    with counted(fmu) as (instance, heap):
        blob = instance.save()
        given = (blob, len(blob)) if function == "DeSerializeFMUstate" else ()
        for address in (guarded, guarded + 1, NO_ADDRESS):
            state = c_void_p(address)
            if given:
                assert instance.call(function, blob[:-1], len(blob) - 1, byref(state)) == ERROR
                assert state.value == address
            instance.ok(function, *given, byref(state))
            assert state.value in heap.living
            instance.ok("SetFMUstate", state)
            assert instance.save() == blob
            instance.ok("FreeFMUstate", byref(state))


@pytest.mark.parametrize("function", BRINGING)
def test_a_pointer_never_initialised_is_refused(fmu, guarded, function):
    with counted(fmu) as (instance, _heap):
        blob = instance.save()
        state = instance.taken()
        for address in (guarded, NO_ADDRESS, state.value + 8, state.value - 8):
            refused(instance, function, address)
        assert instance.save() == blob


@pytest.mark.parametrize("function", BRINGING)
def test_a_freed_state_is_refused(fmu, function):
    """A copy of the pointer outlives the state; the ones taken before and after it are not harmed."""
    with counted(fmu) as (instance, _heap):
        states = [instance.taken() for _ in range(3)]
        freed = states[1].value
        instance.ok("FreeFMUstate", byref(states[1]))
        refused(instance, function, freed)
        for state in (states[0], states[2]):
            instance.ok("SetFMUstate", state)
            instance.ok("FreeFMUstate", byref(state))


@pytest.mark.parametrize("function", BRINGING)
def test_a_state_of_another_instance_is_refused(fmu, function):
    """The way from one instance to another is serialization: the owner may be gone, or running elsewhere."""
    with counted(fmu) as (owner, _), counted(fmu) as (other, _):
        state = owner.taken()
        blob = owner.save()
        refused(other, function, state.value)
        owner.ok("SetFMUstate", state)
        assert owner.save() == blob
        other.restore(blob)


def test_get_leaves_a_state_of_another_instance_to_its_owner(fmu):
    with counted(fmu) as (owner, owners), counted(fmu) as (other, others):
        state = owner.taken()
        kept = c_void_p(state.value)
        blob = owner.save()
        other.run([0.1])
        other.ok("GetFMUstate", byref(state))
        assert state.value in others.living
        assert kept.value in owners.living
        owner.run([0.1])
        owner.ok("SetFMUstate", kept)
        assert owner.save() == blob


def test_states_outlive_a_reset(fmu):
    with counted(fmu) as (instance, _heap):
        instance.run([0.1])
        blob, state = instance.save(), instance.taken()
        instance.ok("Reset")
        instance.ok("SetFMUstate", state)
        assert instance.save() == blob
        instance.ok("Reset")
        instance.ok("FreeFMUstate", byref(state))


def test_without_memory_the_pointer_stays(fmu, guarded):
    heap = Heap()
    with raw.Instance(fmu, memory=heap.functions) as instance:
        instance.initialize()
        blob = instance.save()
        state = c_void_p(guarded)
        for function, arguments in [("GetFMUstate", ()), ("DeSerializeFMUstate", (blob, len(blob)))]:
            heap.failing = heap.count
            expected = instance.expect(ERROR, f"fmi2{function}", "memory")
            expected(instance.call(function, *arguments, byref(state)))
            assert state.value == guarded
            assert instance.call(function, *arguments, byref(state)) == OK
            state.value = guarded
