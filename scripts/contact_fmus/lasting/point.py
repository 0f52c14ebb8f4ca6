"""A method to integrate lasting contact, and what one run of it cost"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """`program`: exponential, or Radau IIA with an angle (plane) or with n and H (space) as unknowns"""

    program: str
    stages: int = 0

    @property
    def name(self) -> str:
        if self.program == "exponential":
            return "exponential collocation"
        return f"Radau IIA, {self.stages} stages" + (", plane" if self.program == "plane" else "")


@dataclass(frozen=True)
class Point:
    """What one run cost and how far off it is; error None where an iteration does not converge"""

    method: str
    damping: float
    penalty: float
    step: float  # s
    error: float | None = None  # m
    iterations: int = 0  # of Newton; sweeps
    evaluations: int = 0  # of the right side at one instant
    solves: int = 0  # of complex linear systems of the problem's size
    seconds: float = 0.0
