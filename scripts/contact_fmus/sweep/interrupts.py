"""What asks for an end: Ctrl-C, and SIGTERM alike"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """An exception is lost where a signal happens to meet a finalizer (dask's futures have one). While
    somebody looks often, the first signal is only noted."""

    def __init__(self) -> None:
        self._asked = 0
        self._looked_for = False

    def _answer(self, *_) -> None:
        self._asked += 1
        if self._asked > 1 or not self._looked_for:
            raise KeyboardInterrupt

    def look(self) -> None:
        """Ends what goes on if that has been asked for"""
        if self._asked:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def answered(self) -> Iterator[None]:
        """Signals come here; they are the main thread's"""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.signal(number, self._answer) for number in SIGNALS}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    @contextlib.contextmanager
    def looked_for(self) -> Iterator[None]:
        """Within, somebody calls look() at least every second"""
        self._looked_for = True
        try:
            yield
        finally:
            self._looked_for = False
        self.look()
