"""Runs scenes in worker processes: a row for each method and each number of communication steps"""

from __future__ import annotations

import hashlib
import multiprocessing
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from contact_fmus.bench.settings import METHODS

from . import checks
from .checks import TOLERANCE, Figures
from .drive import Driver, Outcome
from .scene import Scene
from .similar import Similar

MOST_STEPS = 10_000  # solver.max_internal_steps
PATIENCE = 300.0  # s for one scene with all its runs

_driver: Driver | None = None


@dataclass
class SceneRun:
    """One run"""

    family: str
    value: float
    geometry: str
    law: str
    note: str
    method: str
    communication_steps: int
    step_size: float
    status: str
    wrong: str  # the checks it failed
    finite: bool
    error: float
    rounding: float
    balance: float
    gain: float
    momentum: float
    touch: float
    touch_rounding: float
    through_middle: bool
    work: float
    onsets: int
    expected_onsets: int
    missed: bool
    steps: int
    events: int
    fallbacks: int
    seconds: float
    bits: str  # of the end in the scene's own units
    message: str


def start_values(scene: Scene, method: str) -> dict[str, Any]:
    return scene.motion.configuration() | {
        "solver.method": method,
        "solver.relative_tolerance": TOLERANCE,
        "solver.absolute_tolerance": max(1e-4 * TOLERANCE * scene.motion.scale, 1e-300),
        "solver.max_internal_steps": MOST_STEPS,
    }


def run_scene(scene: Scene, methods: Sequence[str] = METHODS) -> list[SceneRun]:
    global _driver  # one for each worker process
    _driver = _driver or Driver()
    motion, expected, rows = scene.motion, scene.expected(), []
    for steps in scene.steps:
        for method in methods:
            start = start_values(scene, method)
            outcome = _driver.run(motion.fmu, start, motion.end, steps, scene.jumps)
            found = checks.figures(motion, expected[steps], outcome)
            rows.append(row_of(scene, method, steps, outcome, found))
    return rows


def not_right(rows: Sequence[SceneRun], method: str) -> list[SceneRun]:
    """The method's runs that are wrong or did not come to their end: of those nothing was compared"""
    return [row for row in rows if row.method == method and (row.wrong or row.status != "ok")]


def row_of(scene: Scene, method: str, steps: int, outcome: Outcome, found: Figures) -> SceneRun:
    motion, counts = scene.motion, outcome.counts
    return SceneRun(
        family=scene.family,
        value=scene.value,
        geometry=motion.geometry,
        law=motion.law,
        note=scene.note,
        method=method,
        communication_steps=steps,
        step_size=motion.end / steps,
        status=outcome.status,
        wrong=" ".join(found.wrong(method)),
        steps=counts.get("solver.steps", 0),
        events=counts.get("solver.events", 0),
        seconds=outcome.seconds,
        bits=bits(scene, outcome),
        message=outcome.message,
        **asdict(found),
    )


def bits(scene: Scene, outcome: Outcome) -> str:
    """A short name for the end's last digits, where the scene is the same in other units as well"""
    if not isinstance(scene.motion, Similar) or outcome.status != "ok":
        return ""
    units = scene.motion.units
    ends = [
        outcome.last.vector(f"{body}.{row}") / units.factor(*powers)
        for body in ("source", "destination")
        for row, powers in (("displacement", (1, 0, 0)), ("velocity", (1, 0, -1)))
    ]
    return hashlib.sha256((np.array(ends) + 0.0).tobytes()).hexdigest()[:8]


def run_all(scenes: Sequence[Scene], workers: int) -> Iterator[tuple[Scene, list[SceneRun]]]:
    """In the order of the scenes"""
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        results = pool.imap(run_scene, scenes)
        for scene in scenes:
            try:
                yield scene, results.next(timeout=PATIENCE)
            except multiprocessing.TimeoutError:
                raise TimeoutError(f"not done after {PATIENCE:g} s: {scene.name}") from None


FEWEST = 5  # scenes of a family


def thinned(scenes: Sequence[Scene], stride: int) -> list[Scene]:
    """Every so many-th of each family, of small ones more; the strides pass through all geometries and laws,
    odd ones through both scenes of a pair"""
    families: dict[str, list[Scene]] = {}
    for scene in scenes:
        families.setdefault(scene.family, []).append(scene)
    return [
        scene for family in families.values() for scene in family[:: min(stride, _odd(len(family) // FEWEST))]
    ]


def _odd(number: int) -> int:
    """The largest odd number up to this one, 1 at least"""
    return max(1, number - 1 + number % 2)
