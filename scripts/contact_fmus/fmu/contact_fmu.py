"""One contact FMU, of FMI 2.0 or 3.0, driven through fmpy by the names of its variables.

    with ContactFmu(fmu_file("SphereSphere")) as fmu:
        fmu.start({"source.radius": 0.1, "contact.method": "penalty"}, tolerance=1e-10)
        fmu.step(0.1)
        print(fmu.time, fmu["source.position"], fmu["contact.gap"])

A vector's three scalars `name[1..3]` are read and written together as `name`; enumerations are their items'
names, Booleans are bool. A call the FMU refuses raises FmuError with the FMU's own messages in its text.
"""

import contextlib
import difflib
import enum
import functools
import os
import threading
import weakref
from collections.abc import Callable
from typing import Any, NamedTuple, Self

import numpy as np
from fmpy import fmi2
from fmpy.fmi1 import FMICallException

from contact_fmus.errors import RunFailure, UserError

from .files import fmu_file, fmus_folder, repository, unpack
from .slaves import slave_of
from .variables import Variable, is_fmi3, numbers_of, read_variables, value_of

# A state of an FMU's instance that ContactFmu.save() kept


class SavedState:
    """A handle to what the FMU itself keeps; bytes(state) is the same for another instance or process.

    The FMU frees it when this object goes, or when the instance is closed: take its bytes before."""

    def __init__(self, owner: Any, handle: Any, time: float, free: Callable[[Any], Any]):
        self.time = time  # s, of the instance that was saved
        self.owner = weakref.ref(owner)
        self._handle = handle
        self._finalizer = weakref.finalize(self, free, handle)
        self._finalizer.atexit = False  # the process is over, and the library with it

    @property
    def handle(self) -> Any:
        """What fmi2SetFMUstate of its instance, `owner`, takes"""
        if not self._finalizer.alive:
            raise ValueError(f"the state of {self.time!r} s went with its instance: take bytes(state) before closing")
        return self._handle

    def __bytes__(self) -> bytes:
        handle = self.handle  # while there is one, its instance is open
        return self.owner().call("serializeFMUstate", handle)

    def __len__(self) -> int:
        """Bytes of the serialized state"""
        return len(bytes(self))

    def release(self) -> None:
        """Frees it now; needless a second time."""
        self._finalizer()


__all__ = ["ContactFmu", "FmuError", "Message", "Status", "Variable", "fmu_file", "fmus_folder", "repository"]

# Loading a library through fmpy changes the working directory for a moment, and unpacking fills a shared
# table: one thread at a time.
_loading = threading.Lock()

# Functions by a variable's type; those of Integer serve enumerations too
GETTERS, SETTERS = {"Real": "reals", "Boolean": "getBoolean"}, {"Real": "setReal", "Boolean": "setBoolean"}


class Status(enum.IntEnum):
    """fmi2Status, fmi3Status"""

    OK = 0
    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4
    PENDING = 5


class Message(NamedTuple):
    """What the FMU told its importer's logger"""

    status: Status
    category: str
    text: str


class FmuError(RunFailure, FMICallException):
    """A call that returned Discard, Error or Fatal; `messages` are those the call logged"""

    def __init__(self, function: str, status: int, messages: list[Message]):
        super().__init__(function, status)
        self.messages = messages

    def __str__(self) -> str:
        return " ".join([super().__str__(), *(message.text for message in self.messages)])


class ContactFmu:
    """An instance of an FMU from `path`; `debug` switches its event messages on"""

    def __init__(self, path: str | os.PathLike, instance_name: str | None = None, debug: bool = False):
        self.messages: list[Message] = []
        self._raised: list[Message] = []  # those that errors told
        self.time = 0.0
        with _loading:
            self.folder, self.description = unpack(path)
            try:
                self.slave = slave_of(self.description, self.folder, instance_name)
            except Exception as error:  # fmpy has no class of its own for a library that does not load
                raise UserError(f"{path}: its library cannot be loaded: {error}") from None
        self.variables = read_variables(self.description)
        self._states: weakref.WeakSet[SavedState] = weakref.WeakSet()
        try:
            self.slave.begin(self._log, debug)
        except Exception as error:
            self.slave.freeLibrary()
            self.slave = None
            function = "fmi3InstantiateCoSimulation" if is_fmi3(self.description) else "fmi2Instantiate"
            raise FmuError(function, Status.ERROR, list(self.messages)) from error

    def _log(self, status: int, category: str, text: str) -> None:
        self.messages.append(Message(Status(status), category, text))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception) -> None:
        self.close()

    def close(self) -> None:
        """Frees the instance and the states saved of it; needless a second time."""
        if self.slave is not None:
            for state in list(self._states):
                state.release()
            self.slave.freeInstance()
            self.slave = None

    def call(self, function: str, *arguments: Any) -> Any:
        """fmpy's function of that name; what the FMU refuses raises FmuError"""
        if self.slave is None:
            text = f"This instance of {self.description.modelName} is closed; open another ContactFmu."
            raise FmuError(function, Status.ERROR, [Message(Status.ERROR, "logStatusError", text)])
        before = len(self.messages)
        try:
            return getattr(self.slave, function)(*arguments)
        except FMICallException as error:
            self._raised += self.messages[before:]
            raise FmuError(error.function, error.status, self.messages[before:]) from None

    def warnings(self) -> list[str]:
        """What was logged as a warning, or as an error that no call returned, each text once"""
        told = {Status.WARNING: "", Status.DISCARD: "error logged: ", Status.ERROR: "error logged: "}
        said = [message for message in self.messages if message not in self._raised]
        return list(dict.fromkeys(told[one.status] + one.text for one in said if one.status in told))

    # life cycle

    def start(
        self,
        values: dict[str, Any] | None = None,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        """Sets the experiment and the start values and initializes; after reset() it may be called again."""
        self.call("setupExperiment", tolerance, start_time, stop_time)
        for name, value in (values or {}).items():
            self[name] = value
        self.call("enterInitializationMode")
        self.call("exitInitializationMode")
        self.time = start_time

    def step(self, size: float) -> None:
        """One communication step. Where the FMU got less far (fmi2Discard), `time` is how far, and FmuError
        is raised."""
        try:
            self.call("doStep", self.time, size)
        except FmuError as error:
            if error.status == Status.DISCARD:
                self._read_time()
            raise
        self.time += size

    def reset(self) -> None:
        """Back to a fresh instance"""
        self.call("reset")
        self.time = 0.0

    def terminate(self) -> None:
        self.call("terminate")

    def _read_time(self) -> None:
        with contextlib.suppress(FmuError):
            self.time = self.call("getRealStatus", fmi2.fmi2LastSuccessfulTime)

    # values

    def variable(self, name: str) -> Variable:
        """The variable or vector of this name; KeyError with likely names otherwise"""
        try:
            return self.variables[name]
        except KeyError:
            likely = ", ".join(difflib.get_close_matches(name, self.variables, n=3)) or "none similar"
            text = f"{self.description.modelName} has no variable '{name}' (similar: {likely})"
            raise KeyError(text) from None

    def __contains__(self, name: str) -> bool:
        return name in self.variables

    def __getitem__(self, name: str) -> Any:
        variable = self.variable(name)
        return value_of(variable, self.call(GETTERS.get(variable.type, "getInteger"), variable.references))

    def __setitem__(self, name: str, value: Any) -> None:
        variable = self.variable(name)
        self.call(SETTERS.get(variable.type, "setInteger"), variable.references, numbers_of(variable, value))

    def set_derivative(self, name: str, value: Any, order: int = 1) -> None:
        """The order-th time derivative of a Real input, from this communication point on. FMI 3.0 knows none:
        `messages` says once for each input that it is held."""
        if is_fmi3(self.description):
            text = f"{name}: FMI 3.0 has no derivatives of inputs; it is held over each communication step"
            message = Message(Status.WARNING, "importer", text)
            if message not in self.messages:
                self.messages.append(message)
            return
        references = self.variable(name).references
        values = np.atleast_1d(np.asarray(value, dtype=float)).tolist()
        self.call("setRealInputDerivatives", references, [order] * len(references), values)

    def derivative(self, name: str, order: int = 1) -> Any:
        """The order-th time derivative of a Real output"""
        variable = self.variable(name)
        orders = [order] * len(variable.references)
        values = self.call("getRealOutputDerivatives", variable.references, orders)
        return np.array(values) if variable.is_vector else values[0]

    def jacobian(self, unknown: str, known: str) -> np.ndarray:
        """d unknown / d known at the present communication point: a row for each component of the output, a
        column for each component of the input"""
        rows, columns = self.variable(unknown).references, self.variable(known).references
        directions = np.eye(len(columns)).tolist()
        found = [self.call("getDirectionalDerivative", rows, columns, one) for one in directions]
        return np.array(found).T

    # state

    def save(self) -> SavedState:
        """The whole state of the instance, kept by the FMU; bytes() of it is for files and other instances"""
        handle = self.call("getFMUstate")
        free = functools.partial(_free_state, self.slave)
        state = SavedState(self, handle, self.time, free)
        self._states.add(state)
        return state

    def restore(self, state: SavedState | bytes) -> None:
        """Back to a saved state, `time` included, of this instance or of another one of the same FMU"""
        if isinstance(state, SavedState) and state.owner() is self:
            self.call("setFMUstate", state.handle)
            self.time = state.time
            return
        handle = self.call("deSerializeFMUstate", bytes(state))
        try:
            self.call("setFMUstate", handle)
        finally:
            self.call("freeFMUstate", handle)
        if isinstance(state, SavedState):
            self.time = state.time
        else:
            self._read_time()


def _free_state(slave: fmi2.FMU2Slave, handle: Any) -> None:
    with contextlib.suppress(FMICallException):
        slave.freeFMUstate(handle)
