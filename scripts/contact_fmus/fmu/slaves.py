"""Instances of FMI 2.0 and FMI 3.0 by one set of functions: those that fmpy gives an FMI 2.0 slave

    slave = slave_of(description, folder, "my name")
    slave.begin(log, debug=False)            # log(status, category, text)
    slave.setupExperiment(1e-8, 0.0, None)
    slave.getReal(references)                # of variables.scalars, so that an entry of an array has its own

What FMI 3.0 does otherwise is in FMU3Scalars; nothing else needs to know of it.
"""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

from contact_fmus.errors import UserError

from .variables import entries, is_fmi3

Log = Callable[[int, str, str], None]
DISCARD = 2  # fmi2Discard, fmi3Discard


def slave_of(description: Any, folder: Any, name: str | None = None) -> Any:
    """A slave whose library is loaded; fmpy raises what it raises where that does not load"""
    kind = FMU3Scalars if is_fmi3(description) else FMU2Scalars
    identifier = description.coSimulation.modelIdentifier
    slave = kind(
        guid=description.guid,  # fmpy keeps FMI 3.0's token there too
        unzipDirectory=str(folder),
        modelIdentifier=identifier,
        instanceName=name or identifier,
    )
    slave.describe(description)
    return slave


def text_of(message: bytes | None) -> str:
    return (message or b"").decode("utf-8", "replace").replace("%%", "%")


# fmpy looks for the functions of the version that a class is named by: FMU2..., FMU3...
class FMU2Scalars(fmi2.FMU2Slave):
    def describe(self, _description: Any) -> None:
        self._arguments: dict[tuple[int, ...], tuple] = {}

    def begin(self, log: Log, debug: bool) -> None:
        # fmpy's own logger proxy is one per process; this callback is one per instance. A function without
        # variable arguments may stand in for the logger: the FMU formats its messages itself and doubles '%'.
        def logger(_environment, _instance, status, category, message) -> None:
            log(status, (category or b"").decode(), text_of(message))

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(logger)
        callbacks.allocateMemory = ctypes.cast(fmpy.calloc, fmi2.fmi2CallbackAllocateMemoryTYPE)
        callbacks.freeMemory = ctypes.cast(fmpy.free, fmi2.fmi2CallbackFreeMemoryTYPE)
        self.instantiate(callbacks=callbacks, loggingOn=debug)

    def reals(self, references: tuple[int, ...]) -> Any:
        """Recording reads the same few names at every step, so their argument arrays are kept."""
        if references not in self._arguments:
            size = len(references)
            arrays = (ctypes.c_uint * size)(*references), (ctypes.c_double * size)()
            self._arguments[references] = arrays
        found, values = self._arguments[references]
        self.fmi2GetReal(self.component, found, len(references), values)
        return values


class FMU3Scalars(fmi3.FMU3Slave):
    """References are places in variables.scalars; arrays are read and written whole."""

    def describe(self, description: Any) -> None:
        self._entries = entries(description)
        self._plans: dict[tuple[int, ...], tuple[dict[str, list], list[tuple[str, int]]]] = {}
        self._given: dict[int, list] = {}  # what arrays were set to, by value reference
        self._experiment: tuple = (None, 0.0, None)
        times = [one for one in description.modelVariables if one.causality == "independent"]
        self._time = [one.valueReference for one in times]

    def begin(self, log: Log, debug: bool) -> None:
        self._log = log

        def logger(_environment, status, category, message) -> None:
            log(status, (category or b"").decode(), text_of(message))

        self.instantiate(loggingOn=debug, logMessage=logger)

    # life cycle

    def setupExperiment(self, tolerance=None, startTime=0.0, stopTime=None) -> None:
        self._experiment = (tolerance, startTime, stopTime)

    def enterInitializationMode(self) -> None:
        super().enterInitializationMode(*self._experiment)

    def reset(self) -> None:
        super().reset()
        self._given.clear()

    def doStep(self, currentCommunicationPoint: float, communicationStepSize: float) -> None:
        event, ended, early = fmi3.fmi3Boolean(), fmi3.fmi3Boolean(), fmi3.fmi3Boolean()
        last = fmi3.fmi3Float64(currentCommunicationPoint)
        told = [ctypes.byref(one) for one in (event, ended, early, last)]
        again = fmi3.fmi3Boolean(True)  # no state of before this point will be restored
        self.fmi3DoStep(self.component, currentCommunicationPoint, communicationStepSize, again, *told)
        if ended.value:  # FMI 2.0 says this by fmi2Discard
            self._log(DISCARD, "importer", "The FMU asks for the end of the simulation.")
            raise FMICallException("fmi3DoStep", DISCARD)

    def getRealStatus(self, _kind: int) -> float:
        """fmi2LastSuccessfulTime, the only one that is asked for: the independent variable"""
        return super().getFloat64(self._time)[0]

    # values

    def _plan(self, references: Sequence[int]) -> tuple[dict[str, list], list[tuple[str, int]]]:
        """The variables to call for, by FMI's type, and where each scalar is found among their values"""
        key = tuple(references)
        if key not in self._plans:
            groups: dict[str, list] = {}
            begins: dict[int, int] = {}
            places = []
            for reference in key:
                variable, index, size = self._entries[reference]
                kind = "Int64" if variable.type == "Enumeration" else variable.type
                group = groups.setdefault(kind, [])
                if variable.valueReference not in begins:
                    begins[variable.valueReference] = sum(one[1] for one in group)
                    group.append((variable.valueReference, size))
                places.append((kind, begins[variable.valueReference] + index))
            self._plans[key] = groups, places
        return self._plans[key]

    def _get(self, references: Sequence[int]) -> list:
        groups, places = self._plan(references)
        fmi = super()
        values = {
            kind: getattr(fmi, f"get{kind}")([one for one, _ in group], sum(size for _, size in group))
            for kind, group in groups.items()
        }
        return [values[kind][place] for kind, place in places]

    reals = getReal = getInteger = getBoolean = _get

    def _set(self, references: Sequence[int], values: Sequence) -> None:
        """The other entries of an array keep what they were set to, or their start values."""
        wholes: dict[int, tuple[str, list]] = {}
        for reference, value in zip(references, values, strict=True):
            variable, index, size = self._entries[reference]
            kind = "Int64" if variable.type == "Enumeration" else variable.type
            if variable.valueReference not in wholes:
                known = self._given.get(variable.valueReference) or _start(variable, size)
                wholes[variable.valueReference] = kind, list(known)
            wholes[variable.valueReference][1][index] = value
        for kind in dict.fromkeys(kind for kind, _ in wholes.values()):
            chosen = {one: whole for one, (other, whole) in wholes.items() if other == kind}
            getattr(super(), f"set{kind}")(list(chosen), [value for whole in chosen.values() for value in whole])
            self._given |= chosen

    setReal = setInteger = setBoolean = _set

    def setString(self, references: Sequence[int], values: Sequence[str]) -> None:
        super().setString([self._entries[one][0].valueReference for one in references], values)

    def setRealInputDerivatives(self, *_arguments: Any) -> None:
        raise UserError("FMI 3.0 has no derivatives of inputs")

    def getRealOutputDerivatives(self, references: Sequence[int], orders: Sequence[int]) -> list[float]:
        groups, places = self._plan(references)
        (group,) = groups.values()
        count = sum(size for _, size in group)
        (order,) = set(orders)
        values = (ctypes.c_double * count)()
        self.fmi3GetOutputDerivatives(
            self.component,
            (ctypes.c_uint32 * len(group))(*(one for one, _ in group)),
            len(group),
            (ctypes.c_int32 * len(group))(*[order] * len(group)),
            values,
            count,
        )
        return [values[place] for _, place in places]

    def getDirectionalDerivative(
        self, unknowns: Sequence[int], knowns: Sequence[int], seed: Sequence[float]
    ) -> list[float]:
        (rows, wanted), (columns, given) = self._plan(unknowns), self._plan(knowns)
        (of_unknowns,), (of_knowns,) = rows.values(), columns.values()
        whole = [0.0] * sum(size for _, size in of_knowns)
        for (_, place), value in zip(given, seed, strict=True):
            whole[place] = value
        found = super().getDirectionalDerivative(
            [one for one, _ in of_unknowns], [one for one, _ in of_knowns], whole, sum(size for _, size in of_unknowns)
        )
        return [found[place] for _, place in wanted]

    # states, whose functions FMI 2.0 spells otherwise

    getFMUstate, setFMUstate = fmi3.FMU3Slave.getFMUState, fmi3.FMU3Slave.setFMUState
    freeFMUstate, serializeFMUstate = fmi3.FMU3Slave.freeFMUState, fmi3.FMU3Slave.serializeFMUState
    deSerializeFMUstate = fmi3.FMU3Slave.deserializeFMUState


def _start(variable: Any, size: int) -> list:
    texts = str(variable.start if variable.start is not None else "0").split()
    texts = texts if len(texts) == size else ["0"] * size
    if variable.type.startswith("Float"):
        return [float(text) for text in texts]
    if variable.type == "Boolean":
        return [text in ("true", "1") for text in texts]
    return [int(text) for text in texts]
