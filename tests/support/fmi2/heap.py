"""An importer's memory functions that keep count, for the tests of memory and of state pointers."""

import ctypes
from ctypes import c_size_t, c_void_p

from support.fmi2.raw import ALLOCATE, FREE

LIBC = ctypes.CDLL(None)
LIBC.calloc.restype = c_void_p
LIBC.calloc.argtypes = [c_size_t, c_size_t]
LIBC.free.argtypes = [c_void_p]


class Heap:
    """An importer's memory functions that keep count; the n-th allocation fails where asked"""

    def __init__(self, failing: int = -1):
        self.failing = failing
        self.count = 0
        self.living: dict[int, int] = {}
        self.foreign: list[int] = []
        self.functions = (ALLOCATE(self._allocate), FREE(self._free))

    def _allocate(self, count: int, size: int) -> int | None:
        self.count += 1
        if self.count - 1 == self.failing:
            return None
        address = LIBC.calloc(count, size)
        self.living[address] = count * size
        return address

    def _free(self, address: int | None) -> None:
        if self.living.pop(address, None) is None:
            self.foreign.append(address)
        else:
            LIBC.free(address)
