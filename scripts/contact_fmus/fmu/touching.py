"""Steps that stop right before and right after every onset and release on their way.

Rows of a result are joined by straight lines. Without rows on both sides of an onset they would show a force
before the bodies touch. The added rows change nothing of the motion: after a step in which bodies touched or
parted, the FMU goes back to the begin of the step, the instant is looked for, and in the end the FMU takes up
the state again in which the whole step had left it.

    touching = Touching(fmu)
    for _ in touching.step(0.5):    # it yields where the FMU stands at an instant worth a row
        record(fmu)                 # afterwards the FMU is at 0.5 s
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from .contact_fmu import ContactFmu, FmuError, SavedState

LEAST = 16  # roundings of the time: a shorter step could end where it began
WIDTHS = (1, 8, 64, 4096)  # of LEAST, how far beside the instant that the FMU names is looked first
TRIALS = 12  # of such times, before halves take over
MOST = 200  # onsets and releases of one step that get rows; bodies that chatter would fill a result with them
SEEN = 1.01  # a peak that exceeds the force at the ends of a step by less than this part does not show
NEAR = (1 / 4, 1 / 16, 1 / 64)  # points towards an onset or a release, as parts of the way from what is before


class Instant(NamedTuple):
    """Where a step leads, or begins"""

    state: SavedState
    active: tuple[bool, ...]  # one entry a contact, as below
    onsets: tuple[int, ...]  # empty where the FMU counts none
    changed: bool  # whether bodies touched or parted since the begin of the step
    told: tuple[float, ...]  # s, the onsets and releases that the FMU names

    @property
    def time(self) -> float:
        return self.state.time


class Touching:
    """Steps of one instance. An FMU without contacts, or whose state cannot be saved, takes plain steps."""

    def __init__(self, fmu: ContactFmu):
        self.fmu = fmu
        names = [name.removesuffix(".gap") for name in fmu.variables if name.endswith(".gap")]
        self.contacts = [name for name in names if f"{name}.active" in fmu]
        self.saves = bool(self.contacts)

    def step(self, end: float, inside: int = 0) -> Iterator[float]:
        """Steps to `end` and yields the times in between at which the FMU stands then, in their order: both sides of
        each onset and release. `inside`: so many points besides while bodies touch, where their force
        would not show otherwise, and some beside that"""
        begin, forces = self._begin(), self._read("normal_force") if inside else ()
        self.fmu.step(end - self.fmu.time)
        if begin is None:
            return
        if not self._changed(begin):
            # A force that was clearly larger within the step than at its ends
            ends = zip(forces, self._read("normal_force"), self._read("peak_force"), strict=False)
            if any(peak > SEEN * max(one, other) for one, other, peak in ends):
                state = self.fmu.save()
                yield from self._between(begin, end, inside, (False, False))
                self.fmu.restore(state)
            return
        goal = last = self._instant(begin)
        first = True
        for _ in range(MOST):
            low, high = self._first_change(begin, goal)
            yield from self._between(begin, low.time, inside, (not first, True))
            for one in (low, high):
                if begin.time < one.time < end:
                    self.fmu.restore(one.state)
                    yield one.time
            begin, first = high, False
            if high.time >= end or not (goal := self._reach(begin, end)).changed:
                break
        if begin.time < end:
            yield from self._between(begin, end, inside, (True, False))
        self.fmu.restore(last.state)

    # instants

    def _read(self, name: str) -> tuple[Any, ...]:
        """The values of all contacts; nothing where a contact lacks the variable"""
        names = [f"{one}.{name}" for one in self.contacts]
        return tuple(self.fmu[one] for one in names) if all(one in self.fmu for one in names) else ()

    def _begin(self) -> Instant | None:
        if not self.saves:
            return None
        try:
            return Instant(self.fmu.save(), self._read("active"), self._read("onsets"), False, ())
        except FmuError:
            self.saves = False  # an FMU may save no state
            return None

    def _changed(self, begin: Instant) -> bool:
        """Whether bodies touched or parted in the one step from the begin to where the FMU stands"""
        if (self._read("active"), self._read("onsets")) != (begin.active, begin.onsets):
            return True
        # Where no onsets are counted, the largest overlap tells that bodies touched and parted again.
        overlaps = zip(self._read("peak_penetration"), begin.active, strict=False) if not begin.onsets else ()
        return any(depth > 0.0 and not before for depth, before in overlaps)

    def _instant(self, begin: Instant) -> Instant:
        state, active, changed = self.fmu.save(), self._read("active"), self._changed(begin)
        told = []
        known = zip(active, self._read("last_onset_time"), self._read("last_duration"), strict=False)
        for touching, onset, lasted in known:
            told += [onset] if touching else [onset, onset + lasted]
        named = tuple(sorted(time for time in told if time >= begin.time))
        return Instant(state, active, self._read("onsets"), changed, named)

    def _reach(self, begin: Instant, time: float) -> Instant:
        self.fmu.restore(begin.state)
        self.fmu.step(time - begin.time)
        return self._instant(begin)

    def _first_change(self, begin: Instant, goal: Instant) -> tuple[Instant, Instant]:
        """The last instant before bodies first touch or part, and the first one after it. The times that the
        FMU names are tried; it names the last onset only, so that halves are tried where no time is of use."""
        low, high, trials = begin, goal, TRIALS
        least = LEAST * np.spacing(max(abs(begin.time), abs(goal.time)))
        while high.time - low.time > 2.5 * least:
            tried = (time + way * width * least for time in high.told for width in WIDTHS for way in (1, -1))
            inner = (one for one in tried if low.time + least <= one <= high.time - least)
            half, trials = 0.5 * (low.time + high.time), trials - 1
            found = self._reach(begin, next(inner, half) if trials > 0 else half)
            low, high = (low, found) if found.changed else (found, high)
        return low, high

    # points between instants

    def _between(self, begin: Instant, end: float, inside: int, events: tuple[bool, bool]) -> Iterator[float]:
        """Points from the begin up to before `end`; `events`: whether bodies touch or part at either"""
        parts: list[float] = []
        if inside and events[0]:
            parts += NEAR
        if inside and events[1]:
            parts += [1.0 - one for one in NEAR]
        if inside and any(begin.active):
            parts += np.linspace(0.0, 1.0, inside + 2)[1:-1].tolist()
            # A contact that lasts begins like a short one.
            parts += np.geomspace(1e-4, 1.0 / inside, max(2, inside // 4)).tolist() if events[0] else []
        least = LEAST * np.spacing(max(abs(begin.time), abs(end)))
        self.fmu.restore(begin.state)
        for part in sorted(parts):
            time = begin.time + part * (end - begin.time)
            if time - self.fmu.time > least and end - time > least:
                self.fmu.step(time - self.fmu.time)
                yield time
