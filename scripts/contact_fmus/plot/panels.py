"""When bodies touched, and which variables of a result are drawn together"""

import fnmatch
import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from contact_fmus.errors import UserError, similar
from contact_fmus.results import Result

# When bodies touched, from a result.
#
# An FMU with free bodies tells each contact's last onset and how long it has lasted, exactly. Where both
# motions are given there are no such outputs: there the sign of the gap tells, as exactly as the result is
# dense.


@dataclass(frozen=True)
class Touch:
    """One stay in contact"""

    contact: str
    begin: float  # s
    end: float  # s; of one under way, the end of the result

    @property
    def duration(self) -> float:
        return self.end - self.begin


def contact_names(result: Result) -> list[str]:
    return [name.removesuffix(".gap") for name in result.columns if name.endswith(".gap")]


def touches(result: Result) -> list[Touch]:
    """The touches in the order of their onsets"""
    found: list[Touch] = []
    for name in contact_names(result):
        reported = f"{name}.last_onset_time" in result.columns and f"{name}.onsets" in result.columns
        found += _reported(result, name) if reported else _from_gap(result, name)
    return sorted(found, key=lambda touch: (touch.begin, touch.contact))


def together(found: list[Touch]) -> list[tuple[float, float]]:
    """The times in which at least one of the touches, in the order of their onsets, lasts"""
    spans: list[tuple[float, float]] = []
    for touch in found:
        if not spans or touch.begin > spans[-1][1]:
            spans.append((touch.begin, touch.end))
        spans[-1] = (spans[-1][0], max(spans[-1][1], touch.end))
    return spans


def _reported(result: Result, name: str) -> list[Touch]:
    """The last duration that is told for an onset is that of the whole contact."""
    count = np.asarray(result.columns[f"{name}.onsets"])
    onset, lasted = result.columns[f"{name}.last_onset_time"], result.columns[f"{name}.last_duration"]
    last = np.flatnonzero(np.append(np.diff(count) != 0, True) & (count > 0))
    return [Touch(name, float(onset[row]), float(onset[row] + lasted[row])) for row in last]


def _from_gap(result: Result, name: str) -> list[Touch]:
    time, gap = result.time, np.asarray(result.columns[f"{name}.gap"], dtype=float)
    touching = gap < 0.0
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    # Straight lines between the rows.
    share = np.clip(gap[edges] / (gap[edges] - gap[edges + 1]), 0.0, 1.0)
    times = time[edges] + share * (time[edges + 1] - time[edges])
    if len(touching) and touching[0]:
        times = np.insert(times, 0, time[0])
    if len(touching) and touching[-1]:
        times = np.append(times, time[-1])
    return [Touch(name, float(a), float(b)) for a, b in times.reshape(-1, 2)]


# Which variables of a result are drawn together: one panel for each kind of quantity

FAR = 1e20  # a gap beyond this stands for infinity and is not drawn
MOST = 8  # lines of one panel, panels of a result that nobody chose from
AXES = dict(zip("123", "xyz", strict=True))
# Each energy has its colour, whichever others are drawn.
ENERGIES = ("kinetic", "potential", "contact", "dissipated", "rotational", "friction", "tangential")
ENERGIES += ("external_work",)
# Penetrations are drawn next to flights: where they are less than this part of the axis, it is linear below
# them and logarithmic above.
SMALL = 0.05


@dataclass(frozen=True)
class Line:
    name: str  # the variable; |name| is the length of a vector
    label: str
    color: int | None = None  # None: by its place among the lines
    sum: bool = False  # drawn dashed, in the colour of text


@dataclass(frozen=True)
class Panel:
    title: str
    unit: str
    lines: tuple[Line, ...]


def chosen(result: Result, patterns: Iterable[str]) -> list[Panel]:
    """A panel for each unit and name among the variables asked for; `*` stands for anything, a vector for its
    components"""
    names: list[str] = []
    for pattern in patterns:
        # fnmatch reads [1] as a set of letters: a bracket is meant as it stands here.
        wanted = re.compile(fnmatch.translate(pattern.replace("[", "[[]")))
        found = [name for name in result.columns if wanted.match(name) or wanted.match(_whole(name))]
        if not found:
            askable = dict.fromkeys([*map(_whole, result.columns), *result.columns])
            raise UserError(f"--variables: no variable '{pattern}'{similar(pattern, askable)}")
        names += [name for name in found if name not in names]
    groups: dict[tuple[str, str], list[str]] = {}
    for name in names:
        groups.setdefault((_kind(name), result.units.get(name, "")), []).append(name)
    return [_panel(kind, unit, found) for (kind, unit), found in groups.items()]


def usual(result: Result) -> list[Panel]:
    """Gaps, forces, positions and energies, what turns and rubs; of a result without contacts, all by unit"""
    contacts = contact_names(result)
    if not contacts:
        numbers = [name for name, column in result.columns.items() if column.dtype.kind != "U"]
        return chosen(result, sorted(numbers))[:MOST]
    if len(contacts) > MOST:  # the contacts that came nearest
        least = sorted(contacts, key=lambda one: float(np.min(result.columns[f"{one}.gap"])))[:MOST]
        contacts = [one for one in contacts if one in least]
    rubbing = [one for one in contacts if _largest(result, f"{one}.friction_force") > 0.0]
    panels = [
        _of_contacts(result, contacts, "gap", "gap"),
        _of_contacts(result, contacts, "normal_force", "normal force"),
        *_vectors(result, [f"{one}.friction_force" for one in rubbing], "friction force"),
        *_vectors(result, [f"{one}.slip_velocity" for one in rubbing], "slip velocity"),
        *_positions(result),
        *_turning(result),
        _energies(result),
    ]
    return [panel for panel in panels if panel is not None]


def values(result: Result, name: str) -> np.ndarray:
    """The values as they are drawn, without those that stand for infinity"""
    found = np.linalg.norm(result.vector(name[1:-1]), axis=1) if name.startswith("|") else result.column(name)
    if found.dtype.kind == "U":
        raise UserError(f"column {name} holds text, such as '{found[0]}', which cannot be drawn")
    found = found.astype(float)
    return np.where(np.abs(found) < FAR, found, np.nan)


def threshold(drawn: Iterable[np.ndarray]) -> float | None:
    """Up to where an axis is linear, in the unit of the values; None: all of it"""
    joined = np.concatenate(list(drawn))
    joined = joined[np.isfinite(joined)]
    if len(joined) == 0:
        return None
    deepest, widest = float(-np.min(joined)), float(np.max(joined))
    return float(10.0 ** np.ceil(np.log10(deepest))) if 0.0 < deepest < SMALL * widest else None


def _whole(name: str) -> str:
    """The vector that a scalar belongs to"""
    return re.sub(r"\[\d+\]$", "", name)


def _kind(name: str) -> str:
    """contact.gap: gap; source.position[1]: position; energy.kinetic: energy"""
    group, _, field = _whole(name).partition(".")
    return group if group == "energy" or not field else field


def _component(name: str) -> str:
    """source.position[3]: source z"""
    found = re.fullmatch(r"([\w\[\],]+)\.\w+\[([123])\]", name)
    return f"{found[1]} {AXES[found[2]]}" if found else name.rpartition(".")[0] or name


def _panel(kind: str, unit: str, names: list[str]) -> Panel:
    words = [name.partition(".")[2] if kind == "energy" else _component(name) for name in names]
    alone = len(set(words)) < len(words)  # labels that would not tell lines apart
    lines = [Line(name, name if alone else word) for name, word in zip(names, words, strict=True)]
    return Panel(kind.replace("_", " "), unit, tuple(lines))


def _of_contacts(result: Result, contacts: list[str], field: str, title: str) -> Panel | None:
    names = [name for contact in contacts if (name := f"{contact}.{field}") in result.columns]
    if not names:
        return None
    return Panel(title, result.units.get(names[0], ""), tuple(Line(name, name[: -len(field) - 1]) for name in names))


def _positions(result: Result) -> list[Panel]:
    """Positions of bodies that move: all components of a single body, the liveliest component of several"""
    columns = [name for name in result.columns if re.search(r"\.position\[[123]\]$", name)]
    ranges = {name: float(np.ptp(result.columns[name])) for name in columns}
    bodies = list(dict.fromkeys(name.partition(".")[0] for name in columns))
    moving = [body for body in bodies if any(ranges[f"{body}.position[{i}]"] > 0.0 for i in (1, 2, 3))]
    if not moving:
        return []
    if len(moving) == 1:
        return _components(result, f"{moving[0]}.position")
    unit = result.units.get(f"{moving[0]}.position[1]", "")
    total = {i: sum(ranges[f"{body}.position[{i}]"] for body in moving) for i in AXES}
    component = max(total, key=lambda i: total[i])
    lines = [Line(f"{body}.position[{component}]", body) for body in moving[:MOST]]
    return [Panel(f"position, {AXES[component]}", unit, tuple(lines))]


def _vectors(result: Result, names: list[str], title: str) -> list[Panel]:
    """The sizes of vectors, whose directions turn, of contacts or bodies"""
    found = [name for name in names if f"{name}[1]" in result.columns][:MOST]
    lines = tuple(Line(f"|{name}|", name.partition(".")[0]) for name in found)
    return [Panel(f"{title}, size", result.units.get(f"{found[0]}[1]", ""), lines)] if found else []


def _turning(result: Result) -> list[Panel]:
    """Angular velocity of bodies that turn: all components of a single one, the sizes of several"""
    found = [name[:-3] for name in result.columns if name.endswith(".angular_velocity[1]")]
    turning = [name for name in found if _largest(result, name) > 0.0]
    return _components(result, turning[0]) if len(turning) == 1 else _vectors(result, turning, "angular velocity")


def _components(result: Result, vector: str) -> list[Panel]:
    """All components of one vector"""
    body, _, field = vector.partition(".")
    lines = tuple(Line(f"{vector}[{i}]", axis) for i, axis in AXES.items())
    return [Panel(f"{field.replace('_', ' ')} of {body}", result.units.get(f"{vector}[1]", ""), lines)]


def _largest(result: Result, vector: str) -> float:
    """The largest component at any time; 0 where there is no such vector"""
    columns = [result.columns[name] for i in AXES if (name := f"{vector}[{i}]") in result.columns]
    return max((float(np.max(np.abs(column), initial=0.0)) for column in columns), default=0.0)


def _energies(result: Result) -> Panel | None:
    known = [name for name in (*ENERGIES, "total") if f"energy.{name}" in result.columns]
    # Work that is not done and energy that is not lost, but for rounding, are no lines worth a colour.
    largest = {name: float(np.max(np.abs(result.columns[f"energy.{name}"]), initial=0.0)) for name in known}
    seen = 1e-14 * max(largest.values(), default=0.0)
    words = {"contact": "stored in contact", "external_work": "work done"}
    colors = {name: index for index, name in enumerate(ENERGIES)}
    lines = [
        Line(f"energy.{name}", words.get(name, name), colors.get(name), sum=name == "total")
        for name in known
        if largest[name] > seen
    ]
    return Panel("energy", result.units.get("energy.kinetic", "J"), tuple(lines)) if lines else None
