"""FMI 3.0 calls by ctypes, without an importer's kindness: any function, any arguments, any status."""

from __future__ import annotations

import ctypes
import functools
import os
import re
from collections.abc import Callable, Iterable
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_int, c_int32, c_uint32, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contact_fmus.fmu.files import repository, unpack
from support import prototypes
from support.fmi2 import raw as fmi2

ALL, KINDS, SCENES = fmi2.ALL, fmi2.KINDS, fmi2.SCENES
OK, WARNING, DISCARD, ERROR, FATAL = range(5)
LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
INTERMEDIATE = ctypes.CFUNCTYPE(
    None, c_void_p, c_double, c_bool, c_bool, c_bool, c_bool, POINTER(c_bool), POINTER(c_double)
)
OTHERS = ("fmi3ClockUpdateCallback", "fmi3LockPreemptionCallback", "fmi3UnlockPreemptionCallback")
CALLBACKS = {"fmi3LogMessageCallback": LOGGER, "fmi3IntermediateUpdateCallback": INTERMEDIATE}
PROTOTYPES = prototypes.read(3, CALLBACKS | dict.fromkeys(OTHERS, c_void_p))

_NAMES = [name.removeprefix("fmi3") for name in PROTOTYPES]
WITHOUT_INSTANCE = [name for name in _NAMES if name.startswith(("GetVersion", "Instantiate"))]
# Without the instance, which comes first in all but those of WITHOUT_INSTANCE.
ARGUMENTS = {name: PROTOTYPES[f"fmi3{name}"].arguments[name not in WITHOUT_INSTANCE :] for name in _NAMES}
# C type of the elements by the name in fmi3Get..., fmi3Set...
TYPES: dict[str, Any] = {
    name.removeprefix("Get"): ARGUMENTS[name][2]._type_
    for name in _NAMES
    if re.fullmatch(r"Get(Float|U?Int|Boolean|String)\d*", name)
}

BUILD = Path(os.environ.get("CONTACT_BUILD", repository() / "build")).resolve()
FMUS = BUILD / "fmus-fmi3"


class Variable(NamedTuple):
    """A variable of the model description"""

    name: str
    reference: int
    type: str  # Float64 | Int32 | Boolean | Enumeration
    causality: str
    length: int  # 1 for a scalar
    items: tuple[str, ...]  # an enumeration's item names, whose values run from 1 on

    @property
    def call_type(self) -> str:
        """Returns the part of fmi3Get... and fmi3Set... that fits."""
        return "Int64" if self.type == "Enumeration" else self.type


class Fmu(prototypes.AnyFmu):
    """An unpacked FMU with its loaded library"""

    def __init__(self, path: Path):
        self.folder, self.description = unpack(path, "3.0")
        self.name = self.description.coSimulation.modelIdentifier
        self.token = self.description.instantiationToken
        self.library_file = next(self.folder.glob(f"binaries/*/{self.name}.so"))
        self.library = prototypes.bind(self.library_file, PROTOTYPES)
        self.variables = {one.name: _variable(one) for one in self.description.modelVariables}
        self.roles = _roles(self.description)


def _variable(found: Any) -> Variable:
    length = int(np.prod([int(one.start) for one in found.dimensions])) if found.dimensions else 1
    items = tuple(item.name for item in found.declaredType.items) if found.type == "Enumeration" else ()
    return Variable(found.name, found.valueReference, found.type, found.causality, length, items)


def _roles(description: Any) -> dict[str, list[str]]:
    """Returns names of the states, of their rates, and of the event indicators, component by component."""
    rates = [entry.variable for entry in description.derivatives]
    roles = {"state": [one.derivative for one in rates], "rate": rates}
    roles["indicator"] = [entry.variable for entry in description.eventIndicators]
    return {role: [name for one in found for name in _components(one)] for role, found in roles.items()}


def _components(found: Any) -> list[str]:
    length = _variable(found).length
    return [found.name] if length == 1 else [f"{found.name}[{k}]" for k in range(1, length + 1)]


@functools.cache
def load(name: str) -> Fmu:
    return Fmu(FMUS / f"{name}.fmu")


class Step(NamedTuple):
    """What fmi3DoStep said"""

    status: int
    event: bool
    terminate: bool
    early: bool
    time: float


def references(variables: Iterable[Variable]) -> Any:
    values = [variable.reference for variable in variables]
    return (c_uint32 * len(values))(*values)


def reals(values: Iterable[float]) -> Any:
    values = list(values)
    return (c_double * len(values))(*values)


class Instance(prototypes.AnyInstance):
    """An instance and everything its logger was told"""

    prefix = "fmi3"

    def __init__(
        self,
        fmu: Fmu,
        name: bytes | None = b"tested",
        token: bytes | None = b"",
        logging: bool = False,
        event_mode: bool = False,
        early_return: bool = False,
        required: Iterable[int] = (),
        update: Callable | None = None,
        exchange: bool = False,
    ):
        self.fmu, self.exchange = fmu, exchange
        self.messages: list[prototypes.Message] = []
        self.logger = LOGGER(self._log)
        self.update = INTERMEDIATE(functools.partial(self._update, update)) if update else INTERMEDIATE()
        required = list(required)
        identity = (name, fmu.token.encode() if token == b"" else token, b"", False, logging)
        if exchange:
            self.component = fmu.library.fmi3InstantiateModelExchange(*identity, None, self.logger)
            return
        self.component = fmu.library.fmi3InstantiateCoSimulation(
            *identity,
            *(event_mode, early_return, (c_uint32 * len(required))(*required), len(required), None),
            *(self.logger, self.update),
        )

    def _log(self, _environment, status, category, message) -> None:
        self.messages.append(prototypes.Message(status, category.decode(), message.decode()))

    def _update(self, update, _environment, time, *told) -> None:
        """`update(time, set_requested, get_allowed, finished, can_return)` answers when to return, or None"""
        *flags, requested, when = told
        answer = update(time, *flags)
        if answer is not None:
            requested[0], when[0] = True, answer

    # by names

    def set_one(self, name: str, value: Any) -> int:
        variable = self.fmu.variables[name]
        if isinstance(value, str):
            value = 1 + variable.items.index(value)
        values = list(value) if isinstance(value, list | tuple | np.ndarray) else [value]
        array = (TYPES[variable.call_type] * len(values))(*values)
        return self.call(f"Set{variable.call_type}", references([variable]), 1, array, len(values))

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            assert self.set_one(name, value) <= WARNING, f"{name} = {value}: {self.texts()}"

    def get(self, name: str) -> Any:
        variable = self.fmu.variables[name]
        values = (TYPES[variable.call_type] * variable.length)()
        self.ok(f"Get{variable.call_type}", references([variable]), 1, values, variable.length)
        return values[0] if variable.length == 1 else list(values)

    def bits(self, *causalities: str) -> dict[str, bytes]:
        """Returns name -> bytes of every value of the given causalities."""
        return {one.name: np.asarray(self.get(one.name)).tobytes() for one in self.fmu.select(*causalities)}

    # life cycle

    def step(self, time: float, size: float) -> Step:
        told = [c_bool(True), c_bool(True), c_bool(True), c_double(np.nan)]
        status = self.call("DoStep", time, size, True, *map(byref, told))
        return Step(status, *(one.value for one in told))

    def handle_event(self, enter: bool = True) -> None:
        """Visits event mode once, as an importer does."""
        if enter:
            self.ok("EnterEventMode")
        assert self.update_discrete_states() == (False, False, None)
        self.ok("EnterStepMode")

    # Model Exchange

    RATES = "GetContinuousStateDerivatives"

    def update_discrete_states(self) -> tuple[bool, bool, float | None]:
        """Returns whether to update again, whether a state has jumped, and when the next event will be."""
        again, terminate, nominals, jumped, scheduled = flags = [c_bool(True) for _ in range(5)]
        time = c_double()
        self.ok("UpdateDiscreteStates", *map(byref, flags), byref(time))
        assert not terminate.value and not nominals.value
        return again.value, jumped.value, time.value if scheduled.value else None

    def complete_step(self) -> None:
        enter, terminate = c_bool(True), c_bool(True)
        self.ok("CompletedIntegratorStep", True, byref(enter), byref(terminate))
        assert not enter.value and not terminate.value

    # derivatives

    def product(self, kind: str, unknowns: list[Variable], knowns: list[Variable], seed) -> np.ndarray:
        """kind: Directional or Adjoint"""
        result = unknowns if kind == "Directional" else knowns
        count = sum(one.length for one in result)
        values = (c_double * count)()
        self.ok(
            f"Get{kind}Derivative",
            *(references(unknowns), len(unknowns), references(knowns), len(knowns)),
            *(reals(seed), len(seed), values, count),
        )
        return np.array(values)

    def output_derivative(self, name: str, order: int) -> list[float]:
        variable = self.fmu.variables[name]
        values = (c_double * variable.length)()
        orders = (c_int32 * 1)(order)
        self.ok("GetOutputDerivatives", references([variable]), 1, orders, values, variable.length)
        return list(values)

    # states

    def restore(self, blob: bytes) -> int:
        state = c_void_p()
        status = self.call("DeserializeFMUState", blob, len(blob), byref(state))
        if status == OK:
            self.ok("SetFMUState", state)
            self.ok("FreeFMUState", byref(state))
        return status
