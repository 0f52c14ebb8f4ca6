"""Runs scenes on the FMUs in worker processes: a row for each method and number of communication steps"""

import functools
import hashlib
import math
import multiprocessing
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from mpmath import mp, mpf

from contact_fmus.bench.problems import METHODS
from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, Status, fmu_file
from contact_fmus.scenarios import experiment
from contact_fmus.scenarios.recording import said

from .line_motion import DIGITS
from .motions import Expected, Motion, Similar
from .scenes import Scene

# Runs one scene on an FMU and keeps what the checks need: the motion at every communication point's end

BODIES = ("source", "destination")
ENERGIES = (*experiment.ENERGIES, "external_work", "total")
REALS = [
    *(f"{body}.{row}[{i}]" for body in BODIES for row in ("displacement", "velocity") for i in (1, 2, 3)),
    *(f"energy.{name}" for name in ENERGIES),
    *(f"contact.mean_force[{i}]" for i in (1, 2, 3)),
    *(f"source.orientation[{i}]" for i in (1, 2, 3, 4)),
    *(f"contact.{name}" for name in ("last_onset_time", "last_duration", "peak_force", "peak_penetration")),
]
PEAKS = 2  # at the end of REALS: an FMU refuses those that rounding of a stiff contact leaves unknown
COUNTS = ["contact.onsets", "solver.steps", "solver.events", "solver.force_evaluations", "solver.fallbacks"]


class Sample:
    """The Reals of REALS at one time"""

    def __init__(self, time: float, values: np.ndarray):
        self.time, self.values = time, values

    def vector(self, name: str, size: int = 3) -> np.ndarray:
        first = REALS.index(f"{name}[1]")
        return self.values[first : first + size]

    def __getitem__(self, name: str) -> float:
        return self.values[REALS.index(name)]


@dataclass
class Outcome:
    """What came of a run"""

    samples: list[Sample] = field(default_factory=list)  # at the start and after every step, also a discarded one
    counts: dict[str, int] = field(default_factory=dict)
    status: str = "ok"  # ok, refused (at initialization), discarded (in a step)
    message: str = ""
    seconds: float = 0.0  # of stepping

    @property
    def last(self) -> Sample:
        return self.samples[-1]


@functools.cache
def opened(name: str) -> tuple[ContactFmu, tuple[int, ...]]:
    """A universal FMU, instantiated once in a process, and the references of REALS"""
    fmu = ContactFmu(fmu_file(name))
    return fmu, tuple(fmu.variable(row).references[0] for row in REALS)


def run(name: str, start: dict[str, Any], end: float, steps: int, jumps=()) -> Outcome:
    """`start` may have "<input>.derivatives", from time 0 on; `jumps`: of the destination along z, at
    communication steps"""
    fmu, references = opened(name)
    fmu.reset()
    fmu.messages.clear()
    outcome = Outcome()

    def sample() -> None:
        try:
            values = np.array(fmu.call("reals", references))
        except FmuError as error:
            if "is not known" not in said(error):
                raise
            # Peaks are a scale of energies only, and then none.
            values = np.append(fmu.call("reals", references[:-PEAKS]), [0.0] * PEAKS)
        outcome.samples.append(Sample(fmu.time, values))

    derivatives = {name: rows for name, rows in start.items() if name.endswith(".derivatives")}
    try:
        fmu.start({name: value for name, value in start.items() if name not in derivatives})
        for name, rows in derivatives.items():
            for order, row in enumerate(rows, start=1):
                fmu.set_derivative(name.removesuffix(".derivatives"), row, order=order)
    except FmuError as error:
        return Outcome(status="refused", message=said(error))
    sample()
    for step in range(steps):
        for jump in jumps:
            if jump.step == step:
                fmu["destination.prescribed_displacement"] = [0.0, 0.0, jump.shift]
        begin = time.perf_counter()
        try:
            fmu.step(end * ((step + 1) / steps) - fmu.time)
        except FmuError as error:
            outcome.status = "discarded" if error.status == Status.DISCARD else "error"
            outcome.message = said(error)
        outcome.seconds += time.perf_counter() - begin
        if outcome.status != "error":
            sample()
        if outcome.status != "ok":
            break
    if outcome.status != "error":
        outcome.counts = {row: fmu[row] for row in COUNTS}
    return outcome


# What is asked of a run. Every figure is free of units: errors over the size of the motion, energies over
# the largest one in play, momenta over the largest one exchanged.

TOLERANCE = 1e-9  # solver.relative_tolerance of all runs

# A figure beyond its limit is wrong. An error may be as much as rounding leaves open besides. CVODE holds
# its tolerance by the step, and its steps add up.
LIMITS = {
    "event_driven": {"error": 1e-7, "balance": 1e-9, "gain": 1e-9, "momentum": 1e-9, "touch": 1e-7},
    "cvode_bdf": {"error": 1e-5, "balance": 1e-6, "gain": 1e-6, "momentum": 1e-6, "touch": 1e-6},
    "cvode_adams": {"error": 1e-5, "balance": 1e-6, "gain": 1e-6, "momentum": 1e-6, "touch": 1e-6},
}
# Internal steps of event_driven at most for each communication step, event and radian of slow swinging.
WORK = 3000


@dataclass
class Figures:
    """nan: not to be said of this run"""

    finite: bool = True
    error: float = math.nan  # of the place at the end, over the way, or of the angle turned, over it
    rounding: float = 0.0  # what the numbers themselves leave open, alike
    balance: float = math.nan
    gain: float = math.nan  # of mechanical energy, in passive scenes
    momentum: float = math.nan
    touch: float = math.nan  # error of the last onset's time, over the end
    touch_rounding: float = 0.0
    through_middle: bool = False  # of a solid body, where the normal turns round
    onsets: int = 0
    expected_onsets: int = 0
    missed: bool = False
    work: float = math.nan  # internal steps by what they are bounded by
    fallbacks: int = 0

    def failures(self, method: str) -> list[str]:
        """The checks that it fails"""
        found = [] if self.finite else ["finite"]
        for name, limit in LIMITS[method].items():
            slack = {"error": self.rounding, "touch": self.touch_rounding}.get(name, 0.0)
            if getattr(self, name) > limit + slack:
                found.append(name)
        if method == "event_driven" and self.work > WORK:
            found.append("work")
        return found + (["onsets"] if self.missed else [])


def figures(motion: Motion, expected: Expected, outcome: Outcome) -> Figures:
    if not outcome.counts:
        return Figures()
    values = np.array([sample.values for sample in outcome.samples])
    if not np.all(np.isfinite(values)):
        return Figures(finite=False)
    found = Figures(onsets=outcome.counts["contact.onsets"], expected_onsets=expected.onsets)
    velocities = [one.vector(f"{body}.velocity") for one in outcome.samples for body in BODIES]
    fastest = max(expected.fastest, *map(float, np.linalg.norm(velocities, axis=1)))
    counts = outcome.counts
    units = len(outcome.samples) - 1 + counts["solver.events"] + motion.swings(outcome.last.time)
    found.work = counts["solver.steps"] / units
    found.fallbacks = counts["solver.fallbacks"]
    found.balance, found.gain = energy(motion, outcome, fastest)
    found.momentum = momentum(motion, outcome, fastest)
    if outcome.status == "ok":
        compare(found, expected, outcome)
    return found


def energy(motion: Motion, outcome: Outcome, fastest: float) -> tuple[float, float]:
    """How far energy.total strays, and mechanical energy rises, over the largest energy in play"""
    rows = {name: np.array([one[f"energy.{name}"] for one in outcome.samples]) for name in ENERGIES}
    depth = max(sample["contact.peak_penetration"] for sample in outcome.samples)
    mass, other = motion.masses()
    reduced = mass if other is None else mass / (1 + mass / other)
    in_play = max(float(np.max(np.abs(row))) for row in rows.values())
    in_play = max(in_play, motion.stored_penalty * depth**2 / 2, reduced * fastest**2 / 2)
    if in_play == 0:
        return 0.0, 0.0
    balance = float(np.max(np.abs(rows["total"] - rows["total"][0]))) / in_play
    if not motion.passive():
        return balance, math.nan
    mechanical = sum(rows[name] for name in ("kinetic", "rotational", "potential", "contact", "tangential"))
    return balance, max(0.0, float(np.max(mechanical - mechanical[0]))) / in_play


def momentum(motion: Motion, outcome: Outcome, fastest: float) -> float:
    """m dv of the source against the impulses of contact, gravity and force; of both bodies together"""
    if getattr(motion, "held", False):
        return math.nan
    first, last = outcome.samples[0], outcome.last
    times = np.array([sample.time for sample in outcome.samples])
    contact = np.array([sample.vector("contact.mean_force") for sample in outcome.samples[1:]])
    passed = contact * np.diff(times)[:, None] if len(contact) else np.zeros((1, 3))
    duration = last.time - first.time
    mass, other = motion.masses()
    given = motion.given_impulse("source", duration)
    gained = mass * (last.vector("source.velocity") - first.vector("source.velocity"))
    scale = mass * fastest + np.linalg.norm(given) + np.sum(np.abs(passed))
    if scale == 0:
        return 0.0
    error = np.linalg.norm(gained - given - passed.sum(axis=0)) / scale
    if other is not None:
        change = other * (last.vector("destination.velocity") - first.vector("destination.velocity"))
        outer = motion.given_impulse("destination", duration)
        scale += other * fastest + np.linalg.norm(outer)
        error = max(error, np.linalg.norm(gained + change - given - outer) / scale)
    return float(error)


def turn_error(last: Sample, turned: mpf) -> float:
    """The error of the source's orientation over the angle it has turned, or over one radian if that is more"""
    with mp.workdps(DIGITS):
        right = [mp.cos(turned / 2), mpf(0), mp.sin(turned / 2), mpf(0)]
        shown = [mpf(float(x)) for x in last.vector("source.orientation", 4)]
        apart = min(mp.norm([a - sign * b for a, b in zip(shown, right, strict=True)]) for sign in (1, -1))
        return float(2 * apart / max(abs(turned), 1))


def compare(found: Figures, expected: Expected, outcome: Outcome) -> None:
    """The end, the onsets and the time of the last one"""
    last, errors = outcome.last, []
    with mp.workdps(DIGITS):
        for body, moved in expected.displacement.items():
            shown = last.vector(f"{body}.displacement")
            errors += [float(abs(mpf(float(x)) - u)) for x, u in zip(shown, moved, strict=True)]
    found.through_middle = expected.through_middle
    found.error = max(errors) / expected.way if expected.way > 0 else max(errors)
    found.rounding = expected.rounding / expected.way if expected.way > 0 else 0.0
    if expected.turned is not None:
        found.error = max(found.error, turn_error(last, expected.turned))
    if expected.sure:
        found.missed = found.onsets != expected.onsets
        if expected.last_onset is not None:
            found.touch = abs(last["contact.last_onset_time"] - expected.last_onset) / last.time
            found.touch_rounding = expected.onset_rounding / last.time
    else:
        found.missed = found.onsets < expected.strong


# Runs scenes in worker processes: a row for each method and each number of communication steps

MOST_STEPS = 10_000  # solver.max_internal_steps
PATIENCE = 300.0  # s for one scene with all its runs


@dataclass(kw_only=True)
class SceneRun(Figures):
    """One run with its figures"""

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
    steps: int
    events: int
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
    motion, expected, rows = scene.motion, scene.expected(), []
    for steps in scene.steps:
        for method in methods:
            outcome = run(motion.fmu, start_values(scene, method), motion.end, steps, scene.jumps)
            rows.append(row_of(scene, method, steps, outcome, figures(motion, expected[steps], outcome)))
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
        wrong=" ".join(found.failures(method)),
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
    """The runs come in the order of the scenes."""
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
    fewest = {name: len(family) // FEWEST for name, family in families.items()}
    odd = {name: max(1, number - 1 + number % 2) for name, number in fewest.items()}
    return [scene for name, family in families.items() for scene in family[:: min(stride, odd[name])]]
