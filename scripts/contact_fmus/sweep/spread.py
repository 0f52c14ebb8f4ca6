"""How the values of one parameter are chosen: a list, a grid, or a distribution to draw from"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_fmus.errors import UserError
from contact_fmus.fmu.variables import Variable

from .interface import Interface
from .keys import Table, number, one_of, whole

SCALES = ("linear", "log")
DISTRIBUTIONS = ("uniform", "normal", "lognormal", "triangular")
# Keys of each form of an entry of [vary], told apart by the key that only it has
GRID = ("from", "to", "count", "scale")
SAMPLED = ("range", "scale", "distribution", "mean", "deviation", "median", "mode")
MOST_RUNS = 2**40  # of a study; a run of a microsecond would keep a processor busy for two weeks


@dataclass(frozen=True)
class Parameter:
    """One that varies: its `values` each (list, grid), or the `quantile` of numbers in [0, 1)"""

    name: str
    variable: Variable
    values: np.ndarray | None = None  # one row for each value of a vector
    quantile: Callable[[np.ndarray], np.ndarray] | None = None

    @property
    def sampled(self) -> bool:
        return self.values is None

    @property
    def columns(self) -> list[str]:
        """Its scalars: a vector has one for each component"""
        if not self.variable.is_vector:
            return [self.name]
        return [f"{self.name}[{index}]" for index in range(1, len(self.variable.references) + 1)]


def read_parameter(interface: Interface, name: str, entry: Any) -> Parameter:
    """An entry of [vary]"""
    where = f"[vary] {name}"
    variable = interface.parameter(name, where)
    if variable.type == "String":
        raise UserError(f"{where}: a text cannot vary; set it under [start]")
    if isinstance(entry, list):
        return Parameter(name, variable, _array(variable, _listed(interface, variable, entry, where)))
    if isinstance(entry, dict) and "choices" in entry:
        choices = Table(entry, where, ("choices",)).get("choices")
        values = _array(variable, _listed(interface, variable, choices, where))
        return Parameter(name, variable, quantile=lambda u: values[_place(u, len(values))])
    if not isinstance(entry, dict):
        said = "values in [..], { from, to, count }, { range }, { distribution } or { choices } are wanted"
        raise UserError(f"{where}: {said}, not {entry!r}")
    if variable.is_vector:
        raise UserError(f"{where}: vary the components of a vector one by one, '{name}[1]', or list vectors")
    if variable.type not in ("Real", "Integer"):
        raise UserError(f"{where}: a {variable.type} takes a list, or {{ choices = [..] }} to sample from")
    if "from" in entry or "to" in entry:
        return Parameter(name, variable, _grid(interface, variable, Table(entry, where, GRID)))
    return Parameter(name, variable, quantile=_drawn(interface, variable, Table(entry, where, SAMPLED)))


def _listed(interface: Interface, variable: Variable, entry: Any, where: str) -> list[Any]:
    if not isinstance(entry, list) or not entry:
        raise UserError(f"{where}: at least one value in [..] is wanted, not {entry!r}")
    return [interface.value(variable, one, where) for one in entry]


def _array(variable: Variable, values: list[Any]) -> np.ndarray:
    kind = float if variable.type == "Real" else np.int32
    return np.array(values, dtype=kind).reshape(len(values), len(variable.references))


def _place(u: np.ndarray, count: int) -> np.ndarray:
    """Equally likely places 0 to count - 1"""
    return np.minimum((u * count).astype(np.int64), count - 1)


def _ends(interface: Interface, variable: Variable, low: float, high: float, table: Table) -> bool:
    """Both ends are allowed; true on a logarithmic scale"""
    for value in (low, high):
        interface.inside(variable, value, table.where)
    logarithmic = one_of(table.get("scale", "linear"), table.place("scale"), SCALES) == "log"
    if logarithmic and min(low, high) <= 0:
        raise UserError(f"{table.where}: a logarithmic scale wants numbers above 0, not {low!r} to {high!r}")
    return logarithmic


def _grid(interface: Interface, variable: Variable, table: Table) -> np.ndarray:
    low, high = table.number("from"), table.number("to")
    count = whole(table.needed("count"), table.place("count"), 1, MOST_RUNS)
    logarithmic = _ends(interface, variable, low, high, table)
    values = (np.geomspace if logarithmic else np.linspace)(low, high, count)
    if variable.type == "Integer":
        values = np.unique(np.round(values)).astype(np.int32)
    return values.reshape(-1, 1)


def _drawn(interface: Interface, variable: Variable, table: Table) -> Callable[[np.ndarray], np.ndarray]:
    kind = one_of(table.get("distribution", "uniform"), table.place("distribution"), DISTRIBUTIONS)
    _belongs(table, kind)
    if kind == "uniform":
        low, high = table.pair("range")
        logarithmic = _ends(interface, variable, low, high, table)
        quantile = _logarithmic(low, high) if logarithmic else (lambda u: low + (high - low) * u)
        if variable.type == "Integer":
            first, count = math.ceil(low), math.floor(high) - math.ceil(low) + 1
            return lambda u: (first + _place(u, count)).astype(np.int32).reshape(-1, 1)
    else:
        quantile = _bounded(interface, variable, kind, table)
    if variable.type == "Integer":
        return lambda u: np.round(quantile(u)).astype(np.int32).reshape(-1, 1)
    return lambda u: quantile(u).reshape(-1, 1)


def _belongs(table: Table, kind: str) -> None:
    """No key of another distribution"""
    own = {
        "uniform": {"range", "scale"},
        "normal": {"range", "mean", "deviation"},
        "lognormal": {"range", "median", "deviation"},
        "triangular": {"range", "mode"},
    }[kind]
    for key in table.content:
        if key not in own | {"distribution"}:
            allowed = ", ".join(sorted(own))
            raise UserError(
                f"{table.place(key)} does not belong to the distribution {kind}; allowed: {allowed}"
            )


def _logarithmic(low: float, high: float) -> Callable[[np.ndarray], np.ndarray]:
    """Between the ends whatever the rounding"""
    start, width = math.log(low), math.log(high / low)
    return lambda u: np.clip(np.exp(start + width * u), low, high)


def _bounded(
    interface: Interface, variable: Variable, kind: str, table: Table
) -> Callable[[np.ndarray], np.ndarray]:
    """A distribution of scipy, cut off to what `range` or the FMU allows: values outside are not drawn"""
    from scipy import stats  # takes a second to import, which a uniform study need not wait for

    if kind == "triangular":
        low, high = table.pair("range")
        _ends(interface, variable, low, high, table)
        mode = table.number("mode", (low + high) / 2)
        if not low <= mode <= high:
            raise UserError(
                f"{table.place('mode')}: a number from {low!r} to {high!r} is wanted, not {mode!r}"
            )
        return stats.triang((mode - low) / (high - low), low, high - low).ppf
    deviation = table.positive("deviation")
    if kind == "normal":
        base = stats.norm(number(table.needed("mean"), table.place("mean")), deviation)
    else:
        base = stats.lognorm(deviation, scale=table.positive("median"))
    low, high = interface.ranges.get(variable.references[0], (-math.inf, math.inf))
    if "range" in table:
        low, high = table.pair("range")
        _ends(interface, variable, low, high, table)
    first, last = base.cdf(low), base.cdf(high)
    if not last > first:
        raise UserError(f"{table.where}: no value of this distribution lies in {low!r} to {high!r}")
    return lambda u: np.clip(base.ppf(first + (last - first) * u), low, high)
