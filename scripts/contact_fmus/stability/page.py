"""The atlas's page: index.html, which holds its figures, and README.md next to them"""

import datetime
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from contact_fmus.pages import Table, read_words, versions, write_pages

from .motions import LAWS
from .run import LIMITS, METHODS, MOST_STEPS, TOLERANCE, SceneRun
from .scenes import FAMILIES, Family

# The runs together: one line for each value on a family's axis, and the limits of the methods

MEASURES = ["error", "balance", "gain", "momentum", "touch"]
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")


def groups(rows: Sequence[SceneRun] | pd.DataFrame) -> pd.DataFrame:
    """All runs of a method at one value of a family's axis; the figures are the worst of those that ended"""
    table = pd.DataFrame(rows)
    wrong = table.wrong != ""
    refused = ~wrong & (table.status != "ok")
    table = table.assign(runs=1, right=~wrong & ~refused, refused=refused, wrong=wrong, most_seconds=table.seconds)
    figures = dict.fromkeys(("runs", "right", "refused", "wrong"), "sum")
    figures |= dict.fromkeys((*MEASURES, "steps", "most_seconds"), "max")
    return table.groupby(["family", "value", "method"], sort=False).agg(figures).reset_index()


def write_csv(rows: Sequence[SceneRun] | pd.DataFrame, file: Path) -> None:
    """Figures with three digits, Booleans as 0 and 1"""
    table = pd.DataFrame(rows)
    table = table.astype(dict.fromkeys(table.select_dtypes(bool), int))
    table.to_csv(file, index=False, float_format="%.3g", lineterminator="\n")


def counts(table: pd.DataFrame) -> Table:
    header = ["method", "scenes", "right", "refused with a message", "wrong", "largest error", "energy", "gain"]
    header += ["momentum", "most internal steps", "longest run"]
    cells = []
    for method in METHODS:
        own = table[table.method == method]
        right = own[own.wrong == ""]
        ended = sum(right.status == "ok")
        numbers = [len(own), ended, len(right) - ended, len(own) - len(right)]
        worst = (f"{right[name].max():.1e}" for name in MEASURES[:4])
        cells.append([method, *map(str, numbers), *worst, str(own.steps.max()), f"{own.seconds.max():.2f} s"])
    return Table("All runs; figures of those that are not wrong", header, cells)


def span(values: Iterable[float]) -> str:
    ordered = sorted(set(values))
    return f"{ordered[0]:g}" if len(ordered) == 1 else f"{ordered[0]:g} … {ordered[-1]:g}"


def reason(row: pd.Series) -> str:
    """The message without its numbers: a kind of refusal"""
    text, limit = row.message.partition(": ")[2], "solver.max_internal_steps"
    return limit if limit in text else NUMBER.sub("#", text)[:120] or row.status


def _kinds(table: pd.DataFrame, kind: str) -> Iterator[tuple[list[str], pd.DataFrame]]:
    """What both tables of runs that are not right begin with, method by method: method, axis, values, laws, kind"""
    found = table.groupby(["method", "family", kind], sort=False)
    for (method, family, what), own in sorted(found, key=lambda item: METHODS.index(item[0][0])):
        laws = sorted(set(own.law))
        yield [method, family, span(own.value), "all" if len(laws) == 5 else ", ".join(laws), what], own


def refusals(table: pd.DataFrame) -> Table:
    """Where a method refuses, and for what reason"""
    runs = Counter(zip(table.method, table.family, strict=True))
    refused = table[(table.status != "ok") & (table.wrong == "")]
    kinds = _kinds(refused.assign(reason=[reason(row) for row in refused.itertuples()]), "reason")
    cells = [[*begin, f"{len(own)} of {runs[begin[0], begin[1]]}"] for begin, own in kinds]
    return Table("Refused, by the message", ["method", "axis", "values", "laws", "reason", "runs"], cells, 5)


def mistakes(table: pd.DataFrame) -> Table:
    cells = []
    for begin, own in _kinds(table[table.wrong != ""], "wrong"):
        row = own.loc[own.error.fillna(0.0).idxmax()]
        name = ", ".join(part for part in (row.geometry, row.law, f"{row.value:g}", row.note) if part)
        cells.append([*begin, f"{name} ({row.error:.0e})", str(len(own))])
    header = ["method", "axis", "values", "laws", "failed", "the worst", "runs"]
    return Table("Wrong", header, cells, 6)


def axes(table: pd.DataFrame) -> Table:
    """The range of each axis in which a method is right with all its scenes"""
    cells, every = [], groups(table)
    for family in FAMILIES:
        own = every[every.family == family.name]
        if len(own):
            reached = [_reached(own[own.method == method].sort_values("value")) for method in METHODS]
            cells.append([family.axis, span(own.value), *reached])
    return Table("Values at which all scenes of an axis are right", ["axis", "declared", *METHODS], cells, 5)


def _reached(own: pd.DataFrame) -> str:
    """Stretches of neighbouring values"""
    good = own.right == own.runs
    if good.all():
        return "all"
    stretches = own[good].groupby((~good).cumsum()[good]).value
    return ", ".join(span(values) for _, values in stretches) or "none"


def same_bits(table: pd.DataFrame) -> Table:
    """How many oblique scenes end with the same bits in other units"""
    key = ["note", "method", "communication_steps"]
    units = table[table.family.str.startswith("unit of")]
    original = units[units.value == 0].drop_duplicates(key, keep="last").set_index(key).bits
    other = units[(units.value != 0) & (units.bits != "")].join(original.rename("original"), on=key)
    cells = []
    for family in (one.name for one in FAMILIES if one.name.startswith("unit of")):
        own = [other[(other.family == family) & (other.method == method)] for method in METHODS]
        cells.append([family, *(f"{sum(one.bits == one.original)} of {len(one)}" for one in own)])
    return Table("The same bits in other units", ["units", *METHODS], cells, 1)


def allowed() -> Table:
    cells = [[method, *(f"{LIMITS[method][name]:.0e}" for name in MEASURES)] for method in METHODS]
    return Table("What counts as right: no figure above", ["method", *MEASURES], cells, 1)


# Heat maps: a panel for each axis and method, a row for each law, coloured by the worst of its runs

WORDS = read_words(__file__)
STYLE = {"font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 10}
REFUSED, NOTHING = "#94a3b8", "#f1f5f9"


# Figures: the column of a run that is shown, and its colours' ends
MAPS = {"error": ("error", (1e-17, 1.0)), "energy": ("balance", (1e-17, 1.0)), "steps": ("work", (1.0, 1e4))}


def draw(table: pd.DataFrame, folder: Path) -> list[dict[str, str]]:
    """Name and caption of each figure; the files are name.png"""
    found = []
    for name, (column, bounds) in MAPS.items():
        with mpl.rc_context(STYLE):
            _figure(column, bounds, table).savefig(folder / f"{name}.png", dpi=90, metadata={"Software": None})
        low, high = map(short, bounds)
        scale = f"Dark blue is {low} or less, yellow {high} or more."
        found.append({"name": name, "caption": f"{WORDS['maps'][name]} {scale} {WORDS['legend']}"})
    return found


def short(value: float) -> str:
    """1e-9 rather than 1e-09, 1e5 rather than 100000"""
    text = f"{value:.6g}" if 1e-3 < abs(value) < 1e4 or value == 0 else f"{value:.1e}".replace(".0e", "e")
    return re.sub(r"e([-+])0*", lambda match: "e" + match[1].replace("+", ""), text)


def _figure(column: str, bounds: tuple[float, float], table: pd.DataFrame) -> Figure:
    families = [family for family in FAMILIES if (table.family == family.name).any()]
    height = 1.28 * len(families) + 1.4  # inches, of which 0.5 at the top and 0.9 at the bottom
    figure = Figure(figsize=(12.5, height))
    panels = figure.subplots(len(families), len(METHODS), squeeze=False)
    figure.subplots_adjust(0.075, 0.9 / height, 0.985, 1 - 0.5 / height, 0.05, 0.75)
    for line, family in zip(panels, families, strict=True):
        for panel, method in zip(line, METHODS, strict=True):
            own = table[(table.family == family.name) & (table.method == method)]
            image = _panel(panel, column, LogNorm(*bounds), family, own)
            if panel is not line[0]:
                panel.set_yticklabels([])
    for panel, method in zip(panels[0], METHODS, strict=True):
        panel.set_title(f"{method}\n{panel.get_title()}")
    bar = figure.add_axes((0.25, 0.35 / height, 0.5, 0.12 / height))
    figure.colorbar(image, cax=bar, orientation="horizontal")
    return figure


def _panel(panel: Axes, name: str, norm: LogNorm, family: Family, table: pd.DataFrame) -> mpl.image.AxesImage:
    values = sorted(set(table.value))
    image, refused = np.full((len(LAWS), len(values)), math.nan), []
    for (law, value), members in table.groupby(["law", "value"]):
        place = LAWS.index(law), values.index(value)
        ended = members[(members.status == "ok") | (members.wrong != "")]
        if ended.empty:
            refused.append(place)
            continue
        worst = ended[name].max()
        image[place] = worst if math.isnan(worst) else max(worst, norm.vmin)
        if (members.wrong != "").any():
            panel.plot(place[1], place[0], "x", color="#dc2626", markersize=5)
        elif len(ended) < len(members):
            panel.plot(place[1], place[0], ".", color="#64748b", markersize=3)
    panel.set_facecolor(NOTHING)
    for line, column in refused:
        panel.add_patch(mpl.patches.Rectangle((column - 0.5, line - 0.5), 1, 1, color=REFUSED, lw=0))
    drawn = panel.imshow(image, cmap="viridis", norm=norm, aspect="auto")
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
    table = pd.DataFrame(rows)
    drawn = draw(table, folder)
    context = {
        "made": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "plan": plan,
        "scenes": len(rows) // len(METHODS),
        "tolerance": f"{TOLERANCE:g}",
        "most_steps": MOST_STEPS,
        "families": [family for family in FAMILIES if (table.family == family.name).any()],
        "figures": drawn,
        "legend": WORDS["legend"],
        "counts": counts(table),
        "limits": [axes(table), refusals(table)],
        "mistakes": mistakes(table),
        "checks": [allowed(), same_bits(table)],
        "versions": versions(),
        "texts": WORDS,
    }
    return write_pages(Path(__file__).parent, folder, context)
