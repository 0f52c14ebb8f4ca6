"""An FMU as a file: its description, its loaded library, the functions by ctypes.

The prototypes below are written from fmi2FunctionTypes.h. Instances of the FMU are raw.py's.
"""

from __future__ import annotations

import atexit
import copy
import ctypes
import functools
import os
import shutil
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Iterable
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
MODEL_EXCHANGE, CO_SIMULATION = range(2)
DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED = range(4)

REPOSITORY = Path(__file__).resolve().parents[3]
SCENES = sorted(path.stem for path in (REPOSITORY / "modelDescription" / "scenes").glob("*.toml"))

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
}
RESULTS = {
    "fmi2GetTypesPlatform": c_char_p,
    "fmi2GetVersion": c_char_p,
    "fmi2Instantiate": c_void_p,
    "fmi2FreeInstance": None,
}


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

    @property
    def call_type(self) -> str:
        """The part of fmi2Get... and fmi2Set... that fits"""
        return "Integer" if self.type == "Enumeration" else self.type

    @property
    def settable(self) -> bool:
        return self.causality in ("parameter", "input")

    @property
    def start_value(self) -> float | int:
        return _number(self.start, self.type)


def _number(text: str, kind: str) -> float | int:
    if kind == "Real":
        return float(text)
    return {"true": 1, "false": 0}[text] if kind == "Boolean" else int(text)


class Fmu:
    """An unpacked FMU with its loaded library"""

    def __init__(self, path: Path):
        self.folder = Path(tempfile.mkdtemp(prefix=f"{path.stem}-"))
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)
        with zipfile.ZipFile(path) as archive:
            archive.extractall(self.folder)
        root = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.name = root.find("CoSimulation").get("modelIdentifier")
        self.guid = root.get("guid")
        self.variables = {variable.name: variable for variable in _read_variables(root)}
        self._open(next(self.folder.glob(f"binaries/*/{self.name}.so")))

    def _open(self, library_file: Path) -> None:
        self.library_file = library_file
        self.library = ctypes.CDLL(str(library_file))
        for name, arguments in ARGUMENTS.items():
            function = getattr(self.library, name)
            function.argtypes = arguments
            function.restype = RESULTS.get(name, c_int)

    def with_library(self, library_file: Path) -> Fmu:
        """The same FMU with another build of its code"""
        other = copy.copy(self)
        other._open(library_file)
        return other

    def select(self, *causalities: str, kind: str | None = None) -> list[Variable]:
        return [
            variable
            for variable in self.variables.values()
            if variable.causality in causalities and kind in (None, variable.type)
        ]


def _read_variables(root: ElementTree.Element) -> Iterable[Variable]:
    declared = {node.get("name"): node[0] for node in root.findall("TypeDefinitions/SimpleType")}
    for node in root.findall("ModelVariables/ScalarVariable"):
        value = node[0]
        simple = declared.get(value.get("declaredType"))
        merged = {**(simple.attrib if simple is not None else {}), **value.attrib}
        items = tuple(item.get("name") for item in simple.iter("Item")) if value.tag == "Enumeration" else ()
        values = [int(item.get("value")) for item in simple.iter("Item")] if items else [0, 1]
        low, high = (
            (values[0], values[-1]) if value.tag in ("Enumeration", "Boolean") else (-1.8e308, 1.8e308)
        )
        yield Variable(
            node.get("name"),
            int(node.get("valueReference")),
            value.tag,
            node.get("causality"),
            value.get("start"),
            float(merged.get("min", low)),
            float(merged.get("max", high)),
            items,
        )


def fmus_folder() -> Path:
    return Path(os.environ.get("CONTACT_FMUS") or REPOSITORY / "build" / "fmus")


@functools.cache
def load(name: str) -> Fmu:
    path = fmus_folder() / f"{name}.fmu"
    assert path.is_file(), f"{path} is missing: build the FMUs, or name their folder in CONTACT_FMUS"
    return Fmu(path)


def array(kind: Any, values: Iterable) -> Any:
    values = list(values)
    return (kind * len(values))(*values)
