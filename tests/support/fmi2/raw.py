"""FMI 2.0 calls by ctypes, without an importer's kindness: any function, any arguments, statuses as they are.

An Instance records what the FMU told its logger; it never raises for a refused call, `ok` does. What the FMU
is as a file comes from raw_fmu.py, types and numbers from prototypes.py; the tests take all names from here.
"""

from __future__ import annotations

import contextlib
import ctypes
import struct
from collections.abc import Iterable
from ctypes import c_double, c_int, c_size_t, c_uint, c_void_p
from typing import Any, NamedTuple

from contact_fmus.fmu.files import fmus_folder
from support.fmi2.prototypes import (
    ALLOCATE,
    ARGUMENTS,
    CO_SIMULATION,
    DISCARD,
    DO_STEP_STATUS,
    ERROR,
    FATAL,
    FREE,
    LAST_SUCCESSFUL_TIME,
    LOGGER,
    MODEL_EXCHANGE,
    OK,
    PENDING_STATUS,
    TERMINATED,
    WARNING,
    Callbacks,
    EventInfo,
    array,
)
from support.fmi2.raw_fmu import KINDS, SCENES, SOLVER_SCENES, WITHOUT_CVODE, Fmu, Variable, load

__all__ = [
    "ALLOCATE",
    "ARGUMENTS",
    "CO_SIMULATION",
    "DISCARD",
    "DO_STEP_STATUS",
    "ERROR",
    "FATAL",
    "FREE",
    "KINDS",
    "LAST_SUCCESSFUL_TIME",
    "LOGGER",
    "MODEL_EXCHANGE",
    "OK",
    "PENDING_STATUS",
    "SCENES",
    "SOLVER_SCENES",
    "TERMINATED",
    "WARNING",
    "WITHOUT_CVODE",
    "Callbacks",
    "EventInfo",
    "Fmu",
    "Instance",
    "Message",
    "Variable",
    "array",
    "c_double",
    "c_int",
    "c_uint",
    "fmus_folder",
    "load",
]


class Message(NamedTuple):
    """One call of the logger; `raw` is the printf format as it came, `text` what it says"""

    status: int
    category: str
    raw: str

    @property
    def text(self) -> str:
        return self.raw.replace("%%", "%").replace("##", "#")


class Instance:
    """An instance and everything its logger was told"""

    def __init__(
        self,
        fmu: Fmu,
        name: bytes | None = b"tested",
        kind: int = CO_SIMULATION,
        guid: bytes | None = b"",
        resources: bytes | None = b"file:///nowhere",
        logging: bool = False,
        memory: tuple[Any, Any] | None = None,
        with_logger: bool = True,
    ):
        self.fmu = fmu
        self.messages: list[Message] = []
        self.loggers: list[bytes] = []  # instance names the logger was called with
        self.callbacks = Callbacks()
        if with_logger:
            self.callbacks.logger = LOGGER(self._log)
        if memory is not None:
            self.callbacks.allocate, self.callbacks.free = memory
        self.component = fmu.library.fmi2Instantiate(
            name,
            kind,
            fmu.guid.encode() if guid == b"" else guid,
            resources,
            ctypes.byref(self.callbacks),
            0,
            int(logging),
        )

    def _log(self, _environment, name, status, category, message) -> None:
        self.loggers.append(name)
        self.messages.append(Message(status, category.decode(), message.decode()))

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_exception) -> None:
        self.free()

    def free(self) -> None:
        if self.component is not None:
            self.fmu.library.fmi2FreeInstance(self.component)
            self.component = None

    def call(self, function: str, *arguments: Any) -> int:
        """The status of fmi2<function>(component, ...)"""
        return getattr(self.fmu.library, f"fmi2{function}")(self.component, *arguments)

    def ok(self, function: str, *arguments: Any) -> None:
        status = self.call(function, *arguments)
        assert status <= WARNING, f"fmi2{function}{arguments}: status {status}, {self.texts()}"

    def texts(self) -> list[str]:
        return [message.text for message in self.messages]

    @contextlib.contextmanager
    def expect(self, status: int, *words: str):
        """`with instance.expect(DISCARD, "radius") as got: got(status)`: one message, with the words"""
        del self.messages[:]
        got: list[int] = []
        yield got.append
        assert got == [status], f"status {got}, expected {status}: {self.texts()}"
        assert [message.status for message in self.messages] == [status], self.messages
        missing = [word for word in words if word not in self.messages[0].text]
        assert not missing, f"{missing} not in '{self.messages[0].text}'"

    # by names

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            for variable, number in self._scalars(name, value):
                assert self.set_one(variable, number) <= WARNING, (
                    f"{variable.name} = {number}: {self.texts()}"
                )

    def _scalars(self, name: str, value: Any) -> Iterable[tuple[Variable, float | int]]:
        variables = self.fmu.variables
        if name not in variables:
            return [(variables[f"{name}[{index + 1}]"], number) for index, number in enumerate(value)]
        variable = variables[name]
        if isinstance(value, str):
            value = int(variable.minimum) + variable.items.index(value)
        return [(variable, value)]

    def set_one(self, variable: Variable, value: float | int) -> int:
        kind = c_double if variable.type == "Real" else c_int
        return self.call(
            f"Set{variable.call_type}", array(c_uint, [variable.reference]), 1, array(kind, [value])
        )

    def get_one(self, variable: Variable) -> float | int:
        value = array(c_double if variable.type == "Real" else c_int, [0])
        self.ok(f"Get{variable.call_type}", array(c_uint, [variable.reference]), 1, value)
        return value[0]

    def get(self, name: str) -> Any:
        variables = self.fmu.variables
        if name in variables:
            return self.get_one(variables[name])
        names = [f"{name}[{index}]" for index in (1, 2, 3, 4)]
        return [self.get_one(variables[one]) for one in names if one in variables]

    def bits(self, *causalities: str) -> dict[str, bytes]:
        """Name -> bytes of every value, or of those of the given causalities: equal only when the bits are"""
        chosen = self.fmu.select(*causalities) if causalities else self.fmu.variables.values()
        return {
            variable.name: struct.pack("<d" if variable.type == "Real" else "<i", self.get_one(variable))
            for variable in chosen
        }

    # life cycle

    def initialize(
        self,
        values: dict[str, Any] | None = None,
        tolerance: float | None = None,
        start: float = 0.0,
        stop: float | None = None,
    ) -> Instance:
        self.ok(
            "SetupExperiment",
            int(tolerance is not None),
            tolerance or 0.0,
            start,
            int(stop is not None),
            stop or 0.0,
        )
        self.set(values or {})
        self.ok("EnterInitializationMode")
        self.ok("ExitInitializationMode")
        return self

    def run(self, steps: Iterable[float], start: float = 0.0) -> list[dict[str, bytes]]:
        """The bits of all outputs after each step"""
        time = start
        rows = []
        for size in steps:
            self.ok("DoStep", time, size, 1)
            time += size
            rows.append(self.bits("output"))
        return rows

    def time(self) -> float:
        """Where the last step ended"""
        time = c_double()
        self.ok("GetRealStatus", LAST_SUCCESSFUL_TIME, ctypes.byref(time))
        return time.value

    # Model Exchange

    RATES = "GetDerivatives"

    def update_discrete_states(self) -> tuple[bool, bool, float | None]:
        """Whether that has to be done again, whether a state has jumped, when the next event will be"""
        news = EventInfo()
        self.ok("NewDiscreteStates", ctypes.byref(news))
        scheduled = news.next_event if news.next_event_defined else None
        return bool(news.again), bool(news.states_changed), scheduled

    def complete_step(self) -> None:
        self.ok("CompletedIntegratorStep", 1, ctypes.byref(c_int()), ctypes.byref(c_int()))

    # states

    def save(self) -> bytes:
        state = c_void_p()
        size = c_size_t()
        self.ok("GetFMUstate", ctypes.byref(state))
        self.ok("SerializedFMUstateSize", state, ctypes.byref(size))
        buffer = ctypes.create_string_buffer(size.value)
        self.ok("SerializeFMUstate", state, buffer, size)
        self.ok("FreeFMUstate", ctypes.byref(state))
        return buffer.raw

    def deserialize(self, blob: bytes) -> tuple[int, c_void_p]:
        state = c_void_p()
        return self.call("DeSerializeFMUstate", blob, len(blob), ctypes.byref(state)), state

    def restore(self, blob: bytes) -> None:
        status, state = self.deserialize(blob)
        assert status == OK, self.texts()
        self.ok("SetFMUstate", state)
        self.ok("FreeFMUstate", ctypes.byref(state))
