"""Reading a scene file. What it says about single variables is checked in resolve.py."""

import math
import re
from dataclasses import dataclass, field, replace
from pathlib import Path

from . import advice
from .catalogue import Catalogue, Row
from .errors import InputError, allowed
from .names import refused_name
from .quantity import in_unit
from .repeat import MOST, Entry, Repeats
from .variables_file import read_toml

SHAPES = ("sphere", "cylinder", "plane", "torus", "compound")
# The keys of each table and what they mean: docs/scenes.md shows these words.
SCENE_KEYS = {
    "name": "of the FMU: letters, digits and `_`, the first a letter; no name of a shipped scene or of a "
    "CMake target such as `test` or `all`. Required",
    "title": "one line for the FMU's description. Required",
    "description": "some sentences for its documentation. Required",
    "body": f"`[[body]]`, a table for each body or for several alike, 1 to {MOST:,} bodies. Required",
    "contact": "`[[contact]]`, a table for each pair of bodies that may touch, or for several alike, "
    f"1 to {MOST:,} pairs. Required",
    "groups": "table of groups of bodies, by default none: a name and a list of names",
    "start": "table of start values, by default none: those listed below",
    "pinned": "table of constants, by default none: every choice stays open. A list of two or more items "
    "leaves a choice these alone",
    "leave_out": "table with `outputs`, the outputs to leave out, by default none",
    "experiment": "table of what a tool proposes as a run",
    "choices": '`"enumeration"`, the default, or `"integer"`, for importers that know no enumerations: a '
    "choice is then an Integer whose description names the items",
}
BODY_KEYS = {
    "name": "small letters, digits and `_`, and perhaps an index as in `ball[3]`; variables begin with it: "
    "`marble.radius`. Required",
    "shape": "`sphere`, `cylinder`, `plane`, `torus` or `compound`, a rigid body of several spheres. "
    "Required",
    "part": "`[[body.part]]`, a table for each sphere of a compound, which contacts name as in `foot.heel`",
    "count": f"how many such bodies there are, 1 to {MOST:,}; their `name` has a `{{i}}`, the number of each",
}
PART_KEYS = {
    "name": "as of a body, without an index. Required",
    "radius": "of the sphere, m, more than 0: a constant of the FMU. Required",
    "center": "of the sphere from the compound's centre of mass, in the frame of its principal axes, m: a "
    "list of three constants of the FMU. Required",
}
CONTACT_KEYS = {
    "name": "as of a body, and not that of a body: `touch.normal_force`. Required",
    "source": "name of the body that touches: a sphere, a part of a compound as in `foot.heel`, or a "
    "cylinder on a cylinder. Required",
    "destination": "name of the body that is touched, of any shape; of a compound a part. Required",
    "count": f"how many such contacts there are, 1 to {MOST:,}; the names have a `{{i}}` or `{{i+1}}`",
}
EXPERIMENT_KEYS = {
    "start_time": "s",
    "stop_time": "s, more than `start_time`",
    "step_size": "communication step, s, more than 0",
    "tolerance": "relative tolerance of the solver, more than 0",
}
EXPERIMENT = {"start_time": 0.0, "stop_time": 1.0, "step_size": 1e-3, "tolerance": 1e-8}
IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*(\[[1-9][0-9]*(,[1-9][0-9]*)?\])?")
IN_WORDS = {
    IDENTIFIER: "letters, digits and _, a letter first, such as BouncingBall",
    NAME: "small letters and digits, a letter first, words joined by _, such as left_ball or ball[3]",
}
CHOICES = ("enumeration", "integer")
VALUES = ("start", "pinned")


@dataclass(frozen=True)
class Part:
    """A sphere of a compound body."""

    name: str
    radius: float
    center: tuple[float, float, float]  # in the body's frame


@dataclass(frozen=True)
class Body:
    name: str
    shape: str
    number: int  # of its value references
    keeps_axis: bool = False  # a cylinder that touches a cylinder: it turns about its own axis only
    parts: tuple[Part, ...] = ()

    def has(self, row: Row) -> bool:
        """Whether a body of this kind, or a contact with it, has the row."""
        kinds = not row.shape or self.shape in row.shape
        return kinds and not (row.tilts if self.keeps_axis else row.kept)


@dataclass(frozen=True)
class Contact:
    name: str
    source: int
    destination: int
    number: int  # of its value references
    source_part: Part | None = None  # of a compound
    destination_part: Part | None = None


@dataclass(frozen=True)
class Scene:
    file: str
    name: str
    title: str
    description: str
    bodies: tuple[Body, ...]
    contacts: tuple[Contact, ...]
    start: dict = field(default_factory=dict)
    pinned: dict = field(default_factory=dict)
    leave_out: tuple[str, ...] = ()
    experiment: dict = field(default_factory=dict)
    choices: str = CHOICES[0]

    def error(self, text: str) -> InputError:
        return InputError(self.file, text)

    def is_destination_only(self, body: int) -> bool:
        return any(c.destination == body for c in self.contacts) and all(
            c.source != body for c in self.contacts
        )


class _Reader:
    """Checks keys and types of the tables of one file."""

    def __init__(self, file: str, catalogue: Catalogue):
        self.file = file
        self.catalogue = catalogue

    def fail(self, where: str, text: str):
        raise InputError(self.file, f"{where}: {text}" if where else text)

    def keys(self, where: str, table: dict, known: dict, required=(), owner: str = "") -> None:
        """owner: whose variables may stand here by mistake, as in advice.misplaced."""
        for key in table:
            if key not in known:
                remedy = advice.misplaced(self.catalogue, owner, key, table, EXPERIMENT) if owner else ""
                remedy = f": {remedy}" if remedy else advice.likely(key, known)
                self.fail(where, f"unknown key '{key}'{remedy} {allowed(known)}")
        for key in required:
            if key not in table:
                self.fail(where, f"key '{key}' is missing {allowed(known)}")

    def text(self, where: str, table: dict, key: str, pattern: re.Pattern | None = None) -> str:
        value = table[key]
        if not isinstance(value, str) or not value.strip():
            self.fail(where, f"'{key}' must be a text that is not empty, got {value!r}")
        if pattern and not pattern.fullmatch(value):
            self.fail(where, f"'{key}' is {value!r}, not a name (allowed: {IN_WORDS[pattern]})")
        return " ".join(value.split())

    def table(self, data: dict, key: str) -> dict:
        value = data.get(key, {})
        if not isinstance(value, dict):
            self.fail("", f"'{key}' must be a table (allowed: [{key}])")
        return value

    def values(self, data: dict, key: str) -> dict:
        """A table of names in quotes and their values."""
        table = self.table(data, key)
        remedy = advice.unquoted(table)
        if remedy:
            self.fail(f"[{key}]", f"{remedy} (allowed: names in quotes)")
        return table

    def tables(self, data: dict, key: str) -> list[dict]:
        value = data[key]
        if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value) or not value:
            self.fail("", f"'{key}' must be a list of one or more tables (allowed: [[{key}]])")
        return value

    def new_name(self, where: str, name: str, taken: dict[str, str]) -> None:
        if name in taken:
            self.fail(where, f"name '{name}' is already that of {taken[name]} (allowed: any other name)")
        taken[name] = where


def read_scene(path: Path, catalogue: Catalogue) -> Scene:
    file = str(path)  # as it was given
    data = read_toml(path, file)
    reader = _Reader(file, catalogue)
    reader.keys("", data, SCENE_KEYS, ("name", "title", "description", "body", "contact"), "world")
    name = reader.text("", data, "name", IDENTIFIER)
    reason = refused_name(name, path)
    if reason:
        reader.fail("", f"'name' is '{name}', {reason} (allowed: any other name)")
    # Bodies and contacts are not named like a group of the world's variables.
    groups = {row.key.partition(".")[0] for row in catalogue.rows.values() if row.owner == "world"}
    taken = dict.fromkeys(groups, "a group of variables")
    repeats = _repeats(reader, data)
    bodies = _bodies(reader, repeats.bodies, taken)
    contacts = _contacts(reader, repeats.contacts, bodies, taken)
    return Scene(
        file,
        name,
        reader.text("", data, "title"),
        reader.text("", data, "description"),
        _with_kept_axes(reader, bodies, contacts),
        contacts,
        *(repeats.values(f"[{key}]", reader.values(data, key), _by_copy(catalogue, key)) for key in VALUES),
        _leave_out(reader, data, repeats),
        _experiment(reader, data),
        _choices(reader, data),
    )


def _repeats(reader: _Reader, data: dict) -> Repeats:
    return Repeats(
        reader.fail, reader.tables(data, "body"), reader.tables(data, "contact"), reader.table(data, "groups")
    )


def _by_copy(catalogue: Catalogue, key: str):
    """Whether a value is a list with one item for each body or contact that is repeated."""

    def is_list(owner: str, field: str, value) -> bool:
        row = catalogue.rows.get(f"{owner}.{field}")
        if row is None or not isinstance(value, list):
            return False
        if key == "pinned" and row.type.items:
            return False  # the items that a choice keeps
        return row.dim == 1 or any(isinstance(one, list) for one in value)

    return is_list


def _bodies(reader: _Reader, entries: list[Entry], taken: dict) -> tuple[Body, ...]:
    bodies = []
    for entry in entries:
        where, table = entry.where, entry.table
        reader.keys(where, table, BODY_KEYS, ("name", "shape"), "body")
        reader.new_name(where, reader.text(where, table, "name", NAME), taken)
        if table["shape"] not in SHAPES:
            reader.fail(where, f"unknown shape {table['shape']!r} {allowed(SHAPES)}")
        if (table["shape"] == "compound") != ("part" in table):
            reader.fail(where, "[[body.part]] and shape 'compound' go together (allowed: both, or neither)")
        parts = _parts(reader, where, table) if "part" in table else ()
        bodies.append(Body(table["name"], table["shape"], entry.number, parts=parts))
    return tuple(bodies)


def _parts(reader: _Reader, where: str, body: dict) -> tuple[Part, ...]:
    parts, taken = [], {}
    for k, table in enumerate(reader.tables(body, "part"), 1):
        here = f"{where} [[body.part]] {k}"
        reader.keys(here, table, PART_KEYS, PART_KEYS)
        reader.new_name(here, reader.text(here, table, "name", NAME), taken)
        radius, center = (
            _lengths(reader, here, table, "radius", 1),
            _lengths(reader, here, table, "center", 3),
        )
        if not 1e-150 <= radius[0] <= 1e150:
            reader.fail(here, f"'radius' is {table['radius']!r} (allowed: from 1e-150 to 1e150 m)")
        parts.append(Part(table["name"], *radius, center))
    return tuple(parts)


def _lengths(reader: _Reader, where: str, table: dict, key: str, count: int) -> tuple[float, ...]:
    given = table[key] if isinstance(table[key], list) else [table[key]]
    try:
        values = [in_unit(one, "m") if isinstance(one, str) else one for one in given]
    except ValueError as error:
        reader.fail(where, f"'{key}' is {table[key]!r}, {error} (allowed: lengths in m)")
    if len(values) != count or any(type(one) not in (int, float) or not abs(one) <= 1e150 for one in values):
        form = "a length" if count == 1 else f"a list of {count} lengths"
        reader.fail(where, f"'{key}' is {table[key]!r} (allowed: {form} in m from -1e150 to 1e150)")
    return tuple(map(float, values))


def _contacts(
    reader: _Reader, entries: list[Entry], bodies: tuple[Body, ...], taken: dict
) -> tuple[Contact, ...]:
    spheres = {f"{body.name}.{part.name}": (i, part) for i, body in enumerate(bodies) for part in body.parts}
    index = {body.name: (i, None) for i, body in enumerate(bodies) if not body.parts} | spheres
    contacts, pairs = [], {}
    for entry in entries:
        where, table = entry.where, entry.table
        reader.keys(where, table, CONTACT_KEYS, ("name", "source", "destination"), "contact")
        reader.new_name(where, reader.text(where, table, "name", NAME), taken)
        for key in ("source", "destination"):
            if reader.text(where, table, key) not in index:
                reader.fail(where, f"{key} '{table[key]}' is no body {allowed(list(index))}")
        (source, part), (destination, other) = index[table["source"]], index[table["destination"]]
        if source == destination:
            others = [name for name, (body, _) in index.items() if body != source]
            reader.fail(where, f"destination '{table['destination']}' is the source itself {allowed(others)}")
        fits = ("sphere", "cylinder") if bodies[destination].shape == "cylinder" else ("sphere",)
        if bodies[source].shape not in fits and not part:
            fitting = [
                name for name, (body, of) in index.items()
                if body != destination and (of or bodies[body].shape in fits)
            ]  # fmt: skip
            reader.fail(
                where, f"source '{table['source']}' must be a {' or a '.join(fits)} {allowed(fitting)}"
            )
        pair = frozenset((table["source"], table["destination"]))
        if pair in pairs:
            ends = f"destination '{table['destination']}' and source '{table['source']}'"
            reader.fail(where, f"{ends} are already those of {pairs[pair]} (allowed: each pair once)")
        pairs[pair] = where
        contacts.append(Contact(table["name"], source, destination, entry.number, part, other))
    return tuple(contacts)


def _with_kept_axes(
    reader: _Reader, bodies: tuple[Body, ...], contacts: tuple[Contact, ...]
) -> tuple[Body, ...]:
    """The bodies, of which cylinders that touch cylinders keep the direction of their axes."""
    rollers = [one for one in contacts if bodies[one.source].shape == "cylinder"]
    kept = {body for one in rollers for body in (one.source, one.destination)}
    for one in contacts:
        if one not in rollers and one.destination in kept:
            name, ball = bodies[one.destination].name, bodies[one.source].name
            reader.fail(
                f"[[contact]] {one.name}",
                f"destination '{name}' touches a cylinder and cannot be tilted by '{ball}' "
                "(allowed: cylinders on a cylinder that touches cylinders)",
            )
    return tuple(replace(body, keeps_axis=i in kept) for i, body in enumerate(bodies))


def _leave_out(reader: _Reader, data: dict, repeats: Repeats) -> tuple[str, ...]:
    table = reader.table(data, "leave_out")
    reader.keys("[leave_out]", table, {"outputs": "names of outputs"})
    outputs = table.get("outputs", [])
    if not isinstance(outputs, list) or not all(isinstance(name, str) for name in outputs):
        reader.fail("[leave_out]", f"'outputs' must be a list of names, got {outputs!r}")
    return tuple(repeats.values("[leave_out]", dict.fromkeys(outputs), lambda *_: False))


def _choices(reader: _Reader, data: dict) -> str:
    value = data.get("choices", CHOICES[0])
    if value not in CHOICES:
        reader.fail("", f"'choices' is {value!r} {allowed(CHOICES)}")
    return value


def _with_unit(reader: _Reader, where: str, key: str, value):
    if not isinstance(value, str):
        return value
    try:
        return in_unit(value, "1" if key == "tolerance" else "s")
    except ValueError as error:
        return reader.fail(where, f"'{key}' must be a finite number, got {value!r}, {error}")


def _experiment(reader: _Reader, data: dict) -> dict:
    table = reader.table(data, "experiment")
    where = "[experiment]"
    reader.keys(where, table, EXPERIMENT)
    table = {key: _with_unit(reader, where, key, value) for key, value in table.items()}
    for key, value in table.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            reader.fail(where, f"'{key}' must be a finite number, got {value!r}")
    values = {key: float(table.get(key, default)) for key, default in EXPERIMENT.items()}
    if values["stop_time"] <= values["start_time"]:
        reader.fail(
            where, f"'stop_time' is {values['stop_time']!r} (allowed: more than {values['start_time']!r})"
        )
    for key in ("step_size", "tolerance"):
        if values[key] <= 0.0:
            reader.fail(where, f"'{key}' is {values[key]!r} (allowed: more than 0)")
    return values
