"""What calls by ctypes have in common for FMI 2.0 and FMI 3.0: the functions and their types, read from the
headers of the standard, and an instance that records what its logger was told."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from ctypes import POINTER, byref, c_char_p, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

from support.sources import fmi_headers

OK, WARNING = range(2)


class Prototype(NamedTuple):
    result: Any
    arguments: list


def read(version: int, known: dict[str, Any]) -> dict[str, Prototype]:
    """By the names of the functions; `known`: callbacks and structures by their names in the header"""
    platform = {2: "fmi2TypesPlatform.h", 3: "fmi3PlatformTypes.h"}[version]
    files = [fmi_headers() / name for name in (platform, f"fmi{version}FunctionTypes.h")]
    text = re.sub(r"/\*.*?\*/", "", "".join(file.read_text() for file in files), flags=re.DOTALL)
    types = {"char": ctypes.c_char, "size_t": c_size_t, "unsigned int": c_uint} | known
    for target, name in re.findall(r"typedef\s+([\w ]+?\*?)\s+(fmi\d\w+)\s*;", text):
        types[name] = _plain(target, types)
    types |= dict.fromkeys(re.findall(r"typedef enum \{[^}]*\}\s*(\w+);", text), c_int)
    return {
        name: Prototype(
            _plain(kind, types) if kind != "void" else None,
            [_argument(one, types) for one in given.split(",") if one.strip() != "void"],
        )
        for kind, name, given in re.findall(r"typedef\s+([\w ]+?\*?)\s+(fmi\d\w+)TYPE\s*\(([^)]*)\);", text)
    }


def _plain(target: str, types: dict[str, Any]) -> Any:
    if target.endswith("*"):
        return c_char_p if re.search(r"char", target, re.IGNORECASE) else c_void_p
    return types.get(target) or getattr(ctypes, f"c_{target.removesuffix('_t')}")


def _argument(text: str, types: dict[str, Any]) -> Any:
    base, star, array = re.fullmatch(r"\s*(?:const )?(\w+)\s*(\*?)\s*\w*\s*(\[\])?\s*", text).groups()
    if not star and not array:
        return types[base]
    return c_char_p if base.endswith("Byte") else POINTER(types[base])


def bind(library_file: str | Path, prototypes: dict[str, Prototype]) -> ctypes.CDLL:
    """Returns the library with the prototypes of its functions."""
    library = ctypes.CDLL(str(library_file))
    for name, prototype in prototypes.items():
        function = getattr(library, name)
        function.restype, function.argtypes = prototype
    return library


class Message(NamedTuple):
    """One call of the logger"""

    status: int
    category: str
    text: str


class AnyFmu:
    """`variables` by name"""

    def select(self, *causalities: str, kind: str | None = None) -> list[Any]:
        return [
            variable
            for variable in self.variables.values()
            if variable.causality in causalities and kind in (None, variable.type)
        ]


class AnyInstance:
    """`fmu.library` has its functions, `prefix` begins their names; it never raises for a refused call, `ok`
    does. `messages` have a status and a text."""

    prefix = "fmi"
    STATE = "FMUState"  # how the version writes it

    def __enter__(self):
        return self

    def __exit__(self, *_exception) -> None:
        self.free()

    def free(self) -> None:
        if self.component is not None:
            getattr(self.fmu.library, f"{self.prefix}FreeInstance")(self.component)
            self.component = None

    def call(self, function: str, *arguments: Any) -> int:
        """Returns the status of fmi<version><function>(instance, ...)."""
        return getattr(self.fmu.library, f"{self.prefix}{function}")(self.component, *arguments)

    def ok(self, function: str, *arguments: Any) -> None:
        status = self.call(function, *arguments)
        assert status <= WARNING, f"{self.prefix}{function}{arguments}: status {status}, {self.texts()}"

    def access(self, function: str, references: Any, values: Any, count: int = 1, length: int = 1) -> int:
        """fmi<version>Get... or Set...; `length`: of all values, which FMI 3.0 is told"""
        return self.call(function, references, count, values, *[length] * (self.prefix == "fmi3"))

    def texts(self) -> list[str]:
        return [message.text for message in self.messages]

    def enter_initialization(
        self,
        values: dict[str, Any] | None = None,
        tolerance: float | None = None,
        start: float = 0.0,
        stop: float | None = None,
    ) -> None:
        experiment = (tolerance is not None, tolerance or 0.0, start, stop is not None, stop or 0.0)
        if self.prefix == "fmi2":
            self.ok("SetupExperiment", *experiment)
        self.set(values or {})
        self.ok("EnterInitializationMode", *(experiment if self.prefix == "fmi3" else ()))

    def initialize(self, *arguments: Any, **options: Any) -> AnyInstance:
        """To the end of initialization mode, with the arguments of `enter_initialization`"""
        self.enter_initialization(*arguments, **options)
        self.ok("ExitInitializationMode")
        return self

    def expect(self, status: int, *words: str) -> Callable[[int], None]:
        """`instance.expect(DISCARD, "radius")(instance.call(...))`: one message, with the words"""
        del self.messages[:]

        def check(got: int) -> None:
            assert got == status, f"status {got}, expected {status}: {self.texts()}"
            assert [message.status for message in self.messages] == [status], self.messages
            missing = [word for word in words if word not in self.messages[0].text]
            assert not missing, f"{missing} not in '{self.messages[0].text}'"

        return check

    def save(self) -> bytes:
        state, size = c_void_p(), c_size_t()
        self.ok(f"Get{self.STATE}", byref(state))
        self.ok(f"Serialized{self.STATE}Size", state, byref(size))
        buffer = ctypes.create_string_buffer(size.value)
        self.ok(f"Serialize{self.STATE}", state, buffer, size)
        self.ok(f"Free{self.STATE}", byref(state))
        return buffer.raw
