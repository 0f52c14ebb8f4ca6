"""The variables of a model description by the names that a user writes"""

from __future__ import annotations

import re
from typing import Any, NamedTuple


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


def read_variables(description: Any) -> dict[str, Variable]:
    """All names a user may write: every scalar, and every vector without its index"""
    variables: dict[str, Variable] = {}
    components: dict[str, list[Variable]] = {}
    for scalar in description.modelVariables:
        declared = scalar.declaredType
        items = declared.items if declared is not None and scalar.type == "Enumeration" else []
        unit = scalar.unit or (declared.unit if declared is not None else None) or ""
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
