"""FMI 2.0 calls by ctypes, without an importer's kindness: any function, any arguments, any status."""

from __future__ import annotations

import copy
import ctypes
import functools
import struct
from collections.abc import Iterable
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

from contact_fmus.fmu.files import fmu_file, repository, unpack
from support import prototypes

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
MODEL_EXCHANGE, CO_SIMULATION = range(2)
DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED = range(4)

LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
ALLOCATE = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
FREE = ctypes.CFUNCTYPE(None, c_void_p)


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions"""

    _fields_ = [("logger", LOGGER), ("allocate", ALLOCATE), ("free", FREE)]
    _fields_ += [("finished", c_void_p), ("environment", c_void_p)]


class EventInfo(ctypes.Structure):
    """fmi2EventInfo"""

    _fields_ = [(flag, c_int) for flag in ("again", "terminate", "nominals_changed", "states_changed")]
    _fields_ += [("next_event_defined", c_int), ("next_event", c_double)]


PROTOTYPES = prototypes.read(2, {"fmi2CallbackFunctions": Callbacks, "fmi2EventInfo": EventInfo})
ARGUMENTS = {name: prototype.arguments for name, prototype in PROTOTYPES.items()}
TYPES = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}


def array(kind: Any, values: Iterable) -> Any:
    values = list(values)
    return (kind * len(values))(*values)


# All scenes, and those of a pair, whose variables a test can name
SEVERAL = ("BallBearing", "FootForceElement", "GaltonBoard", "GroovedBearing", "NewtonsCradle", "PinInHole")
SEVERAL += ("Tripod",)
ALL = sorted(path.stem for path in (repository() / "modelDescription" / "scenes").glob("*.toml"))
SCENES = [one for one in ALL if one not in SEVERAL]
# Every choice open; bodies that cannot move freely; everything pinned, and no CVODE.
KINDS = ("SphereCylinder", "ForceElement", "PinnedEvent")
# A body may move freely: every choice open, pinned, Hertz's law, friction, no CVODE.
SOLVER_SCENES = ("SphereCylinder", "BallOffRoller", "HertzImpact", "GolfersDilemma", "PinnedEvent")
WITHOUT_CVODE = ("BouncingBall", "PinnedEvent")  # pinned to event_driven, no body in two contacts


class Variable(NamedTuple):
    """A ScalarVariable of the model description"""

    name: str
    reference: int
    type: str  # Real | Integer | Boolean | Enumeration
    causality: str
    start: str | None
    minimum: float
    maximum: float
    items: tuple[str, ...]  # an enumeration's item names; their values run from `minimum` on
    variability: str
    length: int = 1

    @property
    def call_type(self) -> str:
        """Returns the part of fmi2Get... and fmi2Set... that fits."""
        return "Integer" if self.type == "Enumeration" else self.type

    @property
    def start_value(self) -> float | int:
        return _number(self.start, self.type)


def _number(text: str, kind: str) -> float | int:
    if kind == "Real":
        return float(text)
    return {"true": 1, "false": 0}[text] if kind == "Boolean" else int(text)


class Fmu(prototypes.AnyFmu):
    """An unpacked FMU with its loaded library"""

    def __init__(self, path: Path):
        self.folder, description = unpack(path)
        self.name = description.coSimulation.modelIdentifier
        self.guid = description.guid
        self.variables = {one.name: _variable(one) for one in description.modelVariables}
        self.roles = _roles(description)
        self._open(next(self.folder.glob(f"binaries/*/{self.name}.so")))

    def _open(self, library_file: Path) -> None:
        self.library_file = library_file
        self.library = prototypes.bind(library_file, PROTOTYPES)

    def with_library(self, library_file: Path) -> Fmu:
        """Returns the same FMU with another build of its code."""
        other = copy.copy(self)
        other._open(library_file)
        return other


def _roles(description: Any) -> dict[str, list[str]]:
    """Returns names of the states, of their rates and of the event indicators, in their vectors' order."""
    rates = [entry.variable for entry in description.derivatives]
    indicators = [one.name for one in description.modelVariables if one.name.endswith("_indicator")]
    assert len(indicators) == description.numberOfEventIndicators
    values = {"state": [rate.derivative.name for rate in rates], "rate": [rate.name for rate in rates]}
    values |= {"indicator": indicators}
    return values


def _variable(scalar: Any) -> Variable:
    declared, enumeration = scalar.declaredType, scalar.type == "Enumeration"
    items = declared.items if enumeration else []
    values = [int(item.value) for item in items] or [0, 1]
    wide = (-1.8e308, 1.8e308) if scalar.type in ("Real", "Integer") else (values[0], values[-1])
    low, high = (
        next((x for x in (getattr(scalar, name), getattr(declared, name, None)) if x is not None), limit)
        for name, limit in zip(("min", "max"), wide, strict=True)
    )
    names = tuple(item.name for item in items)
    about = (scalar.name, scalar.valueReference, scalar.type, scalar.causality, scalar.start)
    return Variable(*about, float(low), float(high), names, scalar.variability)


@functools.cache
def load(name: str) -> Fmu:
    return Fmu(fmu_file(name))


class Message(NamedTuple):
    """One call of the logger; `raw` is the printf format as it came, `text` what it says"""

    status: int
    category: str
    raw: str

    @property
    def text(self) -> str:
        return self.raw.replace("%%", "%").replace("##", "#")


class Instance(prototypes.AnyInstance):
    """An instance and everything its logger was told"""

    prefix, STATE = "fmi2", "FMUstate"

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
        identity = (name, kind, fmu.guid.encode() if guid == b"" else guid, resources)
        self.component = fmu.library.fmi2Instantiate(*identity, byref(self.callbacks), 0, int(logging))

    def _log(self, _environment, name, status, category, message) -> None:
        self.loggers.append(name)
        self.messages.append(Message(status, category.decode(), message.decode()))

    # by names

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            for variable, number in self._scalars(name, value):
                assert self.set_one(variable, number) <= WARNING, (variable.name, number, self.texts())

    def _scalars(self, name: str, value: Any) -> Iterable[tuple[Variable, float | int]]:
        variables = self.fmu.variables
        if name not in variables:
            return [(variables[f"{name}[{index + 1}]"], number) for index, number in enumerate(value)]
        variable = variables[name]
        if isinstance(value, str):
            value = int(variable.minimum) + variable.items.index(value)
        return [(variable, value)]

    def set_one(self, variable: Variable, value: float | int) -> int:
        values = array(c_double if variable.type == "Real" else c_int, [value])
        return self.call(f"Set{variable.call_type}", array(c_uint, [variable.reference]), 1, values)

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
        """Returns name -> bytes of every value, or of the given causalities: equal only when the bits are."""
        chosen = self.fmu.select(*causalities) if causalities else self.fmu.variables.values()
        return {
            variable.name: struct.pack("<d" if variable.type == "Real" else "<i", self.get_one(variable))
            for variable in chosen
        }

    def reals(self, variables: Iterable[Variable]) -> list[float]:
        """Returns values of Real variables in one call."""
        references = [variable.reference for variable in variables]
        values = array(c_double, [0.0] * len(references))
        self.ok("GetReal", array(c_uint, references), len(references), values)
        return list(values)

    def directional(self, unknowns: list[int], knowns: list[int], seed: list[float]) -> tuple[int, list]:
        """Returns status and values of a directional derivative, by value references."""
        values = array(c_double, [0.0] * len(unknowns))
        about = (array(c_uint, unknowns), len(unknowns), array(c_uint, knowns), len(knowns))
        return self.call("GetDirectionalDerivative", *about, array(c_double, seed), values), list(values)

    def output_derivatives(self, variables: Iterable[Variable], order: int) -> list[float]:
        references = [variable.reference for variable in variables]
        values, count = array(c_double, [0.0] * len(references)), len(references)
        orders = array(c_int, [order] * count)
        self.ok("GetRealOutputDerivatives", array(c_uint, references), count, orders, values)
        return list(values)

    def feed(self, name: str, order: int, values: Iterable[float]) -> None:
        """Sets a derivative of an input that is a vector."""
        references = array(c_uint, [self.fmu.variables[f"{name}[{k}]"].reference for k in (1, 2, 3)])
        self.ok("SetRealInputDerivatives", references, 3, array(c_int, [order] * 3), array(c_double, values))

    # life cycle

    def run(self, steps: Iterable[float], start: float = 0.0) -> list[dict[str, bytes]]:
        """Returns the bits of all outputs after each step."""
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
        self.ok("GetRealStatus", LAST_SUCCESSFUL_TIME, byref(time))
        return time.value

    # Model Exchange

    RATES = "GetDerivatives"

    def update_discrete_states(self) -> tuple[bool, bool, float | None]:
        """Returns whether to update again, whether a state has jumped, and when the next event will be."""
        news = EventInfo()
        self.ok("NewDiscreteStates", byref(news))
        scheduled = news.next_event if news.next_event_defined else None
        return bool(news.again), bool(news.states_changed), scheduled

    def complete_step(self) -> None:
        self.ok("CompletedIntegratorStep", 1, byref(c_int()), byref(c_int()))

    # states

    def taken(self) -> c_void_p:
        """Saves the present state, which the importer has to free."""
        state = c_void_p()
        self.ok("GetFMUstate", byref(state))
        return state

    def deserialize(self, blob: bytes) -> tuple[int, c_void_p]:
        state = c_void_p()
        return self.call("DeSerializeFMUstate", blob, len(blob), byref(state)), state

    def restore(self, blob: bytes) -> None:
        status, state = self.deserialize(blob)
        assert status == OK, self.texts()
        self.ok("SetFMUstate", state)
        self.ok("FreeFMUstate", byref(state))
