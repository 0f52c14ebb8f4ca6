"""What is asked of a run. Every figure is free of units: errors over the size of the motion, energies over
the largest one in play, momenta over the largest one exchanged.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf

from .drive import ENERGIES, Outcome, Sample
from .expected import Expected
from .line_motion import DIGITS
from .motions import Motion

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

    def wrong(self, method: str) -> list[str]:
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
    fastest = max(expected.fastest, *(speed(sample) for sample in outcome.samples))
    counts = outcome.counts
    units = len(outcome.samples) - 1 + counts["solver.events"] + motion.swings(outcome.last.time)
    found.work = counts["solver.steps"] / units
    found.fallbacks = counts["solver.fallbacks"]
    found.balance, found.gain = energy(motion, outcome, fastest)
    found.momentum = momentum(motion, outcome, fastest)
    if outcome.status == "ok":
        compare(found, expected, outcome)
    return found


def speed(sample: Sample) -> float:
    return float(max(np.linalg.norm(sample.vector(f"{body}.velocity")) for body in ("source", "destination")))


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
    """Of the source's orientation by the angle it has turned, of one radian if that is less"""
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
