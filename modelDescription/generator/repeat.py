"""Scene files that repeat bodies and contacts: `Repeats` makes the plain tables that they stand for."""

import re
from dataclasses import dataclass

from .errors import allowed

MOST = 1000  # bodies, and contacts, of a scene
INDEX = re.compile(r"\{([ij])(?:([+-])([0-9]+))?\}")


@dataclass(frozen=True)
class Entry:
    """A body or a contact of the plain scene."""

    table: dict
    where: str  # it stands in the file, for messages
    number: int  # of its value references; the counts of other entries do not change it


def fill(text, i: int, j: int = 0):
    """The text with `{i}`, `{j}` and `{i+1}` as numbers."""

    def number(found) -> str:
        shift = int(found[3] or 0)
        return str({"i": i, "j": j}[found[1]] + (-shift if found[2] == "-" else shift))

    return INDEX.sub(number, text) if isinstance(text, str) else text


def _pair_number(i: int, j: int, of_one_group: bool) -> int:
    """A number from 0 for each pair of positions from 1, which a longer group does not change."""
    if of_one_group:
        return (j - 1) * (j - 2) // 2 + i - 1
    shell = max(i, j) - 1
    return shell * shell + (i - 1 if j > i else shell + j - 1)


class Repeats:
    """The entries of a file. `fail(where, text)` raises; `bodies` and `contacts` are its tables as read."""

    def __init__(self, fail, bodies: list[dict], contacts: list[dict], groups: dict):
        self.fail, self.groups = fail, groups
        self.stride = max(len(bodies), len(contacts))  # between the numbers of the copies of an entry
        self.copies: dict[str, list[str]] = {}  # names of the copies of `ball[{i}]`
        self.kinds: dict[str, str] = {}  # whether they are of a body or of a contact
        self.bodies = self._made("body", bodies, self._of_body)
        self.names = [entry.table.get("name") for entry in self.bodies]
        for name, members in groups.items():
            self._check_group(name, members)
        self.contacts = self._made("contact", contacts, self._of_contact)

    def _made(self, kind: str, tables: list[dict], copies_of) -> list[Entry]:
        result = []
        for k, table in enumerate(tables):
            where = f"[[{kind}]] {k + 1}"
            plain = {key: value for key, value in table.items() if key != "count"}
            made = [
                Entry(
                    {key: fill(value, i, j) for key, value in (plain | ends).items()},
                    where,
                    k + self.stride * copy,
                )
                for copy, i, j, ends in copies_of(where, table)
            ]
            result += made
            if len(result) > MOST:
                self.fail(
                    where, f"it makes {len(result)} entries of [[{kind}]] (allowed: at most {MOST} in all)"
                )
            if INDEX.search(str(table.get("name"))):
                self.copies[table["name"]] = [entry.table["name"] for entry in made]
                self.kinds[table["name"]] = kind
        return result

    def _count(self, where: str, table: dict, indexed) -> int | None:
        """The count of a table; None where it has none."""
        count = table.get("count")
        wants = [key for key in indexed if INDEX.search(str(table.get(key)))]
        if count is None and wants:
            self.fail(
                where, f"'{wants[0]}' is {table[wants[0]]!r} without a count (allowed: count = 9 or so)"
            )
        if count is not None and (type(count) is not int or not 1 <= count <= MOST):
            self.fail(where, f"'count' is {count!r} (allowed: a whole number from 1 to {MOST})")
        if count is not None:
            self._check_name(where, table, f"count = {count}")
        return count

    def _check_name(self, where: str, table: dict, reason: str) -> None:
        if not INDEX.search(str(table.get("name"))):
            example = f"{table.get('name')}[{{i}}]"
            self.fail(
                where, f"'name' is {table.get('name')!r} with {reason} (allowed: one with {{i}}: {example})"
            )

    def _of_body(self, where: str, table: dict):
        for copy in range(self._count(where, table, ("name",)) or 1):
            yield copy, copy + 1, 0, {}

    def _of_contact(self, where: str, table: dict):
        count = self._count(where, table, ("source", "destination"))
        if count is not None:
            for copy in range(count):
                yield copy, copy + 1, 0, {}
            return
        source, destination = table.get("source"), table.get("destination")
        if not (self._is_group(source) or self._is_group(destination)):
            yield 0, 0, 0, {}
            return
        self._check_name(where, table, "groups of bodies")
        of_one = source == destination
        for i, one in enumerate(self._members(where, source), 1):
            for j, other in enumerate(self._members(where, destination), 1):
                ends = {"source": one, "destination": other}
                if not self._is_group(source):  # `{i}` counts the only group there is
                    yield j - 1, j, j, ends
                elif not self._is_group(destination):
                    yield i - 1, i, i, ends
                elif not of_one or i < j:
                    yield _pair_number(i, j, of_one), i, j, ends
        if of_one and len(self._members(where, source)) == 1:
            self.fail(where, f"'{source}' has one body and so no pair (allowed: a group of two or more)")

    def _is_group(self, name) -> bool:
        return isinstance(name, str) and (name in self.groups or "*" in name)

    def _members(self, where: str, name: str) -> list[str]:
        """The bodies of a group, of `ball[*]` or of a single name."""
        if name in self.groups:
            return [one for part in self.groups[name] for one in self._members(where, part)]
        if "*" not in name:
            return [name]
        pattern = re.compile(re.escape(name).replace(r"\*", "[0-9]+"))
        found = [one for one in self.names if isinstance(one, str) and pattern.fullmatch(one)]
        if not found:
            self.fail(where, f"group '{name}' is empty {allowed([one for one in self.names if one])}")
        return found

    def _check_group(self, name: str, members) -> None:
        where = "[groups]"
        if name in self.names:
            self.fail(where, f"'{name}' is the name of a body (allowed: any other name)")
        if not isinstance(members, list) or not all(isinstance(one, str) for one in members) or not members:
            text = "is empty" if members == [] else f"is {members!r}"
            self.fail(where, f"group '{name}' {text} (allowed: a list of one or more names of bodies)")
        for part in members:
            if "*" not in part and part not in self.names:
                self.fail(where, f"'{part}' of group '{name}' is no body {allowed(self.names)}")
            self._members(where, part)

    def values(self, where: str, table: dict, is_list) -> dict:
        """A table of names and values with its repeated names written out; a name of its own goes first.
        is_list(kind, field, value): whether the value is a list with one for each copy."""
        result = {}
        for key, value in table.items():
            owner, dot, field = key.partition(".")
            for name, each in self._each(where, key, owner, dot + field, value, is_list):
                result[name] = each
        return result | {key: value for key, value in table.items() if key in result}

    def _each(self, where: str, key: str, owner: str, field: str, value, is_list):
        if not INDEX.search(owner):
            return [(key, value)]
        if owner not in self.copies:
            self.fail(where, f"'{key}' is of nothing that is repeated {allowed(list(self.copies))}")
        names = self.copies[owner]
        values = [value] * len(names)
        if is_list(self.kinds[owner], field.removeprefix("."), value):
            values = value
            if len(value) != len(names):
                self.fail(where, f"'{key}' has {len(value)} values (allowed: {len(names)}, or one for all)")
        return [(name + field, one) for name, one in zip(names, values, strict=True)]
