"""Reading variables.toml, and what is wrong with it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from .catalogue import BEHIND_BLOCKS, Catalogue, Item, Row, Type
from .conditions import SCENE_CVODE, SCENE_GENERAL, SCENE_SEVERAL
from .errors import InputError, allowed

ROW_KEYS = {
    "vr", "type", "causality", "start", "start_destination", "min", "max", "dim", "symbol", "description",
    "shape", "absent", "of_plane", "of_torus",
    "when", "refused", "tolerance", "depends", "discrete", "role", "rate_of", "reinit",
    "tilts", "kept", "tunable",
}  # fmt: skip
TYPE_KEYS = {"base", "quantity", "unit", "display", "min", "max", "nominal", "description", "items"}
CAUSALITIES = ("parameter", "calculatedParameter", "input", "output", "local")
ROLES = ("state", "rate", "indicator")  # of local variables
BASES = ("Real", "Integer", "Boolean", "Enumeration")
DEPENDENCIES = ("dependent", "fixed", "tunable")  # of those that FMI 2.0 has


def read_toml(path: Path, shown: str) -> dict:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))  # some editors begin a file with a mark
    except tomllib.TOMLDecodeError as error:
        raise InputError(shown, f"not valid TOML: {error}") from None
    except UnicodeDecodeError as error:
        raise InputError(shown, f"not valid UTF-8: byte {error.start}") from None
    except OSError as error:
        raise InputError(shown, f"cannot be read: {error.strerror}") from None


def read_catalogue(path: Path) -> Catalogue:
    shown = f"{path.parent.name}/{path.name}"
    data = read_toml(path, shown)
    try:
        types = {name: _type(name, dict(entry), shown) for name, entry in data["type"].items()}
        rows = {key: _row(key, entry, types, shown) for key, entry in data["variable"].items()}
        catalogue = Catalogue(data["project"], data["unit"], types, rows)
    except (KeyError, TypeError) as error:
        raise InputError(shown, f"incomplete: {error}") from None
    _check_units(catalogue, shown)
    _check_ranges(catalogue, shown)
    _check_references(catalogue, shown)
    _check_dependencies(catalogue, shown)
    _check_rates(catalogue, shown)
    return catalogue


def _type(name: str, entry: dict, shown: str) -> Type:
    for key in entry.keys() - TYPE_KEYS:
        raise InputError(shown, f"[type.{name}]: unknown key '{key}' {allowed(TYPE_KEYS)}")
    if entry["base"] not in BASES:
        raise InputError(shown, f"[type.{name}]: unknown base '{entry['base']}' {allowed(BASES)}")
    items = entry.pop("items", {})
    entry["items"] = tuple(
        Item(item, fields["value"], fields["description"]) for item, fields in items.items()
    )
    return Type(name, **entry)


def _row(key: str, entry: dict, types: dict[str, Type], shown: str) -> Row:
    where = f'[variable."{key}"]'
    for unknown in entry.keys() - ROW_KEYS:
        raise InputError(shown, f"{where}: unknown key '{unknown}' {allowed(ROW_KEYS)}")
    if entry["type"] not in types:
        raise InputError(shown, f"{where}: unknown type '{entry['type']}' {allowed(types)}")
    if entry["causality"] not in CAUSALITIES:
        raise InputError(shown, f"{where}: unknown causality '{entry['causality']}' {allowed(CAUSALITIES)}")
    if ("start" in entry) != (entry["causality"] in ("parameter", "input")):
        raise InputError(shown, f"{where}: 'start' belongs to parameters and inputs and only to them")
    if (entry["causality"] == "local") != (entry.get("role") in ROLES):
        raise InputError(
            shown, f"{where}: 'role' belongs to local variables and only to them {allowed(ROLES)}"
        )
    if entry.get("tunable") and entry["causality"] not in ("parameter", "calculatedParameter"):
        raise InputError(shown, f"{where}: 'tunable' belongs to parameters and only to them")
    fields = {**entry, "type": types[entry["type"]]}
    for several in ("when", "shape", "refused"):
        fields[several] = tuple(entry.get(several, ()))
    for of in {"of_plane", "of_torus"} & entry.keys():
        fields[of] = _of_shape(entry[of], types, where, shown, of)
    return Row(key, **fields)


def _of_shape(entry: dict, types: dict[str, Type], where: str, shown: str, of: str) -> dict:
    known = ("type", "description", "refused")
    for unknown in entry.keys() - set(known):
        raise InputError(shown, f"{where}: unknown key '{of}.{unknown}' {allowed(known)}")
    return {**entry, "type": types[entry["type"]]} if "type" in entry else dict(entry)


def _check_units(catalogue: Catalogue, shown: str) -> None:
    for kind in catalogue.types.values():
        if kind.base == "Real" and kind.unit not in catalogue.units:
            known = allowed(catalogue.units)
            raise InputError(shown, f"[type.{kind.name}]: unknown unit '{kind.unit}' {known}")
        displays = catalogue.units[kind.unit].get("display", {}) if kind.unit else {}
        if kind.display and kind.display not in displays:
            known = allowed(displays)
            raise InputError(shown, f"[type.{kind.name}]: unknown display unit '{kind.display}' {known}")


def _check_ranges(catalogue: Catalogue, shown: str) -> None:
    """A variable may narrow the range of its type and not widen it (FMI 2.0.5, section 2.2.7)."""
    for row in catalogue.rows.values():
        if row.type.base in ("Real", "Integer"):
            (low, high), kind = row.limits, row.type
            if not kind.min <= low <= high <= kind.max:
                outer = f"(allowed: within {kind.min!r} to {kind.max!r})"
                raise InputError(shown, f'[variable."{row.key}"]: range {low!r} to {high!r} {outer}')


def _check_references(catalogue: Catalogue, shown: str) -> None:
    """No value reference of a block is given twice; conditions speak of choices that exist."""
    used: dict[tuple[str, int], str] = {}
    of_bodies = {
        vr: row.key
        for row in catalogue.rows.values()
        if row.owner == "body"
        for vr in range(row.vr, row.vr + row.dim)
    }
    choices = [*catalogue.choices(), SCENE_CVODE, SCENE_GENERAL, SCENE_SEVERAL]
    for row in catalogue.rows.values():
        for vr in range(row.vr, row.vr + row.dim):
            other = used.setdefault((row.owner, vr), row.key)
            next_block = row.owner == "contact" and 100 <= vr < 200  # one of a body
            other = of_bodies.get(vr - 100, other) if next_block else other
            behind = row.owner != "world" and BEHIND_BLOCKS < vr < BEHIND_BLOCKS + 100
            if other != row.key or not (0 < vr < 100 or next_block or behind):
                raise InputError(
                    shown, f'[variable."{row.key}"]: value reference {vr} is out of 1..99 or that of {other}'
                )
        for refused in (*row.refused, *row.of_plane.get("refused", ())):
            for key in (*refused["if"], *re.findall(r"[a-z]\S+", refused.get("unless", ""))):
                if key.replace("destination.", "body.").replace("source.", "body.") not in catalogue.rows:
                    raise InputError(
                        shown, f"[variable.\"{row.key}\"]: unknown variable '{key}' in 'refused'"
                    )
        for alternative in row.when:
            for choice in alternative:
                plain = (
                    choice.removeprefix("any ").replace("destination.", "body.").replace("source.", "body.")
                )
                if plain not in choices:
                    raise InputError(
                        shown, f"[variable.\"{row.key}\"]: unknown choice '{choice}' {allowed(choices)}"
                    )


def _check_dependencies(catalogue: Catalogue, shown: str) -> None:
    """Outputs alone depend on inputs and states, on those that exist, in a way that FMI knows."""
    known = [row.key for row in catalogue.rows.values() if row.causality == "input" or row.role == "state"]
    for row in catalogue.rows.values():
        where = f'[variable."{row.key}"]: depends'
        if row.depends and row.causality != "output":
            raise InputError(shown, f"{where} belongs to outputs and only to them")
        for key, kind in row.depends.items():
            if key not in known:
                raise InputError(shown, f"{where}: unknown input or state '{key}' {allowed(known)}")
            if kind not in DEPENDENCIES:
                raise InputError(shown, f"{where}: '{key}' is {kind!r} {allowed(DEPENDENCIES)}")


def _check_rates(catalogue: Catalogue, shown: str) -> None:
    """Each state has one rate of its own size and owner."""
    states = {row.key: row for row in catalogue.rows.values() if row.role == "state"}
    rates = [row for row in catalogue.rows.values() if row.role == "rate" or row.rate_of]
    for row in rates:
        state = states.get(row.rate_of)
        if state is None or (state.owner, state.dim) != (row.owner, row.dim) or row.role != "rate":
            raise InputError(
                shown, f"[variable.\"{row.key}\"]: 'rate_of' is {row.rate_of!r} {allowed(list(states))}"
            )
    for key in states:
        if sum(row.rate_of == key for row in rates) != 1:
            raise InputError(shown, f'[variable."{key}"]: a state with other than one rate (allowed: one)')
