"""What `when` in variables.toml asks of a scene: may a choice have a value, what may integrate it?"""

from functools import cached_property

SCENE_CVODE = "scene.cvode"  # in `when`: whether the scene may come to integrate with CVODE
SCENE_GENERAL = "scene.general"  # and by the general segment (fmu_src/integrator/general.h)
SCENE_SEVERAL = "scene.several"  # whether it has two contacts or more


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


class Conditions:
    """The cells of a scene, of which some are pinned to `constants`."""

    def __init__(self, cells: list, constants: dict, scene):
        self.constants, self.scene = constants, scene
        self.of: dict[str, dict[int, object]] = {}  # cells by their row's key and their element
        for cell in cells:
            self.of.setdefault(cell.row.key, {})[cell.element] = cell

    def possible(self, choice: str, items: list, cell) -> bool:
        """May a choice that the row depends on have one of these items, given what is pinned?"""
        if choice == SCENE_CVODE:
            return self.may_need_cvode in items
        if choice == SCENE_GENERAL:
            return self.may_need_general in items
        if choice == SCENE_SEVERAL:
            return (len(self.scene.contacts) > 1) in items
        for other in self.choices(choice, cell):
            if other.row.type.items:  # of these a scene may leave a choice some only
                items = [item for item in items if other.row.type.item(item)]
            wanted = [number_of(other.row, item) for item in items]
            if wanted and (other.name not in self.constants or self.constants[other.name] in wanted):
                return True
        return False

    def choices(self, choice: str, cell) -> list:
        """The cells that `choice`, in `when` of the cell's row, speaks of."""
        anyone = choice.startswith("any ")
        group, _, field = choice.removeprefix("any ").partition(".")
        element = cell.element
        if cell.row.owner == "contact" and group in ("source", "destination"):
            element, group = getattr(self.scene.contacts[cell.element], group), "body"
        others = self.of.get(f"{group}.{field}", {})
        return list(others.values()) if anyone else [others[element]] if element in others else []

    def why_not(self, cell) -> tuple[str, str]:
        """Which pins leave no use for a cell, and what would: 'contact.method = penalty is pinned', '...'."""
        pins, remedies = [], []
        for alternative in cell.row.when:
            for choice, items in alternative.items():
                if self.possible(choice, items, cell):
                    continue
                others = self.choices(choice, cell)
                pins += [f"{one.name} = {_item(one.row, self.constants.get(one.name))}" for one in others]
                wanted = " or ".join(str(item).lower() for item in items)
                remedies += [f"{one.name} = {wanted}" for one in others]
        pins, remedies = list(dict.fromkeys(pins)), list(dict.fromkeys(remedies))
        if not pins:
            return "nothing here uses it", "other variables"
        verb = "is" if len(pins) == 1 else "are"
        return f"{' and '.join(pins)} {verb} pinned", " or ".join(remedies)

    @cached_property
    def may_need_cvode(self) -> bool:
        """The CVODE methods ask for it. Free is a body too that turns freely."""
        methods = any(self._may_be("solver.method", method, 0) for method in ("cvode_bdf", "cvode_adams"))
        return methods and bool(self._free)

    @cached_property
    def may_need_general(self) -> bool:
        """event_driven asks for it where contacts share a body that may be free, where bodies may turn or
        rub."""
        if not self._free or not self._may_be("solver.method", "event_driven", 0):
            return False
        ends = [body for contact in self.scene.contacts for body in (contact.source, contact.destination)]
        turns = any(
            self._may_be("body.rotation", how, i)
            for how in ("prescribed", "free")
            for i in range(len(self.scene.bodies))
        )
        rubs = any(
            self._may_be("contact.friction", law, i)
            for law in ("regularized", "elastic")
            for i in range(len(self.scene.contacts))
        )
        series = any(body.shape in ("torus", "compound") for body in self.scene.bodies)
        skew = any(self._may_be("contact.axes", "skew", i) for i in range(len(self.scene.contacts)))
        return series or skew or any(ends.count(body) > 1 for body in self._free) or turns or rubs

    @cached_property
    def _free(self) -> list[int]:
        """The bodies that may be free, or turn freely."""
        kinds = ("body.motion", "body.rotation")
        bodies = range(len(self.scene.bodies))
        return [body for body in bodies if any(self._may_be(kind, "free", body) for kind in kinds)]

    def _may_be(self, key: str, item: str, element: int) -> bool:
        """May a choice have this item?"""
        cell = self.of.get(key, {}).get(element)
        if cell is None or not cell.row.type.item(item):
            return False
        return cell.name not in self.constants or self.constants[cell.name] == number_of(cell.row, item)


def _item(row, number) -> str:
    """The value of a choice as a scene file says it; None: all that it has been left."""
    if number is None:
        return str([item.name for item in row.type.items])
    if row.type.base == "Boolean":
        return "true" if number else "false"
    return next(item.name for item in row.type.items if item.value == number)
