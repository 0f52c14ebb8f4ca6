"""Which variables a scene has, and the start or constant value of every parameter and input."""

import math
import operator
import re
from dataclasses import dataclass, replace
from functools import cached_property

from . import advice
from .catalogue import Catalogue, Row
from .cell import COMPONENTS, Cell, Variable
from .conditions import Conditions, number_of
from .errors import allowed
from .quantity import in_unit
from .scene import Scene

# `unless` of what is refused: a number, how it must compare, a factor, and the other number
UNLESS = re.compile(r"(\S+) (<|>=?) (?:([\d.]+) )?(\S+)")
RELATIONS = {"<": operator.lt, ">": operator.gt, ">=": operator.ge}
MOST_VARIABLES = 65535  # positions in the C table are 16 bits


@dataclass(frozen=True)
class Relation:
    """What must hold of two numbers: how the first compares with a factor times the second"""

    cells: tuple[Cell, ...]
    relation: str
    factor: float

    def fails(self) -> bool:
        first, second = (cell.value for cell in self.cells)
        return not RELATIONS[self.relation](first, self.factor * second)


@dataclass(frozen=True)
class Resolved:
    scene: Scene
    catalogue: Catalogue
    cells: tuple[Cell, ...]  # every row of every element, present or not, in the order of the catalogue
    variables: tuple[Variable, ...]  # what the FMU has, in the order of modelDescription.xml
    may_need_cvode: bool
    may_need_general: bool

    @cached_property
    def _by_key(self) -> dict[str, list[Cell]]:
        found: dict[str, list[Cell]] = {}
        for cell in self.cells:
            found.setdefault(cell.row.key, []).append(cell)
        return found

    def of(self, key: str) -> list[Cell]:
        return self._by_key.get(key, [])

    def may(self, key: str, value: str, element: int | None = None) -> bool:
        """May the choice `key` of any (or of one) element have the item `value`?"""
        return any(
            cell.value_name == value if cell.pinned else cell.offers(value)
            for cell in self.of(key)
            if element is None or cell.element == element
        )

    def has(self, key: str) -> bool:
        return any(cell.open for cell in self.of(key))

    def refusals(self):
        """Parameters that may contradict each other, as far as they are not pinned otherwise: cells with the
        values in question, what must hold of two numbers beside them (None: nothing), and the message."""
        conditions = Conditions(self.cells, {}, self.scene)
        for cell in self.cells:
            for refused in cell.row.refused:
                choices = []
                for key, items in refused["if"].items():
                    for other in conditions.choices(key, cell):
                        numbers = {number_of(other.row, item) for item in items} - {None}
                        choices.append((other, numbers if other.open else numbers & {other.value}))
                unless = None
                if "unless" in refused:
                    first, relation, factor, second = UNLESS.fullmatch(refused["unless"]).groups()
                    of = [one for key in (first, second) for one in self._numbers(conditions, key, cell)]
                    unless = Relation(tuple(of), relation, float(factor or 1.0))
                is_there = unless is None or len(unless.cells) == 2
                if is_there and len(choices) == len(refused["if"]) and all(numbers for _, numbers in choices):
                    names = _names(self.scene, cell.row, cell.element)
                    yield choices, unless, refused["text"].format(**names)

    def _numbers(self, conditions: Conditions, key: str, cell: Cell) -> list[Cell]:
        """The cells that `unless` speaks of; the radius of a part of a compound counts as pinned."""
        part = self.scene.contacts[cell.element].source_part if key == "source.radius" else None
        if part:
            whole = conditions.choices("destination.radius", cell)
            return [replace(one, pinned=True, value=part.radius) for one in whole]
        return conditions.choices(key, cell)

    def in_role(self, role: str) -> list["Variable"]:
        """States, their rates or event indicators, in the order of modelDescription.xml."""
        return [variable for variable in self.variables if variable.cell.row.role == role]

    def rates(self) -> list["Variable"]:
        """The rate of each state, in the order of the states."""
        of = {(v.cell.row.rate_of, v.cell.element, v.component): v for v in self.in_role("rate")}
        return [of[v.cell.row.key, v.cell.element, v.component] for v in self.in_role("state")]

    def dependencies(self, variable: "Variable") -> list[tuple[int, str]]:
        """Inputs and states that an output feels: position in modelDescription.xml, dependenciesKind."""
        cell = variable.cell
        bodies = set(range(len(self.scene.bodies)))
        contacts = {cell.element} if cell.row.owner == "contact" else range(len(self.scene.contacts))
        if cell.row.owner == "body":
            bodies = {cell.element}
            if "contact.spring_state" in cell.row.depends:  # a sum over its contacts
                ends = {j: {one.source, one.destination} for j, one in enumerate(self.scene.contacts)}
                contacts = {j for j, pair in ends.items() if cell.element in pair}
                bodies = bodies.union(*(ends[j] for j in contacts))
        elif cell.row.owner == "contact":
            contact = self.scene.contacts[cell.element]
            bodies = {contact.source, contact.destination}
        found = []
        for key, kind in cell.row.depends.items():
            for element, others in self._felt.get(key, {}).items():
                owner = self.catalogue.rows[key].owner
                if element in (contacts if owner == "contact" else bodies):
                    found += [
                        (index, kind)
                        for index, component in others
                        if cell.row.owner != "body" or kind == "dependent" or component == variable.component
                    ]
        return sorted(found)

    @cached_property
    def _felt(self) -> dict[str, dict[int, list[tuple[int, int]]]]:
        """Of inputs and states by key and element: positions in modelDescription.xml and components."""
        found: dict[str, dict[int, list]] = {}
        for index, variable in enumerate(self.variables, 1):
            cell = variable.cell
            if cell.row.causality == "input" or cell.row.role == "state":
                found.setdefault(cell.row.key, {}).setdefault(cell.element, []).append(
                    (index, variable.component)
                )
        return found


def resolve(scene: Scene, catalogue: Catalogue) -> Resolved:
    cells = [cell for row in catalogue.rows.values() for cell in _cells_of(row, scene)]
    known = {cell.name: cell for cell in cells}
    narrowed, constants = _pins(scene, catalogue, known)
    cells = [_narrow(cell, narrowed.get(cell.name), scene) for cell in cells]
    known = {cell.name: cell for cell in cells}
    constants = {name: checked(scene, catalogue, "[pinned]", known[name], v) for name, v in constants.items()}
    conditions = Conditions(cells, constants, scene)
    cells = [_place(cell, conditions) for cell in cells]
    known = {cell.name: cell for cell in cells}
    _check_use(scene, catalogue, known, conditions)
    left_out = _left_out(scene, known, conditions)
    starts = {
        name: checked(scene, catalogue, "[start]", known[name], value) for name, value in scene.start.items()
    }
    cells = [_with_start(cell, starts, left_out) for cell in cells]
    variables = tuple(_variables(cells))
    if len(variables) > MOST_VARIABLES:
        text = (
            f"{len(variables)} variables (allowed: at most {MOST_VARIABLES}; pin choices, leave out outputs)"
        )
        raise scene.error(text)
    cvode, general = conditions.may_need_cvode, conditions.may_need_general
    return Resolved(scene, catalogue, tuple(cells), variables, cvode, general)


def _names(scene: Scene, row: Row, element: int) -> dict[str, str]:
    """What descriptions and messages call a body, or a contact and its bodies."""
    if row.owner != "contact":
        return {"body": scene.bodies[element].name} if row.owner == "body" else {}
    contact = scene.contacts[element]
    ends = {end: scene.bodies[getattr(contact, end)].name for end in ("source", "destination")}
    part = contact.source_part
    return {"contact": contact.name, "part": ends["source"] + (f".{part.name}" if part else ""), **ends}


def _cells_of(row: Row, scene: Scene):
    """The row's cell for each element that has it; `present` and `pinned` are settled later."""
    if row.owner == "body":
        for i, body in enumerate(scene.bodies):
            if body.has(row):
                name, block = f"{body.name}.{row.field}", 1 + 2 * body.number
                yield _cell(row.of_shape(body.shape), scene, i, name, block)
    elif row.owner == "contact":
        for j, contact in enumerate(scene.contacts):
            hit = scene.bodies[contact.destination]
            if hit.has(row):
                name, block = f"{contact.name}.{row.field}", 2 + 2 * contact.number
                yield _cell(row.of_shape(hit.shape), scene, j, name, block)
    else:
        yield _cell(row, scene, 0, row.key, 0)


def _cell(row: Row, scene: Scene, element: int, name: str, block: int) -> Cell:
    names = _names(scene, row, element)
    letters = {"r": names.get("body", ""), "b": names.get("body", "")}
    if row.owner == "body" and len(scene.contacts) == 1:  # a pair keeps the symbols of the equations
        contact = scene.contacts[0]
        if element in (contact.source, contact.destination):
            letters = {"r": "s", "b": "src"} if element == contact.source else {"r": "d", "b": "dst"}
    value = row.start
    if row.start_destination is not None and scene.is_destination_only(element):
        value = row.start_destination
    return Cell(
        row, element, name, True, False, number_of(row, value), 100 * block + row.vr,
        row.description.format(**names), row.symbol.format(**letters) if row.symbol else None,
    )  # fmt: skip


def _pins(
    scene: Scene, catalogue: Catalogue, known: dict[str, Cell]
) -> tuple[dict[str, list], dict[str, object]]:
    """Choices that keep some of their items only, and what is pinned to one value."""
    narrowed, constants = {}, {}
    parameters = {name: cell for name, cell in known.items() if cell.row.causality == "parameter"}
    for name, value in scene.pinned.items():
        if name not in known:
            reason = advice.other_shape(scene, catalogue, name)
            raise scene.error(advice.unknown("[pinned]", name, parameters, reason))
        if name not in parameters:
            kind = known[name].row.causality
            raise scene.error(
                f"[pinned]: '{name}' is no parameter but {kind} {advice.near(name, parameters)}"
            )
        if known[name].row.type.items and isinstance(value, list):
            narrowed[name] = value
            continue
        if name in scene.start:
            raise scene.error(f"[pinned]: '{name}' also stands in [start] (allowed: one of the two)")
        constants[name] = value
    return narrowed, constants


def _narrow(cell: Cell, wanted: list | None, scene: Scene) -> Cell:
    """The cell of a choice with these items alone: two or more, next to each other, as FMI knows ranges."""
    if wanted is None:
        return cell
    kind = cell.row.type
    kept = tuple(item for item in kind.items if item.name in wanted)
    names = [item.name for item in kind.items]
    numbers = [item.value for item in kept]
    if sorted(wanted, key=str) != sorted(item.name for item in kept) or len(kept) < 2:
        raise scene.error(
            f"[pinned]: '{cell.name}' is {wanted!r} "
            f"(allowed: one of them, or two or more different ones, of: {', '.join(names)})"
        )
    if numbers[-1] - numbers[0] != len(numbers) - 1:
        raise scene.error(f"[pinned]: '{cell.name}' leaves a gap (allowed: neighbours in {', '.join(names)})")
    if cell.name not in scene.start and cell.value not in numbers:
        start = kind.items[[item.value for item in kind.items].index(cell.value)].name
        raise scene.error(
            f"[pinned]: '{cell.name}' leaves out its start value {start} (allowed: another under [start])"
        )
    return replace(cell, row=replace(cell.row, type=replace(kind, items=kept)))


def checked(scene: Scene, catalogue: Catalogue, where: str, cell: Cell, value):
    """`value` of the scene file as numbers, or the error that says what is allowed."""
    row, base = cell.row, cell.row.type.base
    said = f"{where}: '{cell.name}' is {value!r}"
    if row.type.items:
        items = [item.name for item in row.type.items]
        if value not in items:
            raise scene.error(f"{said} {allowed(items)}")
        return row.type.item(value).value
    if base == "Boolean":
        if not isinstance(value, bool):
            raise scene.error(f"{said} (allowed: true, false)")
        return int(value)
    values = value if isinstance(value, list) else [value]
    low, high = row.limits
    kind = advice.number_in(row)
    if isinstance(value, list) != (row.dim > 1) or len(values) != row.dim:
        form = kind.replace("a number", f"a list of {row.dim} numbers" if row.dim > 1 else "one number")
        raise scene.error(f"{said} (allowed: {form})")
    if base == "Real":
        try:
            values = [in_unit(one, row.type.unit) if isinstance(one, str) else one for one in values]
        except ValueError as error:
            raise scene.error(f"{said}, {error} (allowed: {kind} from {low!r} to {high!r})") from None
    kinds = (int, float) if base == "Real" else (int,)
    for number in values:
        if (
            isinstance(number, bool)
            or not isinstance(number, kinds)
            or not math.isfinite(number)
            or not low <= number <= high
        ):
            raise scene.error(f"{said} (allowed: {kind} from {low!r} to {high!r})")
    return tuple(map(float, values)) if row.dim > 1 else (float(values[0]) if base == "Real" else value)


def _place(cell: Cell, conditions: Conditions) -> Cell:
    """Settles whether the scene needs the cell, and its constant if it is pinned."""
    constants = conditions.constants
    needed = not cell.row.when or any(
        all(conditions.possible(choice, items, cell) for choice, items in alternative.items())
        for alternative in cell.row.when
    )
    pinned = cell.name in constants
    return replace(cell, present=needed, pinned=pinned, value=constants.get(cell.name, cell.value))


def _check_use(scene: Scene, catalogue: Catalogue, known: dict[str, Cell], conditions: Conditions) -> None:
    """What [start] and [pinned] name must exist and be needed by this scene."""
    usable = {name: cell for name, cell in known.items() if cell.present and cell.row.has_start}
    for where, names in (("[pinned]", scene.pinned), ("[start]", scene.start)):
        for name in names:
            if name not in known:
                raise scene.error(
                    advice.unknown(where, name, usable, advice.other_shape(scene, catalogue, name))
                )
            if name in usable:
                continue
            if not known[name].row.has_start:
                raise scene.error(f"{where}: '{name}' is computed by the FMU {advice.near(name, usable)}")
            reason, remedy = conditions.why_not(known[name])
            text = f"{where}: '{name}' is not needed with what is pinned: {reason}"
            raise scene.error(f"{text} (allowed: {remedy}, or no '{name}')")


def _left_out(scene: Scene, known: dict[str, Cell], conditions: Conditions) -> set[str]:
    """Names of the cells that [leave_out] removes; an entry is a variable, a row (body.velocity) or group."""
    outputs = {
        name: cell
        for name, cell in known.items()
        if cell.present and cell.row.causality in ("output", "calculatedParameter")
    }
    result: set[str] = set()
    for entry in scene.leave_out:
        found = {
            name
            for name, cell in outputs.items()
            if entry in (name, cell.row.key, name.partition(".")[0]) and "." in name
        }
        if (
            not found
            and entry in known
            and (known[entry].row.has_start or known[entry].row.causality == "local")
        ):
            kind = known[entry].row.causality
            raise scene.error(f"[leave_out]: '{entry}' is no output but {kind} {advice.near(entry, outputs)}")
        if not found and entry in known:
            reason, _ = conditions.why_not(known[entry])
            raise scene.error(
                f"[leave_out]: '{entry}' is left out already: {reason} {advice.near(entry, outputs)}"
            )
        if not found:
            raise scene.error(
                advice.unknown("[leave_out]", entry, outputs).replace("unknown variable", "unknown output")
            )
        result |= found
    return result


def _with_start(cell: Cell, starts: dict, left_out: set[str]) -> Cell:
    return replace(
        cell, present=cell.present and cell.name not in left_out, value=starts.get(cell.name, cell.value)
    )


def _variables(cells: list[Cell]):
    """Scalars in the order of modelDescription.xml: bodies, contacts, world; in each as catalogued."""
    rank = {"body": 0, "contact": 1, "world": 2}
    for cell in sorted((c for c in cells if c.open), key=lambda c: (rank[c.row.owner], c.element)):
        symbol = f" ({cell.symbol})" if cell.symbol else ""
        if cell.row.dim == 1:
            yield Variable(cell, 0, cell.name, cell.reference, cell.description + symbol, cell.value)
            continue
        for k, axis in enumerate(COMPONENTS[cell.row.dim]):
            text = f"{cell.description}, {axis} component{symbol}"
            start = None if cell.value is None else cell.value[k]
            yield Variable(cell, k, f"{cell.name}[{k + 1}]", cell.reference + k, text, start)
