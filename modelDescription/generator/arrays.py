"""The variables as FMI 3.0 has them: a vector is one array, with the value reference of its first scalar."""

from dataclasses import dataclass

from .cell import Cell, Variable
from .resolve import Resolved

# Types of FMI 3.0 by the base of ours; Int32 is what the model counts with.
ELEMENTS = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}


@dataclass(frozen=True)
class Array:
    """A variable of FMI 3.0, scalar where its row has one dimension."""

    cell: Cell
    element: str  # Float64, Int32, ...
    variability: str
    initial: str | None
    start: tuple  # one value for each component; empty for what the FMU computes
    dependencies: tuple[tuple[int, str], ...]  # of outputs: inputs and states felt at once, dependenciesKind
    derivative: int | None  # of a rate: value reference of its state

    @property
    def description(self) -> str:
        return self.cell.description + (f" ({self.cell.symbol})" if self.cell.symbol else "")

    @property
    def intermediate(self) -> bool:
        """Whether it may be asked for within a step: outputs that do not sum up the step."""
        return self.cell.row.causality == "output" and self.variability == "continuous"


def arrays(resolved: Resolved) -> list[Array]:
    """In the order of the scalars of modelDescription.xml."""
    order = {cell.name: n for n, cell in enumerate(resolved.cells)}
    return [_array(resolved, variable, order) for variable in resolved.variables if variable.component == 0]


def _array(resolved: Resolved, first: Variable, order: dict[str, int]) -> Array:
    cell, row = first.cell, first.cell.row
    values = cell.value if isinstance(cell.value, tuple) else (cell.value,)
    initial = {"parameter": "exact", "input": None}.get(row.causality, "calculated")
    return Array(
        cell, ELEMENTS[row.type.base], row.variability, initial, values if row.has_start else (),
        tuple(_dependencies(resolved, first, order)), _state_of(resolved, cell),
    )  # fmt: skip


def in_role(found: list[Array], role: str) -> list[Array]:
    """States or event indicators; rates in the order of their states."""
    chosen = [array for array in found if array.cell.row.role == role]
    if role != "rate":
        return chosen
    states = [array.cell.reference for array in in_role(found, "state")]
    return sorted(chosen, key=lambda rate: states.index(rate.derivative))


def _state_of(resolved: Resolved, cell: Cell) -> int | None:
    states = (other for other in resolved.of(cell.row.rate_of) if other.element == cell.element)
    return next((state.reference for state in states), None)


def _dependencies(resolved: Resolved, first: Variable, order: dict[str, int]) -> list[tuple[int, str]]:
    """As Resolved.dependencies, between arrays, in the order of the cells."""
    felt = {
        cell.name: (cell.reference, kind)
        for index, kind in resolved.dependencies(first)
        for cell in (resolved.variables[index - 1].cell,)
    }
    return [felt[name] for name in sorted(felt, key=order.__getitem__)]
