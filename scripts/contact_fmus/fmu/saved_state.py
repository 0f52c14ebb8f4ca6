"""A state of an FMU's instance that ContactFmu.save() kept"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any


class SavedState:
    """A handle to what the FMU itself keeps; bytes(state) is the same for another instance or process.

    The FMU frees it when this object goes, or when the instance is closed: take its bytes before.
    """

    def __init__(self, owner: Any, handle: Any, time: float, free: Callable[[Any], Any]):
        self.time = time  # s, of the instance that was saved
        self._owner = weakref.ref(owner)
        self._handle = handle
        self._finalizer = weakref.finalize(self, free, handle)
        self._finalizer.atexit = False  # the process is over, and the library with it

    def belongs_to(self, fmu: Any) -> bool:
        """Whether the instance can take it as it is"""
        return self._finalizer.alive and self._owner() is fmu

    @property
    def handle(self) -> Any:
        """What fmi2SetFMUstate takes"""
        if not self._finalizer.alive:
            raise ValueError(
                f"the state of {self.time!r} s went with its instance: take bytes(state) before closing"
            )
        return self._handle

    def __bytes__(self) -> bytes:
        handle = self.handle  # while there is one, its instance is open
        return self._owner().call("serializeFMUstate", handle)

    def __len__(self) -> int:
        """Bytes of the serialized state"""
        return len(bytes(self))

    def release(self) -> None:
        """Frees it now; needless a second time."""
        self._finalizer()
