"""What the documentation page needs beyond the variables: tables, choices and symbols as HTML."""

import re

from markupsafe import Markup, escape

from .catalogue import Row
from .cell import Cell, shortest
from .resolve import Resolved

# Parameters and inputs keep to it, so that squares and products stay inside a double (variables.toml).
LARGEST_GIVEN = 1e150


def context(resolved: Resolved) -> dict:
    return {
        "groups": _groups(resolved),
        "choices": [cell for cell in resolved.cells if cell.open and _is_choice(cell)],
        "constants": [cell for cell in resolved.cells if cell.pinned],
        "example": _example(resolved),
        "tunable": [
            cell.name for cell in resolved.cells if cell.open and cell.row.has_start and cell.row.tunable
        ],
        "may": {choice: _may(resolved, *choice.split("=")) for choice in CHOICES},
        "free": [
            body.name
            for i, body in enumerate(resolved.scene.bodies)
            if resolved.may("body.motion", "free", i) or resolved.may("body.rotation", "free", i)
        ],
        "turning": _turning(resolved),
        "connect": _connect(resolved),
    }


def _turning(resolved: Resolved) -> dict:
    """Shapes of bodies by what rotation and inertia may be; destinations whose axis may turn."""
    scene = resolved.scene

    def shapes(key: str, value: str) -> set[str]:
        bodies = [scene.bodies[cell.element] for cell in resolved.of(key) if _offers(cell, value)]
        return {"roller" if body.keeps_axis else body.shape for body in bodies}

    hit = {contact.destination for contact in scene.contacts}
    turned = [
        cell
        for cell in resolved.of("body.rotation")
        if cell.element in hit and (_offers(cell, "prescribed") or _offers(cell, "free"))
    ]
    return {
        "free": shapes("body.rotation", "free") - {"plane"},  # which is refused: it has no inertia
        "prescribed": (prescribed := shapes("body.rotation", "prescribed")),
        "prescribed_axes": sorted(prescribed - {"sphere", "roller", "compound"}),
        "automatic": shapes("body.inertia_control", "automatic"),
        "user_defined": shapes("body.inertia_control", "user_defined"),
        "destinations": [
            cell
            for cell in turned
            if scene.bodies[cell.element].shape not in ("sphere", "compound")
            and not scene.bodies[cell.element].keeps_axis
        ],
        "hollow_sphere": any(
            scene.bodies[scene.contacts[cell.element].destination].shape == "sphere"
            for cell in resolved.of("contact.location")
            if _offers(cell, "inside") or _offers(cell, "automatic")
        ),
    }


def _connect(resolved: Resolved) -> Markup:
    """The inputs of bodies, by their names without the body: a, b and c."""
    cells = [cell for cell in resolved.cells if cell.open and cell.row.owner == "body"]
    names = dict.fromkeys(cell.row.field for cell in cells if cell.row.causality == "input")
    codes = [Markup("<code>{}</code>").format(name) for name in names]
    return Markup(", ").join(codes[:-1]) + Markup(" and " if codes[:-1] else "") + codes[-1]


def _example(resolved: Resolved) -> dict:
    """For the script on the page: at most two parameters with values that the FMU takes, and two outputs."""
    start = []
    for variable in resolved.variables:
        row = variable.cell.row
        if row.key == "body.mass" and not start:
            start.append((variable.name, shortest(2 * variable.start), "kg"))
        if row.key == "contact.dashpot" and len(start) < 2:
            item = next(item for item in row.type.items if item.value != variable.start)
            start.append((variable.name, item.value, item.name))
    outputs = [variable.name for variable in resolved.variables if not variable.cell.row.has_start]
    ends = {name.rpartition(".")[2] for name in outputs}
    force = "peak_force" if "peak_force" in ends else "normal_force"  # a short impact shows in the peak alone
    wanted = [name for name in outputs if name.rpartition(".")[2] in ("gap", force)]
    return {"start": start, "outputs": (wanted or outputs)[:2]}


# The conditions under which the page explains something.
CHOICES = (
    "contact.location=automatic", "contact.location=outside", "contact.location=inside",
    "contact.method=penalty", "contact.method=penalty_dynamic",
    "contact.penalty_control=automatic", "contact.penalty_control=user_defined",
    "contact.penalty_control=viscous_only",
    "contact.viscous_control=automatic", "contact.viscous_control=user_defined",
    "contact.viscous_control=restitution",
    "contact.law=linear", "contact.law=hertz",
    "contact.dashpot=non_adhesive", "contact.dashpot=unclamped", "contact.dashpot=approach_only",
    "body.motion=fixed", "body.motion=prescribed", "body.motion=free",
    "body.finite_length=true", "body.finite_length=false",
    "body.ends=open", "body.ends=capped",
    "body.rotation=none",
    "contact.friction=none", "contact.friction=regularized", "contact.slip_velocity_control=automatic",
)  # fmt: skip


def _may(resolved: Resolved, key: str, value: str) -> bool:
    """False too where the choice itself plays no part, as a dashpot does not for the penalty method."""
    return any(_offers(cell, value) for cell in resolved.of(key))


def _offers(cell: Cell, value: str) -> bool:
    return (cell.open and cell.offers(value)) or (cell.pinned and cell.value_name == value)


def _is_choice(cell: Cell) -> bool:
    return cell.row.causality == "parameter" and (
        bool(cell.row.type.items) or cell.row.type.base == "Boolean"
    )


def _groups(resolved: Resolved) -> list[tuple[str, list[Cell]]]:
    """Cells of the FMU under the first part of their names, in the order of modelDescription.xml."""
    groups: dict[str, list[Cell]] = {}
    for variable in resolved.variables:
        cells = groups.setdefault(variable.cell.name.partition(".")[0], [])
        if variable.cell not in cells:
            cells.append(variable.cell)
    return list(groups.items())


def symbol(text: str | None) -> Markup:
    """r_s -> r with subscript s; what follows in brackets stays on the line."""
    if not text:
        return Markup("")
    match = re.fullmatch(r"([^_]+)_([^(]+)(\(.*\))?", text)
    if not match:
        return Markup("<i>{}</i>").format(text)
    base, index, rest = match.groups()
    return Markup("<i>{}</i><sub>{}</sub>{}").format(base, index, rest or "")


def limit(value) -> str:
    """Shortest text of a number that reads back as the same."""
    if value is None:
        return ""
    return str(escape(shortest(value)))


def own_range(row: Row) -> bool:
    """Whether a row narrows the range that its type and causality give, so that the page has to tell."""
    if row.type.base not in ("Real", "Integer"):
        return False
    low, high = row.type.min, row.type.max
    if row.has_start:
        low, high = max(low, -LARGEST_GIVEN), min(high, LARGEST_GIVEN)
    return row.limits != (low, high)
