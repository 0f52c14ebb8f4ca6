"""What the runs show together: one line for each value on a family's axis, and the limits of the methods"""

from __future__ import annotations

import csv
import math
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from contact_fmus.pages.table import Table

from .checks import LIMITS
from .run import METHODS, SceneRun
from .scenes import FAMILIES

MEASURES = ("error", "balance", "gain", "momentum", "touch")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")


@dataclass(frozen=True)
class Group:
    """All runs of a method at one value of a family's axis; the figures are the worst of those that ended"""

    family: str
    value: float
    method: str
    runs: int
    right: int
    refused: int
    wrong: int
    error: float
    balance: float
    gain: float
    momentum: float
    touch: float
    steps: int
    most_seconds: float


def worst(values: Iterable[float]) -> float:
    """nan where nothing could be said"""
    return max((value for value in values if not math.isnan(value)), default=math.nan)


def groups(rows: Sequence[SceneRun]) -> list[Group]:
    found: dict[tuple[str, float, str], list[SceneRun]] = defaultdict(list)
    for row in rows:
        found[row.family, row.value, row.method].append(row)
    return [_group(*key, members) for key, members in found.items()]


def _group(family: str, value: float, method: str, rows: list[SceneRun]) -> Group:
    wrong = [row for row in rows if row.wrong]
    refused = [row for row in rows if not row.wrong and row.status != "ok"]
    return Group(
        family=family,
        value=value,
        method=method,
        runs=len(rows),
        right=len(rows) - len(wrong) - len(refused),
        refused=len(refused),
        wrong=len(wrong),
        steps=max(row.steps for row in rows),
        most_seconds=max(row.seconds for row in rows),
        **{name: worst(getattr(row, name) for row in rows) for name in MEASURES},
    )


def write_csv(rows: Sequence[SceneRun] | Sequence[Group], file: Path) -> None:
    """Figures with three digits"""
    names = [field.name for field in fields(rows[0])]
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(names)
        for row in rows:
            writer.writerow(map(_cell, asdict(row).values()))


def _cell(value: object) -> object:
    if isinstance(value, bool):
        return int(value)
    return ("" if math.isnan(value) else f"{value:.3g}") if isinstance(value, float) else value


def counts(rows: Sequence[SceneRun]) -> Table:
    header = [
        "method",
        "scenes",
        "right",
        "refused with a message",
        "wrong",
        "largest error",
        "energy",
        "gain",
    ]
    header += ["momentum", "most internal steps", "longest run"]
    cells = []
    for method in METHODS:
        own = [row for row in rows if row.method == method]
        right = [row for row in own if not row.wrong]
        ended = [row for row in right if row.status == "ok"]
        cells.append(
            [
                method,
                str(len(own)),
                str(len(ended)),
                str(len(right) - len(ended)),
                str(len(own) - len(right)),
                *(f"{worst(getattr(row, name) for row in right):.1e}" for name in MEASURES[:4]),
                str(max(row.steps for row in own)),
                f"{max(row.seconds for row in own):.2f} s",
            ]
        )
    return Table("All runs; figures of those that are not wrong", header, cells)


def span(values: Iterable[float]) -> str:
    ordered = sorted(set(values))
    return f"{ordered[0]:g}" if len(ordered) == 1 else f"{ordered[0]:g} … {ordered[-1]:g}"


def reason(row: SceneRun) -> str:
    """The message without its numbers: a kind of refusal"""
    text = row.message.partition(": ")[2]
    for name in ("solver.max_internal_steps",):
        if name in text:
            return name
    return NUMBER.sub("#", text)[:120] or row.status


def refusals(rows: Sequence[SceneRun]) -> Table:
    """Where a method refuses, and for what reason"""
    found: dict[tuple[str, str, str], list[SceneRun]] = defaultdict(list)
    runs = Counter((row.method, row.family) for row in rows)
    for row in rows:
        if row.status != "ok" and not row.wrong:
            found[row.method, row.family, reason(row)].append(row)
    cells = [
        [
            method,
            family,
            span(row.value for row in own),
            laws(own),
            kind,
            f"{len(own)} of {runs[method, family]}",
        ]
        for (method, family, kind), own in sorted(found.items(), key=lambda item: METHODS.index(item[0][0]))
    ]
    return Table("Refused, by the message", ["method", "axis", "values", "laws", "reason", "runs"], cells, 5)


def mistakes(rows: Sequence[SceneRun]) -> Table:
    found: dict[tuple[str, str, str], list[SceneRun]] = defaultdict(list)
    for row in rows:
        if row.wrong:
            found[row.method, row.family, row.wrong].append(row)
    cells = [
        [method, family, span(row.value for row in own), laws(own), failed, _worst_name(own), str(len(own))]
        for (method, family, failed), own in sorted(found.items(), key=lambda item: METHODS.index(item[0][0]))
    ]
    header = ["method", "axis", "values", "laws", "failed", "the worst", "runs"]
    return Table("Wrong", header, cells, 6)


def _worst_name(rows: Sequence[SceneRun]) -> str:
    row = max(rows, key=lambda one: 0.0 if math.isnan(one.error) else one.error)
    parts = (row.geometry, row.law, f"{row.value:g}", row.note)
    return ", ".join(part for part in parts if part) + f" ({row.error:.0e})"


def laws(rows: Sequence[SceneRun]) -> str:
    found = sorted({row.law for row in rows})
    return "all" if len(found) == 5 else ", ".join(found)


def axes(rows: Sequence[SceneRun]) -> Table:
    """The range of each axis in which a method is right with all its scenes"""
    cells = []
    for family in FAMILIES:
        own = [group for group in groups(rows) if group.family == family.name]
        if own:
            reached = [_reached([one for one in own if one.method == method]) for method in METHODS]
            cells.append([family.axis, span(one.value for one in own), *reached])
    return Table("Values at which all scenes of an axis are right", ["axis", "declared", *METHODS], cells, 5)


def _reached(own: Sequence[Group]) -> str:
    """Runs of neighbouring values"""
    runs: list[list[float]] = []
    broken = True
    for one in sorted(own, key=lambda group: group.value):
        if one.right != one.runs:
            broken = True
        else:
            runs = [*runs, []] if broken else runs
            runs[-1].append(one.value)
            broken = False
    if sum(map(len, runs)) == len(own):
        return "all"
    return ", ".join(span(values) for values in runs) or "none"


def same_bits(rows: Sequence[SceneRun]) -> Table:
    """How many oblique scenes end with the same bits in other units"""
    original = {
        (row.note, row.method, row.communication_steps): row.bits
        for row in rows
        if row.family.startswith("unit of") and row.value == 0
    }
    cells = []
    for family in (one.name for one in FAMILIES if one.name.startswith("unit of")):
        counted = []
        for method in METHODS:
            own = [row for row in rows if row.family == family and row.method == method and row.bits]
            other = [row for row in own if row.value != 0]
            same = sum(row.bits == original.get((row.note, method, row.communication_steps)) for row in other)
            counted.append(f"{same} of {len(other)}")
        cells.append([family, *counted])
    return Table("The same bits in other units", ["units", *METHODS], cells, 1)


def allowed() -> Table:
    cells = [[method, *(f"{LIMITS[method][name]:.0e}" for name in MEASURES)] for method in METHODS]
    return Table("What counts as right: no figure above", ["method", *MEASURES], cells, 1)
