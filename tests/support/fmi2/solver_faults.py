"""Lives of an FMU in which one allocation fails, SUNDIALS' own included. Run with failing_malloc.c preloaded:

    python -m support.fmi2.solver_faults count|fail LIBRARY GUID GAP_REFERENCE METHOD_REFERENCE METHOD

Prints a line of JSON for each allocation. "count": where it was asked for, in one life with all memory.
"fail": also how two child processes ended, in which it alone or all from it on failed: "survived", "signal N"
or what was wrong."""

import ctypes
import json
import os
import sys
from ctypes import byref, c_char_p, c_double, c_int, c_long, c_size_t, c_uint, c_ulong, c_void_p

from support import prototypes
from support.fmi2.raw import OK, PROTOTYPES, WARNING, Callbacks, array

ALL_FROM = 1_000_000
STEPS = 100


class Life:
    """A process has one: an instance without callbacks, so that libc's memory is used"""

    def __init__(self, library: str, guid: str, gap: int, reference: int, method: int):
        self.shim = ctypes.CDLL(None)
        self.shim.failing_malloc_watch.argtypes = [c_void_p, c_long, c_long]
        self.shim.failing_malloc_count.restype = c_long
        self.shim.failing_malloc_living.restype = c_long
        self.shim.failing_malloc_caller.restype = c_ulong
        self.fmu = prototypes.bind(library, PROTOTYPES)
        self.guid, self.gap, self.reference, self.method = guid.encode(), gap, reference, method

    def again(self, function, *arguments):
        """Makes a call that may be refused for want of memory, and works once there is some."""
        if function(*arguments) > WARNING:
            self.shim.failing_malloc_stop()
            assert function(*arguments) == OK, function.__name__

    def instance(self):
        none = Callbacks()
        made = self.fmu.fmi2Instantiate(b"faulty", 1, self.guid, None, byref(none), 0, 0)
        if made is None:
            self.shim.failing_malloc_stop()
            made = self.fmu.fmi2Instantiate(b"faulty", 1, self.guid, None, byref(none), 0, 0)
        return made

    def run(self, first: int, last: int) -> None:
        fmu = self.fmu
        self.shim.failing_malloc_watch(ctypes.cast(fmu.fmi2Instantiate, c_void_p), first, last)
        one = self.instance()
        assert fmu.fmi2SetupExperiment(one, 0, 0.0, 0.0, 0, 0.0) == OK
        if self.reference:
            chosen = array(c_uint, [self.reference]), 1, array(c_int, [self.method])
            assert fmu.fmi2SetInteger(one, *chosen) == OK
        self.again(fmu.fmi2EnterInitializationMode, one)
        self.again(fmu.fmi2ExitInitializationMode, one)
        before = self.shim.failing_malloc_count()
        for index in range(STEPS):
            assert fmu.fmi2DoStep(one, index / 64, 1 / 64, 1) == OK
        assert self.shim.failing_malloc_count() == before, "allocated during steps"
        other = self.copy(one)
        for instance in (one, other):
            assert fmu.fmi2DoStep(instance, STEPS / 64, 1 / 64, 1) == OK
        assert self.position(one) == self.position(other), "the copy goes another way"
        self.again(fmu.fmi2Reset, one)
        for instance in (one, other):
            fmu.fmi2FreeInstance(instance)
        assert self.shim.failing_malloc_living() == 0, f"{self.shim.failing_malloc_living()} blocks left"

    def copy(self, one):
        """Makes a second instance that takes over the first one's state."""
        fmu, state, size = self.fmu, c_void_p(), c_size_t()
        self.again(fmu.fmi2GetFMUstate, one, byref(state))
        assert fmu.fmi2SerializedFMUstateSize(one, state, byref(size)) == OK
        blob = ctypes.create_string_buffer(size.value)
        assert fmu.fmi2SerializeFMUstate(one, state, blob, size) == OK
        assert fmu.fmi2FreeFMUstate(one, byref(state)) == OK
        other = self.instance()
        self.again(fmu.fmi2DeSerializeFMUstate, other, ctypes.cast(blob, c_char_p), size, byref(state))
        self.again(fmu.fmi2SetFMUstate, other, state)
        return other

    def position(self, instance) -> float:
        value = array(c_double, [0.0])
        assert self.fmu.fmi2GetReal(instance, array(c_uint, [self.gap]), 1, value) == OK
        return value[0]


def ending(life: Life, first: int, last: int) -> str:
    child = os.fork()
    if child == 0:
        code = 0
        try:
            life.run(first, last)
        except AssertionError as fault:
            print(json.dumps({"fault": str(fault), "index": first}), flush=True)
            code = 1
        os._exit(code)
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        return f"signal {os.WTERMSIG(status)}"
    return "survived" if os.WEXITSTATUS(status) == 0 else "fault"


def main() -> None:
    what, library, guid, *numbers = sys.argv[1:]
    life = Life(library, guid, *map(int, numbers))
    life.run(-1, -1)
    life.run(-1, -1)  # what libc keeps from a first time has been taken
    total = life.shim.failing_malloc_count()
    callers = [life.shim.failing_malloc_caller(index) for index in range(total)]
    for index in range(total):
        row = {"index": index, "caller": callers[index]}
        if what == "fail":
            row |= {"alone": ending(life, index, index), "and all after": ending(life, index, ALL_FROM)}
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
