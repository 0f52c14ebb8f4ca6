"""The functions of FMI 3.0 and their types for ctypes, written from fmi3FunctionTypes.h"""

from __future__ import annotations

import ctypes
from ctypes import (
    POINTER,
    c_bool,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int8,
    c_int16,
    c_int32,
    c_int64,
    c_size_t,
    c_uint8,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from pathlib import Path
from typing import Any

OK, WARNING, DISCARD, ERROR, FATAL = range(5)

LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
INTERMEDIATE = ctypes.CFUNCTYPE(
    None, c_void_p, c_double, c_bool, c_bool, c_bool, c_bool, POINTER(c_bool), POINTER(c_double)
)

# C type of the elements by the name in fmi3Get..., fmi3Set...
TYPES: dict[str, Any] = {
    "Float32": c_float,
    "Float64": c_double,
    "Int8": c_int8,
    "UInt8": c_uint8,
    "Int16": c_int16,
    "UInt16": c_uint16,
    "Int32": c_int32,
    "UInt32": c_uint32,
    "Int64": c_int64,
    "UInt64": c_uint64,
    "Boolean": c_bool,
    "String": c_char_p,
}

_REFERENCES = [POINTER(c_uint32), c_size_t]
_REALS = [POINTER(c_double), c_size_t]
_WHOLE = POINTER(c_uint64)
_FLAG = POINTER(c_bool)
_STATE = POINTER(c_void_p)
_NAMED = [c_char_p, c_char_p, c_char_p, c_bool, c_bool]
_PRODUCT = [*_REFERENCES, *_REFERENCES, *_REALS, *_REALS]

# Without the instance, which comes first in all but those of WITHOUT_INSTANCE.
ARGUMENTS: dict[str, list] = {
    "GetVersion": [],
    "InstantiateModelExchange": [*_NAMED, c_void_p, LOGGER],
    "InstantiateCoSimulation": [
        *(*_NAMED, c_bool, c_bool, POINTER(c_uint32), c_size_t, c_void_p),
        *(LOGGER, INTERMEDIATE),
    ],
    "InstantiateScheduledExecution": [*_NAMED, c_void_p, LOGGER, c_void_p, c_void_p, c_void_p],
    "FreeInstance": [],
    "SetDebugLogging": [c_bool, c_size_t, POINTER(c_char_p)],
    "EnterInitializationMode": [c_bool, c_double, c_double, c_bool, c_double],
    "ExitInitializationMode": [],
    "EnterEventMode": [],
    "Terminate": [],
    "Reset": [],
    **{f"Get{name}": [*_REFERENCES, POINTER(kind), c_size_t] for name, kind in TYPES.items()},
    **{f"Set{name}": [*_REFERENCES, POINTER(kind), c_size_t] for name, kind in TYPES.items()},
    "GetBinary": [*_REFERENCES, POINTER(c_size_t), POINTER(c_void_p), c_size_t],
    "SetBinary": [*_REFERENCES, POINTER(c_size_t), POINTER(c_void_p), c_size_t],
    "GetClock": [*_REFERENCES, _FLAG],
    "SetClock": [*_REFERENCES, _FLAG],
    "GetNumberOfVariableDependencies": [c_uint32, POINTER(c_size_t)],
    "GetVariableDependencies": [
        *(c_uint32, POINTER(c_size_t), POINTER(c_uint32), POINTER(c_size_t), POINTER(c_int), c_size_t)
    ],
    "GetFMUState": [_STATE],
    "SetFMUState": [c_void_p],
    "FreeFMUState": [_STATE],
    "SerializedFMUStateSize": [c_void_p, POINTER(c_size_t)],
    "SerializeFMUState": [c_void_p, c_char_p, c_size_t],
    "DeserializeFMUState": [c_char_p, c_size_t, _STATE],
    "GetDirectionalDerivative": _PRODUCT,
    "GetAdjointDerivative": _PRODUCT,
    "EnterConfigurationMode": [],
    "ExitConfigurationMode": [],
    "GetIntervalDecimal": [*_REFERENCES, POINTER(c_double), POINTER(c_int)],
    "GetIntervalFraction": [*_REFERENCES, _WHOLE, _WHOLE, POINTER(c_int)],
    "GetShiftDecimal": [*_REFERENCES, POINTER(c_double)],
    "GetShiftFraction": [*_REFERENCES, _WHOLE, _WHOLE],
    "SetIntervalDecimal": [*_REFERENCES, POINTER(c_double)],
    "SetIntervalFraction": [*_REFERENCES, _WHOLE, _WHOLE],
    "SetShiftDecimal": [*_REFERENCES, POINTER(c_double)],
    "SetShiftFraction": [*_REFERENCES, _WHOLE, _WHOLE],
    "EvaluateDiscreteStates": [],
    "UpdateDiscreteStates": [_FLAG, _FLAG, _FLAG, _FLAG, _FLAG, POINTER(c_double)],
    "EnterContinuousTimeMode": [],
    "CompletedIntegratorStep": [c_bool, _FLAG, _FLAG],
    "SetTime": [c_double],
    "SetContinuousStates": _REALS,
    "GetContinuousStateDerivatives": _REALS,
    "GetEventIndicators": _REALS,
    "GetContinuousStates": _REALS,
    "GetNominalsOfContinuousStates": _REALS,
    "GetNumberOfEventIndicators": [POINTER(c_size_t)],
    "GetNumberOfContinuousStates": [POINTER(c_size_t)],
    "EnterStepMode": [],
    "GetOutputDerivatives": [*_REFERENCES, POINTER(c_int32), *_REALS],
    "DoStep": [c_double, c_double, c_bool, _FLAG, _FLAG, _FLAG, POINTER(c_double)],
    "ActivateModelPartition": [c_uint32, c_double],
}
WITHOUT_INSTANCE = ("GetVersion", *(name for name in ARGUMENTS if name.startswith("Instantiate")))
RESULTS = {"GetVersion": c_char_p, "FreeInstance": None}


def bind(library_file: str | Path) -> ctypes.CDLL:
    """The library with the prototypes of its functions"""
    library = ctypes.CDLL(str(library_file))
    for name, arguments in ARGUMENTS.items():
        function = getattr(library, f"fmi3{name}")
        function.argtypes = arguments if name in WITHOUT_INSTANCE else [c_void_p, *arguments]
        function.restype = RESULTS.get(name, c_void_p if name.startswith("Instantiate") else c_int)
    return library
