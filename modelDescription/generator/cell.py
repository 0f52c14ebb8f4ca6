"""A row of variables.toml for one body, one contact or the world, and the scalars that become of it."""

from dataclasses import dataclass

from .catalogue import Row

# What a vector or a quaternion calls its components, by their number.
COMPONENTS = {3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}


def shortest(value) -> str:
    """Shortest text of a number that reads back as the same."""
    return f"{value:g}" if float(f"{value:g}") == value else repr(value)


@dataclass(frozen=True)
class Cell:
    """A row of one body, of one contact or of the world: a scalar or a vector, present in the FMU or not."""

    row: Row
    element: int
    name: str
    present: bool
    pinned: bool
    value: object  # start or constant value as numbers, a tuple for a vector; None for what the FMU computes
    reference: int
    description: str
    symbol: str | None

    @property
    def open(self) -> bool:
        return self.present and not self.pinned

    def offers(self, item: str) -> bool:
        """Whether a choice that is open has this item: a scene may leave it some of them only."""
        return not self.row.type.items or self.row.type.item(item) is not None

    def may_be(self, item: str) -> bool:
        return self.value_name == item if self.pinned else self.open and self.offers(item)

    @property
    def value_name(self) -> str | None:
        """The value as a user writes it: item of an enumeration, Boolean, number or list."""
        if self.value is None:
            return None
        if self.row.type.items:
            return next(item.name for item in self.row.type.items if item.value == self.value)
        if self.row.type.base == "Boolean":
            return "true" if self.value else "false"
        if isinstance(self.value, tuple):
            return "(" + ", ".join(shortest(x) for x in self.value) + ")"
        return repr(self.value)


@dataclass(frozen=True)
class Variable:
    """A scalar variable of the FMU."""

    cell: Cell
    component: int
    name: str
    reference: int
    description: str
    start: object
