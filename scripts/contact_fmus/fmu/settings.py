"""--set name=value, in the words of the FMU's own description"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.variables import Variable

SETTABLE = ("parameter", "input")
BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def read_settings(texts: Iterable[str], variables: dict[str, Variable], fmu: str) -> dict[str, Any]:
    """Values by name; UserError for a name that is not there, or a value that is none of its kind"""
    return dict(_setting(text, variables, fmu) for text in texts)


def known(name: str, variables: dict[str, Variable], fmu: str) -> Variable:
    if name not in variables:
        hint = similar(name, variables)
        raise UserError(f"{fmu} has no variable '{name}'{hint}; what its scene pins is left out of an FMU")
    return variables[name]


def _setting(text: str, variables: dict[str, Variable], fmu: str) -> tuple[str, Any]:
    name, equals, value = (part.strip() for part in text.partition("="))
    if not equals or not name or not value:
        raise UserError(f"--set takes NAME=VALUE, such as contact.dashpot=unclamped, not '{text}'")
    variable = known(name, variables, fmu)
    if variable.causality not in SETTABLE:
        raise UserError(
            f"{name} is a variable of kind {variable.causality}: only parameters and inputs are set"
        )
    return name, _value(variable, value)


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
    """A number, or for a vector as many as it has: 0,0,1 or [0, 0, 1]"""
    count, unit = len(variable.references), f" in {variable.unit}" if variable.unit else ""
    try:
        values = [float(part) for part in text.strip("[]()").split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(math.isfinite(value) for value in values):
        wanted = (
            "a number" if count == 1 else f"{count} numbers, such as {','.join('0' * (count - 1) + '1')},"
        )
        raise UserError(f"{variable.name} takes {wanted}{unit}, not '{text}'")
    return values if variable.is_vector else values[0]
