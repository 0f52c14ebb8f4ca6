"""Pictures of a sweep: a column over one parameter with its quantiles, or a map over two"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy import stats

from .store import Store

FAINT = 300  # more dots than that are small and faint
POINTS = 5_000  # dots of a scatter plot: more hide one another
BINS = 40  # of a parameter that has more values than this
QUANTILES = (0.05, 0.5, 0.95)
FEWEST = 5  # runs of a bin before it has quantiles


class Column:
    """Values as numbers, with what to write at an axis"""

    def __init__(self, rows: pa.Table, name: str):
        field = rows.schema.field(name)
        about = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
        unit = about.get("unit", "")
        self.label = f"{name} [{unit}]" if unit not in ("", "1") else name
        column = rows[name]
        self.items: list[str] = []
        if pa.types.is_dictionary(field.type):
            column = column.unify_dictionaries().combine_chunks()
            self.items = column.dictionary.to_pylist()
            column = column.indices
        self.values = np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), float)

    def mark(self, axis: Any) -> None:
        axis.set_label_text(self.label)
        if self.items:
            axis.set_ticks(range(len(self.items)), self.items)

    @property
    def logarithmic(self) -> bool:
        """Values above 0 that are spread evenly over decades"""
        values = self.values[np.isfinite(self.values)]
        if self.items or not len(values) or values.min() <= 0 or values.max() < 20 * values.min():
            return False
        middle = np.median(values)
        return bool(middle < 0.25 * values.max())

    def edges(self) -> np.ndarray:
        """The edges of bins; each value has a bin of its own where they are few"""
        values = self.values[np.isfinite(self.values)]
        unique = np.unique(values)
        if len(unique) > BINS:
            spread = np.geomspace if self.logarithmic else np.linspace
            return spread(unique[0], unique[-1], BINS + 1)
        if len(unique) < 2:
            return np.array([unique[0] - 0.5, unique[0] + 0.5]) if len(unique) else np.array([0.0, 1.0])
        even = np.log(unique) if self.logarithmic else unique
        middles = (even[1:] + even[:-1]) / 2
        edges = np.array([2 * even[0] - middles[0], *middles, 2 * even[-1] - middles[-1]])
        return np.exp(edges) if self.logarithmic else edges

    def bins(self) -> np.ndarray:
        edges = self.edges()
        return np.clip(np.searchsorted(edges, self.values, side="right") - 1, 0, len(edges) - 2)


def draw(store: Store, target: Path, names: Sequence[str]) -> Path:
    """`names` of columns: x, y and, for a map, color, as columns_of gives them"""
    rows = pq.read_table(store.results, columns=sorted(set(names)))
    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.subplots()
    columns = [Column(rows, name) for name in names]
    if len(columns) == 2:
        _line(axes, *columns)
    else:
        _map(axes, *columns)
    for column, axis, scale in ((columns[0], axes.xaxis, axes.set_xscale), (columns[1], axes.yaxis, axes.set_yscale)):
        if column.logarithmic:
            scale("log")
        column.mark(axis)
    axes.set_title(f"{store.study.title}\n{store.runs:,} runs", fontsize=10)
    target.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(target, dpi=150)
    return target


def _line(axes: Axes, x: Column, y: Column) -> None:
    finite = np.flatnonzero(np.isfinite(x.values) & np.isfinite(y.values))
    shown = finite[:: max(1, -(-len(finite) // POINTS))]
    few = f", {len(shown):,} of {len(finite):,} shown" if len(shown) < len(finite) else ""
    size, alpha = (6, 0.8) if len(shown) <= FAINT else (3, 0.35)
    axes.plot(x.values[shown], y.values[shown], ".", ms=size, alpha=alpha, color="tab:gray", label=f"runs{few}")
    place, rows = x.bins()[finite], []
    for inside in (finite[place == index] for index in np.unique(place)):
        levels = np.quantile(y.values[inside], QUANTILES) if len(inside) >= FEWEST else [np.nan] * 3
        rows.append((np.median(x.values[inside]), *levels))
    middle, low, median, high = np.array(rows).reshape(-1, 4).T
    if np.isfinite(median).any():
        axes.plot(middle, median, color="tab:blue", label="median")
        axes.fill_between(middle, low, high, color="tab:blue", alpha=0.2, label="5 % to 95 %")
    axes.legend(loc="best", fontsize=8)


def _map(axes: Axes, x: Column, y: Column, color: Column) -> None:
    """The median of a colour's values in each cell; cells without a run stay empty"""
    x_edges, y_edges = x.edges(), y.edges()
    finite = np.isfinite(x.values) & np.isfinite(y.values) & np.isfinite(color.values)
    cells = stats.binned_statistic_2d(
        y.values[finite], x.values[finite], color.values[finite], "median", [y_edges, x_edges]
    ).statistic
    norm: Any = LogNorm() if color.logarithmic else None
    mesh = axes.pcolormesh(x_edges, y_edges, cells, norm=norm)
    bar = axes.figure.colorbar(mesh, ax=axes, label=f"median of {color.label}")
    if color.items:
        bar.set_ticks(range(len(color.items)), labels=color.items)
