"""The variables of a model description by the names that a user writes"""

import contextlib
import copy
import importlib.util
import math
import re
from collections.abc import Iterable
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contact_fmus.errors import UserError, similar

from .files import Scene, fmu_file, has_scene, read_scene, repository, unpack

# Types of FMI 3.0 in the words of FMI 2.0
TYPES3 = {"Float32": "Real", "Float64": "Real"}
TYPES3 |= {f"{sign}Int{bits}": "Integer" for sign in ("", "U") for bits in (8, 16, 32, 64)}


class Variable(NamedTuple):
    """A scalar or a vector of the model description"""

    name: str
    type: str  # Real | Integer | Boolean | Enumeration
    causality: str
    unit: str
    description: str
    references: tuple[int, ...]  # one, or three of a vector
    items: tuple[str, ...]  # names of an enumeration's items, of the values in `item_values`
    item_values: tuple[int, ...]

    @property
    def is_vector(self) -> bool:
        return len(self.references) > 1


def is_fmi3(description: Any) -> bool:
    return description.fmiVersion.startswith("3.")


def entries(description: Any) -> list[tuple[Any, int, int]]:
    """Each scalar of an FMI 3.0 description: its variable, its place there, and the number of values"""
    found = []
    for variable in description.modelVariables:
        size = math.prod(variable.shape or ())
        found += [(variable, index, size) for index in range(size)]
    return found


def scalars(description: Any) -> list[Any]:
    """The variables of an FMI 2.0 description, and those of an FMI 3.0 one as FMI 2.0 would describe them: an
    array is a scalar for each of its entries, and a value reference is a place in this list."""
    if not is_fmi3(description):
        return description.modelVariables
    found = []
    for variable, index, size in entries(description):
        one = copy.copy(variable)
        one.valueReference, one.type = len(found), TYPES3.get(variable.type, variable.type)
        if variable.shape:
            places = list(product(*(range(1, length + 1) for length in variable.shape)))
            one.name = f"{variable.name}[{','.join(map(str, places[index]))}]"
            starts = str(variable.start or "").split()
            one.start = starts[index] if len(starts) == size else None
        found.append(one)
    return found


def read_variables(description: Any) -> dict[str, Variable]:
    """All names a user may write: every scalar, and every vector without its index"""
    variables: dict[str, Variable] = {}
    components: dict[str, list[Variable]] = {}
    for scalar in scalars(description):
        declared = scalar.declaredType
        items = declared.items if declared is not None and scalar.type == "Enumeration" else []
        unit = scalar.unit or (declared.unit if declared is not None else None) or ""
        unit = "" if unit == "1" else unit  # which a reader would take for a number
        variable = Variable(
            scalar.name,
            scalar.type,
            scalar.causality,
            unit,
            scalar.description or "",
            (scalar.valueReference,),
            tuple(item.name for item in items),
            tuple(int(item.value) for item in items),
        )
        variables[scalar.name] = variable
        vector = re.fullmatch(r"(.+)\[\d+\]", scalar.name)  # not an entry of a matrix, which other FMUs may have
        if vector:
            components.setdefault(vector[1], []).append(variable)
    for name, parts in components.items():
        parts.sort(key=lambda part: int(part.name[len(name) + 1 : -1]))
        variables[name] = parts[0]._replace(name=name, references=tuple(part.references[0] for part in parts))
    return variables


def start_values(description: Any) -> dict[str, Any]:
    """Of the scalars that have one: a number, a Boolean, an enumeration's item by name, a text"""
    variables = read_variables(description)
    return {one.name: _start(variables[one.name], one.start) for one in scalars(description) if one.start is not None}


def _start(variable: Variable, text: Any) -> Any:
    if variable.type == "Boolean":
        return str(text).lower() in ("true", "1")
    if variable.type == "Real":
        return float(text)
    return plain(variable, int(text)) if variable.type in ("Integer", "Enumeration") else text


def plain(variable: Variable, value: Any) -> Any:
    """An enumeration's item by name, a Boolean as one"""
    if variable.type == "Boolean":
        return bool(value)
    if variable.items and value in variable.item_values:
        return variable.items[variable.item_values.index(value)]
    return value


def value_of(variable: Variable, values: Any) -> Any:
    """What the FMU gave for the references, as a user reads it: a vector as an array"""
    if variable.type == "Real":
        return np.array(values) if variable.is_vector else values[0]
    return plain(variable, values[0])


def numbers_of(variable: Variable, value: Any) -> list:
    """What the FMU is given for the references; ValueError for a value that is none of the variable's"""
    if variable.type != "Real":
        return [bool(value) if variable.type == "Boolean" else item_value(variable, value)]
    try:
        values = np.atleast_1d(np.asarray(value, dtype=float))
    except (TypeError, ValueError):
        values = np.empty(0)
    count = len(variable.references)
    if values.shape != (count,):
        unit = f" in {variable.unit}" if variable.unit else ""
        wanted = f"{count} numbers" if count > 1 else "a number"
        raise ValueError(f"{variable.name} takes {wanted}{unit}, not {value!r}")
    return values.tolist()


def item_value(variable: Variable, value: Any) -> int:
    """An item's name, or an integer as it stands: the FMU itself refuses those it does not offer"""
    if not isinstance(value, str):
        return int(value)
    if value not in variable.items:
        raise ValueError(f"{variable.name} is one of {', '.join(variable.items)}, not '{value}'")
    return variable.item_values[variable.items.index(value)]


# --set name=value, in the words of the FMU's own description

SETTABLE = ("parameter", "input")
BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


# The shipped FMU that leaves everything open, by the shape that a sphere touches
OPEN = {"sphere": "SphereSphere", "cylinder": "SphereCylinder", "plane": "SpherePlane", "torus": "SphereTorus"}


def read_settings(texts: Iterable[str], variables: dict[str, Variable], fmu: Path) -> dict[str, Any]:
    """Values by name; UserError for a name that is not there, or a value that is none of its kind"""
    found = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise UserError(f"--set takes NAME=VALUE, such as contact.dashpot=unclamped, not '{text}'")
        variable = known(name, variables, fmu)
        if variable.causality not in SETTABLE:
            raise UserError(f"{name} is a variable of kind {variable.causality}: only parameters and inputs are set")
        found[name] = _value(variable, value)
    return found


def known(name: str, variables: dict[str, Variable], fmu: Path) -> Variable:
    """UserError where there is none, with the value that the FMU's scene pins it to"""
    if name in variables:
        return variables[name]
    scene = read_scene(fmu) if has_scene(fmu) else None
    text = f"{fmu.name} has no variable '{name}'{similar(name, variables)}"
    if scene is None:
        raise UserError(text)
    if name in scene.pinned:
        text = f"{fmu.name} has {name} pinned to {_written(scene.pinned[name])}"
    raise UserError(text + _where_open(name, scene))


def _where_open(name: str, scene: Scene) -> str:
    """A shipped FMU with the same bodies that has the variable, else what a scene of one's own would do"""
    shapes = {body.name: body.shape for body in scene.bodies}
    if set(shapes) == {"source", "destination"}:
        rollers = shapes["source"] == "cylinder"
        other = "CylinderCylinder" if rollers else OPEN.get(shapes["destination"], "")
        with contextlib.suppress(FileNotFoundError):
            if name in read_variables(unpack(fmu_file(other))[1]):
                return f"; {other} has it open"
    return "; a scene that does not pin it has it open" if name in scene.pinned else ""


def _written(value: Any) -> str:
    if isinstance(value, list):
        return ",".join(_written(one) for one in value)
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)


def _value(variable: Variable, text: str) -> Any:
    if variable.type == "Real":
        return _reals(variable, text)
    if variable.type == "Boolean":
        if text.lower() not in BOOLEANS:
            raise UserError(f"{variable.name} is true or false, not '{text}'")
        return BOOLEANS[text.lower()]
    if variable.items:
        if text in variable.items:
            return text
        items = ", ".join(variable.items)
        raise UserError(f"{variable.name} is one of {items}, not '{text}'{similar(text, variable.items)}")
    if variable.type != "Integer":
        raise UserError(f"{variable.name} is of type {variable.type}, which cannot be set here")
    try:
        return int(text)
    except ValueError:
        raise UserError(f"{variable.name} takes a whole number, not '{text}'") from None


def _reals(variable: Variable, text: str) -> Any:
    """A number, or for a vector as many as it has: 0,0,1 or [0, 0, 1]; each may have a unit: 50mm"""
    count, unit = len(variable.references), f" in {variable.unit}" if variable.unit else ""
    parts = text.strip("[]()").split(",")
    values = [_number(part) for part in parts]
    with_unit = [part for part, value in zip(parts, values, strict=True) if value is None]
    if with_unit and len(parts) == count:
        if any(values):  # 10,20,30mm: metres and millimetres
            raise UserError(f"{variable.name} takes a unit with each number that is not 0, not '{text}'")
        values = [
            _in_unit(variable, part) if value is None else value for part, value in zip(parts, values, strict=True)
        ]
    if len(values) != count or not all(value is not None and math.isfinite(value) for value in values):
        wanted = "a number" if count == 1 else f"{count} numbers, such as {','.join('0' * (count - 1) + '1')},"
        raise UserError(f"{variable.name} takes {wanted}{unit}, not '{text}'")
    return values if variable.is_vector else values[0]


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _in_unit(variable: Variable, text: str) -> float:
    """The number in the variable's unit. The generator's module reads it, as it reads scene files."""
    file = repository() / "modelDescription" / "generator" / "quantity.py"
    loader = importlib.util.spec_from_file_location("contact_quantity", file)
    assert loader is not None and loader.loader is not None
    quantity = importlib.util.module_from_spec(loader)
    loader.loader.exec_module(quantity)
    unit = variable.unit or "1"
    try:
        return quantity.in_unit(text, unit)
    except ValueError as error:
        raise UserError(f"{variable.name} takes a number in {unit}, not '{text.strip()}', {error}") from None
