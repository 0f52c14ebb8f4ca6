"""What a study may set and read of its FMU"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.files import unpack
from contact_fmus.fmu.variables import Variable, is_fmi3, read_variables, scalars

from . import keys

# A whole number of FMI 2.0 has 32 bits.
LEAST, MOST = -(2**31), 2**31 - 1


class Interface(NamedTuple):
    """Variables of an FMU by name, with their ranges"""

    model: str
    identifier: str
    guid: str
    variables: dict[str, Variable]
    ranges: dict[int, tuple[float, float]]  # of Real and Integer, by value reference and type's first letter
    settable: frozenset[str]
    single: bool  # one instance in a process
    fmi3: bool

    def variable(self, name: str, where: str) -> Variable:
        if name not in self.variables:
            said = f"{where}: {self.model} has no variable '{name}'"
            raise UserError(said + similar(name, self.variables))
        return self.variables[name]

    def parameter(self, name: str, where: str) -> Variable:
        """One that may be set before the start"""
        variable = self.variable(name, where)
        if name not in self.settable:
            said = (
                f"{where}: '{name}' cannot be set, it is {article(variable.causality)} {variable.causality}"
            )
            raise UserError(said)
        return variable

    def value(self, variable: Variable, value: Any, where: str) -> Any:
        """As the FMU takes it: float, int (Integer, Enumeration), bool, str, or a vector's tuple"""
        if variable.is_vector:
            size = len(variable.references)
            if not isinstance(value, list) or len(value) != size:
                raise UserError(f"{where}: {variable.name} takes {size} values, [..], not {value!r}")
            return tuple(self._scalar(variable, one, where) for one in value)
        return self._scalar(variable, value, where)

    def _scalar(self, variable: Variable, value: Any, where: str) -> Any:
        if variable.type == "Boolean":
            if not isinstance(value, bool):
                raise UserError(f"{where}: {variable.name} is true or false, not {value!r}")
            return value
        if variable.type == "String":
            return keys.text(value, where)
        if variable.type == "Enumeration":
            return item(variable, value, where)
        if variable.type == "Integer":
            found: float = keys.whole(value, where, LEAST, MOST)
        else:
            found = keys.number(value, where)
        self.inside(variable, found, where)
        return found

    def inside(self, variable: Variable, value: float, where: str) -> None:
        low, high = self.ranges.get(variable.references[0], (-math.inf, math.inf))
        if not low <= value <= high:
            unit = f" {variable.unit}" if variable.unit else ""
            said = f"{where}: {variable.name} = {value!r}{unit} is outside what {self.model} allows, "
            raise UserError(f"{said}{low!r} to {high!r}{unit}")


def item(variable: Variable, value: Any, where: str) -> int:
    """The value of an enumeration's item, given by name or number"""
    if value in variable.items:
        return variable.item_values[variable.items.index(value)]
    if not isinstance(value, bool) and isinstance(value, int) and value in variable.item_values:
        return value
    said = f"{where}: {variable.name} is one of {', '.join(variable.items)}, not {value!r}"
    raise UserError(said + similar(str(value), variable.items))


def article(word: str) -> str:
    return "an" if word[0] in "aeiou" else "a"


def read_interface(file: Path) -> Interface:
    try:
        _, description = unpack(file)
    except UserError:
        raise
    except Exception as error:  # fmpy raises what its parsers raise
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise UserError(f"{file} is no FMU that can be read: {reason}") from None
    variable_list = scalars(description)
    settable = {one.name for one in variable_list if _settable(one)}
    variables = read_variables(description)
    settable |= {name for name, one in variables.items() if one.is_vector and f"{name}[1]" in settable}
    ranges = {one.valueReference: _range(one) for one in variable_list if one.type in ("Real", "Integer")}
    identifier = description.coSimulation.modelIdentifier
    single = description.coSimulation.canBeInstantiatedOnlyOncePerProcess
    names = frozenset(settable)
    return Interface(
        description.modelName,
        identifier,
        description.guid,
        variables,
        ranges,
        names,
        bool(single),
        is_fmi3(description),
    )


def _settable(scalar: Any) -> bool:
    """Before the start: FMI 2.0, 2.2.7"""
    if scalar.causality in ("parameter", "input"):
        return True
    return scalar.initial in ("exact", "approx") and scalar.variability != "constant"


def _range(scalar: Any) -> tuple[float, float]:
    declared = scalar.declaredType
    low = scalar.min if scalar.min is not None else (declared.min if declared else None)
    high = scalar.max if scalar.max is not None else (declared.max if declared else None)
    return (-math.inf if low is None else float(low), math.inf if high is None else float(high))
