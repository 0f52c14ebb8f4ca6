"""Heat maps: a panel for each axis and method, a row for each law, coloured by the worst of its runs"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from .head_on import LAWS
from .limits import worst
from .run import METHODS, Row
from .scenes import FAMILIES, Family

STYLE = {"font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 10}
REFUSED, NOTHING = "#94a3b8", "#f1f5f9"


class Map:
    """What a figure shows of a run"""

    def __init__(self, name: str, caption: str, bounds: tuple[float, float], value: Callable[[Row], float]):
        self.name, self.caption, self.bounds, self.value = name, caption, bounds, value


MAPS = (
    Map(
        "error",
        "Error of the place at the end over the length of the motion, the worst of all geometries and numbers of "
        "communication steps.",
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
        "Internal steps of the solver for each communication step, contact event and second of running on.",
        (1.0, 1e4),
        lambda row: row.steps / (row.communication_steps + row.events),
    ),
)
LEGEND = "Grey: every run refused, with a message; a dot: some refused; a cross: a wrong result."


def draw(rows: Sequence[Row], folder: Path) -> list[dict[str, str]]:
    """Name and caption of each figure; the files are name.png"""
    for one in MAPS:
        with mpl.rc_context(STYLE):
            _figure(one, rows).savefig(folder / f"{one.name}.png", dpi=110, metadata={"Software": None})
    return [{"name": one.name, "caption": f"{one.caption} {LEGEND}"} for one in MAPS]


def _figure(shown: Map, rows: Sequence[Row]) -> Figure:
    families = [family for family in FAMILIES if any(row.family == family.name for row in rows)]
    figure = Figure(figsize=(12.5, 1.28 * len(families) + 0.8), layout="constrained")
    panels = figure.subplots(len(families), len(METHODS), squeeze=False)
    for line, family in zip(panels, families, strict=True):
        own = [row for row in rows if row.family == family.name]
        for panel, method in zip(line, METHODS, strict=True):
            image = _panel(panel, shown, family, [row for row in own if row.method == method])
            if panel is not line[0]:
                panel.set_yticklabels([])
    for panel, method in zip(panels[0], METHODS, strict=True):
        panel.set_title(f"{method}\n{panel.get_title()}")
    figure.colorbar(image, ax=panels, location="bottom", shrink=0.5, aspect=60, pad=0.005)
    return figure


def _panel(panel: Axes, shown: Map, family: Family, rows: Sequence[Row]) -> mpl.image.AxesImage:
    values = sorted({row.value for row in rows})
    cells: dict[tuple[int, int], list[Row]] = {}
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
    panel.set_xticks(ticks, [f"{values[k]:g}" for k in ticks])
    panel.set_title(f"{family.name}: {family.axis}", fontsize=8, loc="left")
    panel.tick_params(length=2)
    return drawn
