"""The atlas's page: index.html, which holds its figures, and README.md next to them"""

from __future__ import annotations

import csv
import datetime
import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from contact_fmus.pages import Table, read_words, versions, write_pages

from .motions import LAWS
from .run import LIMITS, METHODS, MOST_STEPS, TOLERANCE, SceneRun
from .scenes import FAMILIES, Family

# The runs together: one line for each value on a family's axis, and the limits of the methods

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
    header = ["method", "scenes", "right", "refused with a message", "wrong", "largest error", "energy", "gain"]
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
        [method, family, span(row.value for row in own), laws(own), kind, f"{len(own)} of {runs[method, family]}"]
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


# Heat maps: a panel for each axis and method, a row for each law, coloured by the worst of its runs

WORDS = read_words(__file__)
STYLE = {"font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 10}
REFUSED, NOTHING = "#94a3b8", "#f1f5f9"


class Map:
    """What a figure shows of a run"""

    def __init__(self, name: str, caption: str, bounds: tuple[float, float], value: Callable[[SceneRun], float]):
        self.name, self.caption, self.bounds, self.value = name, caption, bounds, value


MAPS = (
    Map(
        "error",
        "Error of the place at the end over the length of the motion, the worst of all geometries and "
        "numbers of communication steps.",
        (1e-17, 1.0),
        lambda row: row.error,
    ),
    Map(
        "energy",
        "How far the energy balance strays, over the largest energy in play.",
        (1e-17, 1.0),
        lambda row: row.balance,
    ),
    Map(
        "steps",
        "Internal steps of the solver for each communication step, event and radian of slow swinging in a hollow body.",
        (1.0, 1e4),
        lambda row: row.work,
    ),
)
LEGEND = (
    "A panel for each axis and method, a row for each law, the number on the axis to the right; colour: the "
    "worst of the runs there, as the bar at the bottom says. Grey: every run refused, with a message; a dot: "
    "some refused; a red cross: a wrong result."
)


def draw(rows: Sequence[SceneRun], folder: Path) -> list[dict[str, str]]:
    """Name and caption of each figure; the files are name.png"""
    for one in MAPS:
        with mpl.rc_context(STYLE):
            _figure(one, rows).savefig(folder / f"{one.name}.png", dpi=90, metadata={"Software": None})
    return [{"name": one.name, "caption": f"{one.caption} {_scale(one)} {LEGEND}"} for one in MAPS]


def _scale(shown: Map) -> str:
    low, high = (short(bound) for bound in shown.bounds)
    return f"Dark blue is {low} or less, yellow {high} or more."


def short(value: float) -> str:
    """1e-9 rather than 1e-09, 1e5 rather than 100000"""
    text = f"{value:.6g}" if 1e-3 < abs(value) < 1e4 or value == 0 else f"{value:.1e}".replace(".0e", "e")
    return re.sub(r"e([-+])0*", lambda match: "e" + match[1].replace("+", ""), text)


def _figure(shown: Map, rows: Sequence[SceneRun]) -> Figure:
    families = [family for family in FAMILIES if any(row.family == family.name for row in rows)]
    height = 1.28 * len(families) + 1.4  # inches, of which 0.5 at the top and 0.9 at the bottom
    figure = Figure(figsize=(12.5, height))
    panels = figure.subplots(len(families), len(METHODS), squeeze=False)
    figure.subplots_adjust(0.075, 0.9 / height, 0.985, 1 - 0.5 / height, 0.05, 0.75)
    for line, family in zip(panels, families, strict=True):
        own = [row for row in rows if row.family == family.name]
        for panel, method in zip(line, METHODS, strict=True):
            image = _panel(panel, shown, family, [row for row in own if row.method == method])
            if panel is not line[0]:
                panel.set_yticklabels([])
    for panel, method in zip(panels[0], METHODS, strict=True):
        panel.set_title(f"{method}\n{panel.get_title()}")
    bar = figure.add_axes((0.25, 0.35 / height, 0.5, 0.12 / height))
    figure.colorbar(image, cax=bar, orientation="horizontal")
    return figure


def _panel(panel: Axes, shown: Map, family: Family, rows: Sequence[SceneRun]) -> mpl.image.AxesImage:
    values = sorted({row.value for row in rows})
    cells: dict[tuple[int, int], list[SceneRun]] = {}
    for row in rows:
        cells.setdefault((LAWS.index(row.law), values.index(row.value)), []).append(row)
    image, refused = np.full((len(LAWS), len(values)), math.nan), []
    for place, members in cells.items():
        ended = [row for row in members if row.status == "ok" or row.wrong]
        image[place] = max(worst(map(shown.value, ended)), shown.bounds[0]) if ended else math.nan
        if not ended:
            refused.append(place)
        mark = "x" if any(row.wrong for row in members) else "." if len(ended) < len(members) else ""
        if mark and ended:
            color = "#dc2626" if mark == "x" else "#64748b"
            panel.plot(place[1], place[0], mark, color=color, markersize=5 if mark == "x" else 3)
    panel.set_facecolor(NOTHING)
    for line, column in refused:
        panel.add_patch(mpl.patches.Rectangle((column - 0.5, line - 0.5), 1, 1, color=REFUSED, lw=0))
    drawn = panel.imshow(image, cmap="viridis", norm=LogNorm(*shown.bounds), aspect="auto")
    panel.set_yticks(range(len(LAWS)), [law.replace("_", " ") for law in LAWS])
    stride = max(1, math.ceil(len(values) / 9))
    ticks = range(0, len(values), stride)
    panel.set_xticks(ticks, [short(values[k]) for k in ticks])
    said = family.axis if family.axis.startswith(family.name) else f"{family.name}: {family.axis}"
    panel.set_title(said, fontsize=8, loc="left")
    panel.tick_params(length=2)
    return drawn


def draw_page(rows: Sequence[SceneRun], folder: Path, plan: str) -> list[Path]:
    """Figures, index.html and README.md"""
    drawn = draw(rows, folder)
    context = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": plan,
        "scenes": len(rows) // len(METHODS),
        "tolerance": f"{TOLERANCE:g}",
        "most_steps": MOST_STEPS,
        "families": [family for family in FAMILIES if any(row.family == family.name for row in rows)],
        "figures": drawn,
        "legend": LEGEND,
        "counts": counts(rows),
        "limits": [axes(rows), refusals(rows)],
        "mistakes": mistakes(rows),
        "checks": [allowed(), same_bits(rows)],
        "versions": versions(),
        "texts": WORDS,
    }
    return write_pages(Path(__file__).parent, folder, context)
