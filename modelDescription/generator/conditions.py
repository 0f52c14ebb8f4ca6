"""What `when` in variables.toml asks of a scene: may a choice have a value, may CVODE be needed?"""

SCENE_CVODE = "scene.cvode"  # in `when`: whether the scene may come to integrate with CVODE


def number_of(row, value):
    """A value as written in a TOML file (already valid) as the numbers C and XML use."""
    if value is None:
        return None
    if isinstance(value, list):
        return tuple(float(x) for x in value)
    if row.type.base == "Enumeration":
        return row.type.item(value).value
    return float(value) if row.type.base == "Real" else int(value)


def possible(choice: str, items: list, cell, cells: list, constants: dict, scene) -> bool:
    """May a choice that the row depends on have one of these items, given what is pinned?"""
    if choice == SCENE_CVODE:
        return may_need_cvode(cells, constants, scene) in items
    anyone = choice.startswith("any ")
    group, _, field = choice.removeprefix("any ").partition(".")
    element = cell.element
    if cell.row.owner == "contact" and group in ("source", "destination"):
        element, group = getattr(scene.contacts[cell.element], group), "body"
    for other in cells:
        if other.row.key == f"{group}.{field}" and (anyone or other.element == element):
            wanted = [number_of(other.row, item) for item in items]
            if other.name not in constants or constants[other.name] in wanted:
                return True
    return False


def may_need_cvode(cells: list, constants: dict, scene) -> bool:
    """The CVODE methods ask for it, and event_driven where contacts share a body that may be free."""

    def may_be(key: str, item: str, element: int) -> bool:
        return any(
            cell.name not in constants or constants[cell.name] == cell.row.type.item(item).value
            for cell in cells
            if cell.row.key == key and cell.element == element
        )

    free = [body for body in range(len(scene.bodies)) if may_be("body.motion", "free", body)]
    methods = any(may_be("solver.method", method, 0) for method in ("cvode_bdf", "cvode_adams"))
    ends = [body for contact in scene.contacts for body in (contact.source, contact.destination)]
    return bool(free) and (methods or any(ends.count(body) > 1 for body in free))
