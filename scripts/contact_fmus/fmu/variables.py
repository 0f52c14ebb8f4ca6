"""The variables of a model description by the names that a user writes"""

from __future__ import annotations

import copy
import re
from itertools import product
from typing import Any, NamedTuple

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
    """Of an FMI 3.0 description: each scalar's variable, its place there, and how many values there are"""
    found = []
    for variable in description.modelVariables:
        size = 1
        for length in variable.shape or ():
            size *= length
        found += [(variable, index, size) for index in range(size)]
    return found


def scalars(description: Any) -> list[Any]:
    """The variables of an FMI 2.0 description, and those of an FMI 3.0 one as FMI 2.0 would describe them: an
    array is a scalar for each of its entries, and a value reference is a place in this list.
    """
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
        vector = re.fullmatch(
            r"(.+)\[\d+\]", scalar.name
        )  # not an entry of a matrix, which other FMUs may have
        if vector:
            components.setdefault(vector[1], []).append(variable)
    for name, parts in components.items():
        parts.sort(key=lambda part: int(part.name[len(name) + 1 : -1]))
        variables[name] = parts[0]._replace(name=name, references=tuple(part.references[0] for part in parts))
    return variables


def item_value(variable: Variable, value: Any) -> int:
    """An item's name, or an integer as it stands: the FMU itself refuses those it does not offer"""
    if not isinstance(value, str):
        return int(value)
    if value not in variable.items:
        raise ValueError(f"{variable.name} is one of {', '.join(variable.items)}, not '{value}'")
    return variable.item_values[variable.items.index(value)]
