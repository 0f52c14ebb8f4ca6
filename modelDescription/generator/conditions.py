"""What `when` in variables.toml asks of a scene: may a choice have a value, what may integrate it?"""

SCENE_CVODE = "scene.cvode"  # in `when`: whether the scene may come to integrate with CVODE
SCENE_GENERAL = "scene.general"  # and by the general segment (fmu_src/integrator/general.h)


def number_of(row, value):
    """A value as written in a TOML file (already valid) as the numbers C and XML use; None for an item that
    the scene has left out of the choice."""
    if value is None:
        return None
    if isinstance(value, list):
        return tuple(float(x) for x in value)
    if row.type.items:
        item = row.type.item(value)
        return item.value if item else None
    return float(value) if row.type.base == "Real" else int(value)


def possible(choice: str, items: list, cell, cells: list, constants: dict, scene) -> bool:
    """May a choice that the row depends on have one of these items, given what is pinned?"""
    if choice == SCENE_CVODE:
        return may_need_cvode(cells, constants, scene) in items
    if choice == SCENE_GENERAL:
        return may_need_general(cells, constants, scene) in items
    for other in _choices(choice, cell, cells, scene):
        if other.row.type.items:  # of these a scene may leave a choice some only
            items = [item for item in items if other.row.type.item(item)]
        wanted = [number_of(other.row, item) for item in items]
        if wanted and (other.name not in constants or constants[other.name] in wanted):
            return True
    return False


def _choices(choice: str, cell, cells: list, scene) -> list:
    """The cells that `choice`, in `when` of the cell's row, speaks of."""
    anyone = choice.startswith("any ")
    group, _, field = choice.removeprefix("any ").partition(".")
    element = cell.element
    if cell.row.owner == "contact" and group in ("source", "destination"):
        element, group = getattr(scene.contacts[cell.element], group), "body"
    key = f"{group}.{field}"
    return [other for other in cells if other.row.key == key and (anyone or other.element == element)]


def why_not(cell, cells: list, constants: dict, scene) -> tuple[str, str]:
    """Which pins leave no use for a cell, and what would: 'contact.method = penalty is pinned', '...'."""
    pins, remedies = [], []
    for alternative in cell.row.when:
        for choice, items in alternative.items():
            if possible(choice, items, cell, cells, constants, scene):
                continue
            others = _choices(choice, cell, cells, scene)
            pins += [f"{one.name} = {_item(one.row, constants.get(one.name))}" for one in others]
            wanted = " or ".join(str(item).lower() for item in items)
            remedies += [f"{one.name} = {wanted}" for one in others]
    pins, remedies = list(dict.fromkeys(pins)), list(dict.fromkeys(remedies))
    if not pins:
        return "nothing here uses it", "other variables"
    verb = "is" if len(pins) == 1 else "are"
    return f"{' and '.join(pins)} {verb} pinned", " or ".join(remedies)


def _item(row, number) -> str:
    """The value of a choice as a scene file says it; None: all that it has been left."""
    if number is None:
        return str([item.name for item in row.type.items])
    if row.type.base == "Boolean":
        return "true" if number else "false"
    return next(item.name for item in row.type.items if item.value == number)


def may_need_cvode(cells: list, constants: dict, scene) -> bool:
    """The CVODE methods ask for it. Free is a body too that turns freely."""
    methods = any(
        _may_be(cells, constants, "solver.method", method, 0) for method in ("cvode_bdf", "cvode_adams")
    )
    return methods and bool(_free(cells, constants, scene))


def may_need_general(cells: list, constants: dict, scene) -> bool:
    """event_driven asks for it where contacts share a body that may be free, where bodies may turn or rub."""
    free = _free(cells, constants, scene)
    if not free or not _may_be(cells, constants, "solver.method", "event_driven", 0):
        return False
    ends = [body for contact in scene.contacts for body in (contact.source, contact.destination)]
    turns = [("body.rotation", how, i) for i in range(len(scene.bodies)) for how in ("prescribed", "free")]
    rubs = [
        ("contact.friction", law, i) for i in range(len(scene.contacts)) for law in ("regularized", "elastic")
    ]
    return any(ends.count(body) > 1 for body in free) or any(
        _may_be(cells, constants, *choice) for choice in turns + rubs
    )


def _free(cells: list, constants: dict, scene) -> list[int]:
    """The bodies that may be free, or turn freely."""
    kinds = ("body.motion", "body.rotation")
    return [
        body
        for body in range(len(scene.bodies))
        if any(_may_be(cells, constants, kind, "free", body) for kind in kinds)
    ]


def _may_be(cells: list, constants: dict, key: str, item: str, element: int) -> bool:
    """May a choice have this item?"""
    return any(
        cell.name not in constants or constants[cell.name] == number_of(cell.row, item)
        for cell in cells
        if cell.row.key == key and cell.element == element and cell.row.type.item(item)
    )
