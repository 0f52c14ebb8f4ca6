"""What variables.toml says: units, declared types, the row of every variable. variables_file.py reads it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

BEHIND_BLOCKS = 1_000_000  # value references from here on are behind the blocks of bodies and contacts


@dataclass(frozen=True)
class Item:
    name: str
    value: int
    description: str


@dataclass(frozen=True)
class Type:
    """A declared type of FMI."""

    name: str
    base: str
    description: str
    quantity: str | None = None
    unit: str | None = None
    display: str | None = None
    min: float | int | None = None
    max: float | int | None = None
    nominal: float | None = None
    items: tuple[Item, ...] = ()  # of a choice, whether it is declared as an Enumeration or as an Integer

    def item(self, name: str) -> Item | None:
        return next((item for item in self.items if item.name == name), None)


@dataclass(frozen=True)
class Row:
    """One row of variables.toml: a scalar or a vector of every body, of every contact or of the world."""

    key: str
    vr: int
    type: Type
    causality: str
    description: str
    start: object = None
    start_destination: object = None
    min: float | int | None = None
    max: float | int | None = None
    dim: int = 1
    symbol: str | None = None
    shape: tuple[str, ...] = ()  # of the body or of the contact's destination; of all where empty
    tilts: bool = False  # no cylinder has it that touches a cylinder, because it keeps its axis
    kept: bool = False  # only such a cylinder has it
    absent: object = None  # what the code takes where a body of another shape has no such row
    of_plane: dict = field(default_factory=dict)  # what differs where body or destination is a plane
    of_torus: dict = field(default_factory=dict)
    when: tuple[dict, ...] = ()
    refused: tuple[dict, ...] = ()  # of a choice: what contradicts it, and the message
    tolerance: bool = False
    tunable: bool = False  # a parameter that may be set between steps, or what follows from such
    discrete: bool = False  # an output that changes at communication points and events only
    role: str | None = None  # of a local variable
    rate_of: str | None = None  # of a rate: key of its state
    reinit: bool = False  # a state that may jump at an event
    depends: dict[str, str] = field(default_factory=dict)  # inputs and states felt -> dependenciesKind

    @property
    def owner(self) -> str:
        """'body', 'contact' or 'world'."""
        group = self.key.partition(".")[0]
        return group if group in ("body", "contact") else "world"

    @property
    def field(self) -> str:
        """Name of the member in the C struct of its owner."""
        return self.key.partition(".")[2] if self.owner != "world" else self.c_name

    @property
    def c_name(self) -> str:
        return self.key.replace(".", "_")

    @property
    def has_start(self) -> bool:
        return self.causality in ("parameter", "input")

    def of_shape(self, shape: str) -> Row:
        """The row as it is where the body or the contact's destination has this shape."""
        return replace(self, **{"plane": self.of_plane, "torus": self.of_torus}.get(shape, {}))

    @property
    def variability(self) -> str:
        """As FMI 2.0 and 3.0 name it."""
        if self.causality in ("parameter", "calculatedParameter"):
            return "tunable" if self.tunable else "fixed"
        return "continuous" if self.type.base == "Real" and not self.discrete else "discrete"

    @property
    def limits(self) -> tuple:
        """(min, max), of an enumeration the first and last item."""
        if self.type.items:
            values = [item.value for item in self.type.items]
            return min(values), max(values)
        if self.type.base == "Boolean":
            return 0, 1
        return (
            self.min if self.min is not None else self.type.min,
            self.max if self.max is not None else self.type.max,
        )


@dataclass(frozen=True)
class Catalogue:
    project: dict
    units: dict
    types: dict[str, Type]
    rows: dict[str, Row]

    def choices(self) -> dict[str, Row]:
        """Rows whose value decides what else is needed: parameters that are enumerations or Booleans."""
        return {
            key: row
            for key, row in self.rows.items()
            if row.causality == "parameter" and (row.type.items or row.type.base == "Boolean")
        }

    def with_integer_choices(self) -> Catalogue:
        """For importers that know no enumerations: Integers, with the items in the descriptions."""
        types = {name: _as_integer(kind) if kind.items else kind for name, kind in self.types.items()}
        rows = {
            key: replace(
                row,
                type=types[row.type.name],
                description=row.description + _numbered(row.type) if row.type.items else row.description,
            )
            for key, row in self.rows.items()
        }
        return replace(self, types=types, rows=rows)


def _numbered(kind: Type) -> str:
    return ": " + ", ".join(f"{item.value} = {item.name}" for item in kind.items)


def _as_integer(kind: Type) -> Type:
    values = [item.value for item in kind.items]
    return replace(
        kind,
        base="Integer",
        quantity="Choice",
        min=min(values),
        max=max(values),
        description=kind.description + _numbered(kind),
    )
