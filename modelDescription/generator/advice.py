"""Remedies: what to write instead of what a scene file says, in words."""

import difflib

from .catalogue import Catalogue, Row
from .errors import allowed


def likely(name: str, known) -> str:
    """', did you mean 'contact.dashpot'?', '' where nothing is alike."""
    found = difflib.get_close_matches(name, list(known), n=1, cutoff=0.8)
    return f", did you mean '{found[0]}'?" if found else ""


def toml(value) -> str:
    """A value as a TOML file says it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(toml(one) for one in value)}]"
    return f'"{value}"' if isinstance(value, str) else str(value)


def misplaced(catalogue: Catalogue, owner: str, key: str, table: dict, experiment: dict) -> str:
    """Where a key belongs that stands in a table of bodies, of contacts or at the top, '' for an unknown key.

    owner: 'body', 'contact' or 'world'.
    """
    if owner == "world" and key in experiment:
        return f"put {key} = {toml(table[key])} under [experiment]"
    group, dot, field = key.partition(".")
    row = catalogue.rows.get(key) or catalogue.rows.get(f"{owner}.{key}")
    if row is None and dot:
        row = catalogue.rows.get(f"body.{field}") or catalogue.rows.get(f"contact.{field}")
    if row is None or not row.has_start:
        return ""
    name = key
    if not dot and row.owner != "world":
        group = table.get("name")
        name = f"{group if isinstance(group, str) else 'NAME'}.{key}"
    value = toml(table[key]) if not isinstance(table[key], dict) else "..."
    return f'put "{name}" = {value} under [start]'


def unquoted(table: dict) -> str:
    """What to write for a dotted name without quotes, which TOML takes for a table, '' if there is none."""
    for first, inner in table.items():
        path = [first]
        while isinstance(inner, dict) and inner:
            key, inner = next(iter(inner.items()))
            path.append(key)
        if len(path) > 1:
            name = ".".join(path)
            return f'the name {name} is not in quotes: write "{name}" = {toml(inner)}'
    return ""


def number_in(row: Row) -> str:
    """'a number in m', 'one integer'"""
    if row.type.base == "Integer":
        return "an integer"
    unit = f" in {row.type.unit}" if row.type.unit not in (None, "1") else ""
    return f"a number{unit}"


def other_shape(scene, catalogue: Catalogue, name: str) -> str:
    """'a plane has no radius', '' where the shape is not what is wrong."""
    owner, _, name = name.partition(".")
    bodies = {body.name: body for body in scene.bodies}
    kinds = dict.fromkeys(bodies, "body")
    for contact in scene.contacts:
        kinds[contact.name], bodies[contact.name] = "contact", scene.bodies[contact.destination]
    row = catalogue.rows.get(f"{kinds.get(owner)}.{name.partition('[')[0]}")
    if row is None or bodies[owner].has(row):
        return ""
    kept = " that touches a cylinder" if bodies[owner].keeps_axis and row.tilts else ""
    kept = " that touches no cylinder" if not bodies[owner].keeps_axis and row.kept else kept
    return f"a {bodies[owner].shape}{kept} has no {row.field}"


def unknown(where: str, name: str, known: dict, reason: str = "") -> str:
    if reason:
        return f"{where}: unknown variable '{name}': {reason} {near(name, known)}"
    vector, bracket, _ = name.rpartition("[")
    if bracket and vector in known and known[vector].row.dim > 1:
        return f"{where}: '{name}' is part of a vector (allowed: all of it, \"{vector}\" = [x, y, z])"
    return f"{where}: unknown variable '{name}'{likely(name, known)} {near(name, known)}"


def near(name: str, known: dict) -> str:
    """The allowed names that share the first part of `name`, or else its last, or all where none does."""
    group, _, field = name.partition(".")
    own = [other for other in known if other.startswith(f"{group}.")]
    same = [other for other in known if other.endswith(f".{field}") and field]
    return allowed(own or same or list(known))
