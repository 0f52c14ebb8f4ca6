"""Inputs over time: straight lines between points, a sinusoid, or the time derivative of another input"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

FORMS = {
    "table": {"times", "values"},
    "sinusoid": {"offset", "amplitude", "frequency", "phase"},
    "derivative": {"derivative_of"},
}


@dataclass(frozen=True)
class InputSignal:
    variable: str
    derivatives: int  # how many are given to the FMU besides the value
    evaluate: Callable[[float, int], np.ndarray]  # (time, order of the derivative)

    @staticmethod
    def make(variable: str, derivatives: int, options: dict[str, Any]) -> InputSignal:
        """ValueError where the options are not one of the forms"""
        if derivatives not in (0, 1, 2):
            raise ValueError(f"derivatives = {derivatives} is not 0, 1 or 2")
        if not options:
            raise ValueError("give times and values, or amplitude and frequency, or derivative_of")
        form = next((name for name, keys in FORMS.items() if set(options) <= keys), None)
        if form == "table":
            return InputSignal(variable, derivatives, _table(**options))
        if form == "sinusoid":
            return InputSignal(variable, derivatives, _sinusoid(**options))
        if form == "derivative":
            original = options["derivative_of"].evaluate
            return InputSignal(variable, derivatives, lambda time, order: original(time, order + 1))
        raise ValueError(
            f"{', '.join(options)} do not go together: give times and values, or amplitude and "
            "frequency, or derivative_of"
        )


def _table(
    times: list[float] | None = None, values: list | None = None
) -> Callable[[float, int], np.ndarray]:
    if not times or not values or len(times) != len(values) or not np.all(np.diff(times) > 0.0):
        raise ValueError("times must rise, with one of values for each")
    points, nodes = np.array(times, dtype=float), np.array(values, dtype=float).reshape(len(times), -1)

    def evaluate(time: float, order: int) -> np.ndarray:
        # A corner belongs to the line after it: that is the derivative the FMU needs from this point on.
        line = int(np.searchsorted(points, time, side="right")) - 1
        if line < 0 or line >= len(points) - 1:
            return nodes[max(0, min(line, len(points) - 1))] * (order == 0)
        slope = (nodes[line + 1] - nodes[line]) / (points[line + 1] - points[line])
        return (nodes[line] + slope * (time - points[line]), slope)[order] if order < 2 else 0.0 * slope

    return evaluate


def _sinusoid(
    amplitude: Any = None, frequency: float | None = None, offset: Any = 0.0, phase: float = 0.0
) -> Callable[[float, int], np.ndarray]:
    if amplitude is None or frequency is None:
        raise ValueError("a sinusoid needs amplitude and frequency")
    size, middle = np.atleast_1d(np.array(amplitude, dtype=float)), np.array(offset, dtype=float)
    rate = 2.0 * math.pi * frequency

    def evaluate(time: float, order: int) -> np.ndarray:
        # The n-th derivative of sin is sin turned by n quarter turns.
        wave = size * rate**order * math.sin(rate * time + phase + 0.5 * math.pi * order)
        return wave + middle if order == 0 else wave

    return evaluate
