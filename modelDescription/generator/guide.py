"""docs/scenes.md: every key of a scene file, from the schema in scene.py and from variables.toml."""

from .catalogue import Catalogue, Row
from .cell import shortest
from .resolve import Resolved, resolve
from .scene import (
    BODY_KEYS,
    CONTACT_KEYS,
    EXPERIMENT,
    EXPERIMENT_KEYS,
    PART_KEYS,
    SCENE_KEYS,
    Body,
    Contact,
    Scene,
)

OWNERS = {"body": "BODY", "contact": "CONTACT", "world": ""}  # how the page names what a scene names itself


def context(catalogue: Catalogue) -> dict:
    """What the template scenes.md needs."""
    rows = catalogue.rows.values()
    return {
        "keys": {"scene": SCENE_KEYS, "body": BODY_KEYS, "part": PART_KEYS, "contact": CONTACT_KEYS},
        "experiment": [(key, shortest(EXPERIMENT[key]), text) for key, text in EXPERIMENT_KEYS.items()],
        "settings_of": {owner: [_setting(row) for row in rows if _is_of(row, owner)] for owner in OWNERS},
        "choices": [_choice(catalogue, row) for row in catalogue.choices().values()],
        "outputs": {
            owner: [_name(row) for row in rows if row.owner == owner and not row.has_start]
            for owner in OWNERS
        },
    }


def _is_of(row: Row, owner: str) -> bool:
    return row.owner == owner and row.has_start


def _name(row: Row) -> str:
    """BODY.mass, CONTACT.method, solver.method"""
    return row.key if row.owner == "world" else f"{OWNERS[row.owner]}.{row.field}"


def _setting(row: Row) -> dict[str, str]:
    """Cells of a parameter or an input; an input cannot be pinned."""
    start = _toml(row, row.start)
    if row.start_destination is not None:
        start += f"; {_toml(row, row.start_destination)} where it is only hit"
    own = bool(row.shape)
    names = {"body": "the body", "source": "the source", "destination": "the destination"}
    text = row.description.format(**names)
    for shape, other in (("plane", row.of_plane), ("torus", row.of_torus)):
        if "description" in other:
            text += f". Of a {shape}: {other['description'].format(**names)}"
    return {
        "name": _name(row),
        "start": start,
        "allowed": _allowed(row),
        "text": text
        + (f" ({'a' if row.owner == 'body' else 'with a'} {' or '.join(row.shape)} only)" if own else ""),
        "input": "input" if row.causality == "input" else "parameter",
    }


def _toml(row: Row, value) -> str:
    if isinstance(value, list):
        return f"[{', '.join(shortest(x) for x in value)}]"
    if row.type.base == "Boolean":
        return "true" if value else "false"
    return f'"{value}"' if row.type.items else shortest(value)


def _allowed(row: Row) -> str:
    if row.type.items:
        return ", ".join(f'"{item.name}"' for item in row.type.items)
    if row.type.base == "Boolean":
        return "true, false"
    low, high = (shortest(limit) for limit in row.limits)
    unit = f" {row.type.unit}" if row.type.unit not in (None, "1") else ""
    count = f"{row.dim} numbers, " if row.dim > 1 else ""
    return f"{count}{low} to {high}{unit}"


def _choice(catalogue: Catalogue, row: Row) -> dict:
    """What each pinned item of a choice leaves out of a pair of sphere and cylinder, or other shape."""
    kind = row.type
    items = [(i.name, i.name, i.description) for i in kind.items] or [
        ("true", True, row.description.format(body="the body")),
        ("false", False, "not so"),
    ]
    owners = {"body": ["source", "destination"], "contact": ["contact"], "world": [""]}[row.owner]
    if row.owner == "body" and row.shape:  # only the destination may be a cylinder
        owners = ["destination"]
    shape = "cylinder" if not row.shape or "cylinder" in row.shape else row.shape[0]
    names = [f"{owner}.{row.field}" if owner else row.key for owner in owners]
    lines = []
    for shown, item, text in items:
        one = _left_out(catalogue, shape, {names[0]: item})
        lines.append({"pin": f"{names[0]} = {shown}", "text": text, "gone": one})
        if len(names) > 1:
            every = _left_out(catalogue, shape, dict.fromkeys(names, item))
            more = [name for name in every if name.partition(".")[0] not in owners]
            if more:
                lines.append({"pin": f"every body's {row.field} = {shown}", "text": "", "gone": more})
    return {"name": _name(row), "text": row.description.format(
        body="the body", source="the source", destination="the destination"), "lines": lines}  # fmt: skip


def _pair(catalogue: Catalogue, shape: str, pinned: dict) -> Resolved:
    bodies = (Body("source", "sphere", 0), Body("destination", shape, 1))
    contacts = (Contact("contact", 0, 1, 0),)
    return resolve(Scene("scenes.md", "Pair", "Pair", "Pair", bodies, contacts, {}, pinned), catalogue)


def _left_out(catalogue: Catalogue, shape: str, pinned: dict) -> list[str]:
    """Variables, in the order of the catalogue, that the pins take away besides themselves; CVODE last."""
    before, after = _pair(catalogue, shape, {}), _pair(catalogue, shape, pinned)
    present = {cell.name for cell in after.cells if cell.open}
    gone = [cell.name for cell in before.cells if cell.open and cell.name not in present]
    gone = [name for name in gone if name not in pinned]
    return gone + (["SUNDIALS CVODE"] if before.may_need_cvode and not after.may_need_cvode else [])
