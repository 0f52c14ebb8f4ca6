"""The C side of a scene: what the templates scene.h and scene_variables.c need, row by row."""

import re
from dataclasses import dataclass

from .catalogue import BEHIND_BLOCKS, Row
from .cell import COMPONENTS
from .conditions import Conditions, number_of
from .resolve import Cell, Resolved

C_BASE = {"Real": "REAL", "Integer": "INTEGER", "Boolean": "BOOLEAN", "Enumeration": "ENUMERATION"}
C_CAUSALITY = {
    "parameter": "PARAMETER",
    "calculatedParameter": "CALCULATED_PARAMETER",
    "input": "INPUT",
    "output": "OUTPUT",
}
C_VALUE = {3: "struct vec3", 4: "struct quaternion"}  # by the number of components
C_ROLE = {"state": "STATE", "rate": "RATE", "indicator": "INDICATOR"}
# Outputs that need the motion of the bodies and no more.
BODY_MOTION = ("body_displacement", "body_position", "body_velocity")


@dataclass(frozen=True)
class Branch:
    """What an accessor does for some elements; `condition` is empty in the last branch."""

    condition: str
    statements: tuple[str, ...]


@dataclass(frozen=True)
class Accessor:
    name: str
    owner: str
    result: str  # C type of the value
    branches: tuple[Branch, ...]
    uses_values: bool
    uses_index: bool


@dataclass(frozen=True)
class Struct:
    owner: str
    members: tuple[str, ...]
    bytes: int


def _of_parts(parts, dim: int) -> str:
    """A vector or a quaternion of expressions for its components"""
    text = ", ".join(parts)
    return f"vec3_make({text})" if dim == 3 else f"(struct quaternion){{{text}}}"


def constant(row: Row, value) -> str:
    """A value as a C expression."""
    if isinstance(value, tuple):
        return _of_parts(map(repr, value), len(value))
    if row.type.items:
        item = next(item for item in row.type.items if item.value == value)
        prefix = re.sub(r"(?<!^)(?=[A-Z])", "_", row.type.name)
        return f"{prefix}_{item.name}".upper()
    return repr(value)


def member(row: Row, index: str) -> str:
    return f"{row.owner}[{index}].{row.field}" if row.owner != "world" else f"world.{row.field}"


def rows_present(resolved: Resolved) -> dict[str, bool]:
    return {row.key: resolved.has(row.key) for row in resolved.catalogue.rows.values()}


def structs(resolved: Resolved) -> list[Struct]:
    """One struct for each owner, doubles first and filled up to 8 bytes, so that no byte of it is padding.

    Local variables are computed when they are asked for and have no room in it.
    """
    result = []
    for owner in ("body", "contact", "world"):
        rows = [
            row
            for row in resolved.catalogue.rows.values()
            if row.owner == owner and resolved.has(row.key) and not row.role
        ]
        reals = [row for row in rows if row.type.base == "Real"]
        others = [row for row in rows if row.type.base != "Real"]
        members = [f"double {row.field}{f'[{row.dim}]' if row.dim > 1 else ''};" for row in reals]
        members += [f"int32_t {row.field};" for row in others]
        if len(others) % 2:
            members.append("int32_t fill;")
        size = 8 * sum(row.dim for row in reals) + 4 * (len(others) + len(others) % 2)
        result.append(Struct(owner, tuple(members or ["double none;"]), size or 8))
    return result


def _cells(resolved: Resolved, row: Row) -> list[tuple[int, Cell | None]]:
    """The row's cell for each element, None where the element is of another shape."""
    count = {"body": len(resolved.scene.bodies), "contact": len(resolved.scene.contacts), "world": 1}[
        row.owner
    ]
    by_element = {cell.element: cell for cell in resolved.of(row.key)}
    return [(element, by_element.get(element)) for element in range(count)]


def _branches(row: Row, statements: dict[int, tuple[str, ...]]) -> tuple[Branch, ...]:
    """Elements that do the same share a branch; the largest group comes last and needs no condition."""
    groups: dict[tuple[str, ...], list[int]] = {}
    for element, lines in statements.items():
        groups.setdefault(lines, []).append(element)
    ordered = sorted(groups.items(), key=lambda group: (len(group[1]), -group[1][0]))
    branches = []
    for number, (lines, elements) in enumerate(ordered, 1):
        condition = " || ".join(f"{row.owner} == {element}" for element in elements)
        branches.append(Branch("" if number == len(ordered) else condition, lines))
    return tuple(branches)


def _accessor(row: Row, name: str, statements: dict[int, tuple[str, ...]]) -> Accessor:
    result = C_VALUE.get(row.dim) or ("double" if row.type.base == "Real" else "int")
    branches = _branches(row, statements)
    uses_values = any("v->" in line for lines in statements.values() for line in lines)
    indexed = any(f"[{row.owner}]" in line for lines in statements.values() for line in lines)
    return Accessor(name, row.owner, result, branches, uses_values, indexed or len(branches) > 1)


def readers(resolved: Resolved) -> list[Accessor]:
    """An accessor for each parameter and input: the value, or a constant where it is pinned or not needed."""
    result = []
    for row in (row for row in resolved.catalogue.rows.values() if row.has_start):
        value = f"v->{member(row, row.owner)}"
        if row.dim > 1:
            value = _of_parts((f"{value}[{k}]" for k in range(row.dim)), row.dim)
        lines = {}
        for element, cell in _cells(resolved, row):
            fixed = cell.value if cell else _default(row)
            lines[element] = (
                f"return {value};" if cell and cell.open else f"return {constant(row, fixed)};",
            )
        result.append(_accessor(row, row.c_name, lines))
    return result


def _default(row: Row):
    if row.absent is not None:
        return number_of(row, row.absent)
    if isinstance(row.start, list):
        return tuple(map(float, row.start))
    return int(row.start) if row.type.base == "Boolean" else row.start


def writers(resolved: Resolved) -> list[Accessor]:
    """An accessor for each row the FMU computes and for the tolerance; empty where the row is absent."""
    result = []
    rows = resolved.catalogue.rows.values()
    for row in (row for row in rows if (not row.has_start and not row.role) or row.tolerance):
        target = f"v->{member(row, row.owner)}"
        if row.dim > 1:
            store = tuple(f"{target}[{k}] = value.{axis};" for k, axis in enumerate(COMPONENTS[row.dim]))
        else:
            store = (f"{target} = value;",)
        lines = {element: store if cell and cell.open else () for element, cell in _cells(resolved, row)}
        result.append(_accessor(row, f"put_{row.c_name}", lines))
    return result


def start_statements(resolved: Resolved) -> list[str]:
    """Assignments of the start values other than zero."""
    lines = []
    for variable in resolved.variables:
        if variable.start:
            row = variable.cell.row
            index = f"[{variable.component}]" if row.dim > 1 else ""
            text = constant(row, variable.start)
            lines.append(f"v->{member(row, str(variable.cell.element))}{index} = {text};")
    return lines


def _offset(variable) -> str:
    row = variable.cell.row
    if row.role:
        return "0"
    component = f"[{variable.component}]" if row.dim > 1 else ""
    return f"offsetof(struct scene_values, {member(row, str(variable.cell.element))}{component})"


def reals(resolved: Resolved) -> list[str]:
    """Initializers of scene_reals, by value reference within the blocks."""
    lines = []
    for variable in resolved.variables:
        row = variable.cell.row
        if C_BASE[row.type.base] == "REAL" and not row.role and variable.reference < BEHIND_BLOCKS:
            given = row.causality in ("parameter", "input")
            source = "GIVEN" if given else "BODY" if row.c_name in BODY_MOTION else "COMPUTED"
            length = row.dim if variable.component == 0 else 0
            bits = f"VARIABLE_{source} | {length} << VARIABLE_LENGTH"
            lines.append(f"[{variable.reference}] = {_offset(variable)} | {bits},")
    return lines


def table(resolved: Resolved) -> list[str]:
    """Initializers of struct variable, in the order of modelDescription.xml; a rate has the row of its
    state."""
    lines = []
    for variable in resolved.variables:
        cell, row = variable.cell, variable.cell.row
        low, high = (repr(float(limit)) for limit in row.limits)
        offset = _offset(variable)
        causality = C_ROLE[row.role] if row.role else C_CAUSALITY[row.causality]
        named = resolved.catalogue.rows[row.rate_of] if row.rate_of else row
        lines.append(
            f'{{"{variable.name}", {low}, {high}, {variable.reference}, {offset}, ROW_{named.c_name}, '
            f"VARIABLE_{C_BASE[row.type.base]}, VARIABLE_{causality}, {cell.element}, "
            f"{variable.component}, {row.dim}, {int(row.reinit)}, {int(row.tunable)}}},"
        )
    return lines


@dataclass(frozen=True)
class Idle:
    """A parameter that nothing reads under some choices."""

    positions: tuple[int, ...]  # of its components in the table of variables, from 0
    read: str  # condition in C under which something reads it
    choices: str  # the same as a user writes it


def idles(resolved: Resolved) -> list[Idle]:
    """What `when` says of the parameters that are open, as far as the scene leaves it open."""
    places: dict[str, list[int]] = {}
    for i, variable in enumerate(resolved.variables):
        places.setdefault(variable.cell.name, []).append(i)
    conditions = Conditions(resolved.cells, {}, resolved.scene)
    result = []
    for cell in resolved.cells:
        if cell.row.causality == "parameter" and cell.row.when and cell.open:
            ways = [_way(conditions, alternative, cell) for alternative in cell.row.when]
            ways = [way for way in ways if way is not None]
            if all(ways):
                read = " || ".join(f"({' && '.join(code for code, _ in way)})" for way in ways)
                choices = ", or ".join(" and ".join(text for _, text in way) for way in ways)
                result.append(Idle(tuple(places[cell.name]), read, choices))
    return result


def _way(conditions: Conditions, alternative: dict, cell: Cell) -> list[tuple[str, str]] | None:
    """The choices that an alternative leaves open, in C and as a user writes them; None where a pin rules the
    alternative out."""
    way = []
    for choice, items in alternative.items():
        others = [
            (other, numbers)
            for other in conditions.choices(choice, cell)
            if (numbers := {number_of(other.row, item) for item in items} - {None})
            and (other.open or other.value in numbers)
        ]
        if not others:
            return None
        if all(other.open for other, _ in others):
            first = others[0][0]
            wanted = " or ".join(
                str(item).lower() for item in items if number_of(first.row, item) is not None
            )
            code = " || ".join(dict.fromkeys(_is_one_of(*other) for other in others))
            way.append((f"({code})" if " || " in code else code, f"{first.name} = {wanted}"))
    return way


def refusals(resolved: Resolved) -> list[tuple[str, list[str], str]]:
    """Conditions in C under which parameters contradict each other, what they compare, the messages."""
    found = []
    for choices, unless, text in resolved.refusals():
        conditions = [f"({_is_one_of(cell, numbers)})" for cell, numbers in choices if cell.open]
        numbers = [
            f"{cell.row.c_name}(v, {cell.element})" if cell.open else constant(cell.row, cell.value)
            for cell in (unless.cells if unless else ())
        ]
        if unless and any(cell.open for cell in unless.cells):
            factor = f"{unless.factor!r} * " if unless.factor != 1.0 else ""
            conditions.append(f"!({numbers[0]} {unless.relation} {factor}{numbers[1]})")
        elif unless and not unless.fails():
            continue
        if conditions:
            found.append((" && ".join(conditions), numbers, text))
    return found


def _is_one_of(cell: Cell, numbers: set[int]) -> str:
    value = f"{cell.row.c_name}(v, {cell.element})"
    return " || ".join(f"{value} == {constant(cell.row, number)}" for number in sorted(numbers))


def positions(resolved: Resolved) -> dict[str, list[int]]:
    """Where the states, their rates and the event indicators are in the table of variables, from 0."""
    lists = {
        "states": resolved.in_role("state"),
        "rates": resolved.rates(),
        "indicators": resolved.in_role("indicator"),
    }
    place = {variable.reference: i for i, variable in enumerate(resolved.variables)}
    return {name: [place[variable.reference] for variable in chosen] for name, chosen in lists.items()}


def nominals(resolved: Resolved) -> list[str]:
    """Nominal values of the states."""
    return [repr(variable.cell.row.type.nominal) for variable in resolved.in_role("state")]
