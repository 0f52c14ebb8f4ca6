"""Heat maps: a panel for each axis and method, a row for each law, coloured by the worst of its runs"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from .head_on import LAWS
from .limits import worst
from .run import METHODS, SceneRun
from .scene import Family
from .scenes import FAMILIES

STYLE = {"font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 10}
REFUSED, NOTHING = "#94a3b8", "#f1f5f9"


class Map:
    """What a figure shows of a run"""

    def __init__(
        self, name: str, caption: str, bounds: tuple[float, float], value: Callable[[SceneRun], float]
    ):
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
        "Internal steps of the solver for each communication step, event and radian of slow swinging in a "
        "hollow body.",
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
