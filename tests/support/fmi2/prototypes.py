"""The functions of FMI 2.0 and their types for ctypes, written from fmi2FunctionTypes.h"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
MODEL_EXCHANGE, CO_SIMULATION = range(2)
DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED = range(4)

LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
ALLOCATE = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
FREE = ctypes.CFUNCTYPE(None, c_void_p)
FINISHED = ctypes.CFUNCTYPE(None, c_void_p, c_int)


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions"""

    _fields_ = [
        ("logger", LOGGER),
        ("allocate", ALLOCATE),
        ("free", FREE),
        ("finished", FINISHED),
        ("environment", c_void_p),
    ]


class EventInfo(ctypes.Structure):
    """fmi2EventInfo"""

    _fields_ = [
        ("again", c_int),
        ("terminate", c_int),
        ("nominals_changed", c_int),
        ("states_changed", c_int),
        ("next_event_defined", c_int),
        ("next_event", c_double),
    ]


_GET_SET = [c_void_p, POINTER(c_uint), c_size_t]
_STATE_OUT = POINTER(c_void_p)
ARGUMENTS: dict[str, list] = {
    "fmi2GetTypesPlatform": [],
    "fmi2GetVersion": [],
    "fmi2SetDebugLogging": [c_void_p, c_int, c_size_t, POINTER(c_char_p)],
    "fmi2Instantiate": [c_char_p, c_int, c_char_p, c_char_p, POINTER(Callbacks), c_int, c_int],
    "fmi2FreeInstance": [c_void_p],
    "fmi2SetupExperiment": [c_void_p, c_int, c_double, c_double, c_int, c_double],
    "fmi2EnterInitializationMode": [c_void_p],
    "fmi2ExitInitializationMode": [c_void_p],
    "fmi2Terminate": [c_void_p],
    "fmi2Reset": [c_void_p],
    "fmi2GetReal": [*_GET_SET, POINTER(c_double)],
    "fmi2GetInteger": [*_GET_SET, POINTER(c_int)],
    "fmi2GetBoolean": [*_GET_SET, POINTER(c_int)],
    "fmi2GetString": [*_GET_SET, POINTER(c_char_p)],
    "fmi2SetReal": [*_GET_SET, POINTER(c_double)],
    "fmi2SetInteger": [*_GET_SET, POINTER(c_int)],
    "fmi2SetBoolean": [*_GET_SET, POINTER(c_int)],
    "fmi2SetString": [*_GET_SET, POINTER(c_char_p)],
    "fmi2GetFMUstate": [c_void_p, _STATE_OUT],
    "fmi2SetFMUstate": [c_void_p, c_void_p],
    "fmi2FreeFMUstate": [c_void_p, _STATE_OUT],
    "fmi2SerializedFMUstateSize": [c_void_p, c_void_p, POINTER(c_size_t)],
    "fmi2SerializeFMUstate": [c_void_p, c_void_p, c_char_p, c_size_t],
    "fmi2DeSerializeFMUstate": [c_void_p, c_char_p, c_size_t, _STATE_OUT],
    "fmi2GetDirectionalDerivative": [
        c_void_p,
        POINTER(c_uint),
        c_size_t,
        POINTER(c_uint),
        c_size_t,
        POINTER(c_double),
        POINTER(c_double),
    ],
    "fmi2SetRealInputDerivatives": [*_GET_SET, POINTER(c_int), POINTER(c_double)],
    "fmi2GetRealOutputDerivatives": [*_GET_SET, POINTER(c_int), POINTER(c_double)],
    "fmi2DoStep": [c_void_p, c_double, c_double, c_int],
    "fmi2CancelStep": [c_void_p],
    "fmi2GetStatus": [c_void_p, c_int, POINTER(c_int)],
    "fmi2GetRealStatus": [c_void_p, c_int, POINTER(c_double)],
    "fmi2GetIntegerStatus": [c_void_p, c_int, POINTER(c_int)],
    "fmi2GetBooleanStatus": [c_void_p, c_int, POINTER(c_int)],
    "fmi2GetStringStatus": [c_void_p, c_int, POINTER(c_char_p)],
    "fmi2EnterEventMode": [c_void_p],
    "fmi2NewDiscreteStates": [c_void_p, POINTER(EventInfo)],
    "fmi2EnterContinuousTimeMode": [c_void_p],
    "fmi2CompletedIntegratorStep": [c_void_p, c_int, POINTER(c_int), POINTER(c_int)],
    "fmi2SetTime": [c_void_p, c_double],
    "fmi2SetContinuousStates": [c_void_p, POINTER(c_double), c_size_t],
    "fmi2GetDerivatives": [c_void_p, POINTER(c_double), c_size_t],
    "fmi2GetEventIndicators": [c_void_p, POINTER(c_double), c_size_t],
    "fmi2GetContinuousStates": [c_void_p, POINTER(c_double), c_size_t],
    "fmi2GetNominalsOfContinuousStates": [c_void_p, POINTER(c_double), c_size_t],
}
RESULTS = {
    "fmi2GetTypesPlatform": c_char_p,
    "fmi2GetVersion": c_char_p,
    "fmi2Instantiate": c_void_p,
    "fmi2FreeInstance": None,
}


def bind(library_file: str | Path) -> ctypes.CDLL:
    """The library with the prototypes of its functions"""
    library = ctypes.CDLL(str(library_file))
    for name, arguments in ARGUMENTS.items():
        function = getattr(library, name)
        function.argtypes = arguments
        function.restype = RESULTS.get(name, c_int)
    return library


def array(kind: Any, values: Iterable) -> Any:
    values = list(values)
    return (kind * len(values))(*values)
