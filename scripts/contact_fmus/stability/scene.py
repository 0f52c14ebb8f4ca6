"""A scene of the atlas, and a family of them along one axis"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from .expected import Expected, of_head_on
from .head_on import HeadOn
from .motions import Motion
from .similar import Similar

STEPS = (1, 7)  # communication steps of a run, where a family does not say


class Jump(NamedTuple):
    """At the begin of communication step `step` the destination is moved to `shift` along z"""

    step: int
    shift: float


@dataclass(frozen=True)
class Scene:
    """One motion; it is run with every method and each number of communication steps"""

    family: str
    value: float  # on the family's axis
    motion: Motion
    steps: Sequence[int] = STEPS
    jumps: Sequence[Jump] = ()
    note: str = ""  # what sets it apart from others at the same value

    def __post_init__(self) -> None:
        if not isinstance(self.motion, Similar):
            object.__setattr__(self, "motion", self.motion.timed())

    def expected(self) -> dict[int, Expected]:
        """By number of communication steps, which matters where inputs jump at them"""
        if not isinstance(self.motion, HeadOn):
            return dict.fromkeys(self.steps, self.motion.expected())
        if not self.jumps:
            return dict.fromkeys(self.steps, of_head_on(self.motion))
        end = self.motion.end
        return {
            steps: of_head_on(self.motion, [(end * (jump.step / steps), jump.shift) for jump in self.jumps])
            for steps in self.steps
        }

    @property
    def name(self) -> str:
        parts = (self.family, f"{self.value:g}", self.motion.geometry, self.motion.law, self.note)
        return ", ".join(part for part in parts if part)


class Family(NamedTuple):
    name: str
    axis: str  # with its unit
    make: Callable[[], Iterator[Scene]]


def decades(first: int, last: int, stride: int = 1) -> list[float]:
    return [float(f"1e{k}") for k in range(first, last + 1, stride)]
