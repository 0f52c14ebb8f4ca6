#!/usr/bin/env python3
"""Draws model.png beside this script, the icon of every FMU: a ball overlapping a larger body, and its force.

Run it by hand after a change (it needs matplotlib); the drawing is kept in the repository for the build.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.patches import Circle


def draw(path: Path) -> None:
    figure = plt.figure(figsize=(2.0, 2.0), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal")
    axes.axis("off")
    axes.add_patch(Circle((0, -0.75), 0.95, facecolor="#d8e2ec", edgecolor="#334455", linewidth=2))
    axes.add_patch(Circle((0, 0.42), 0.32, facecolor="#f3d9b8", edgecolor="#774433", linewidth=2))
    axes.annotate(
        "", (0, 0.98), (0, 0.15), arrowprops={"arrowstyle": "-|>", "color": "#bb0000", "linewidth": 2.5}
    )
    figure.savefig(path, transparent=True, metadata={"Software": None})


if __name__ == "__main__":
    draw(Path(__file__).resolve().with_name("model.png"))
