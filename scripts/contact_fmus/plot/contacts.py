"""When bodies touched, from a result.

An FMU with free bodies tells each contact's last onset and how long it has lasted, exactly. Where both
motions are given there are no such outputs: there the sign of the gap tells, as exactly as the result is
dense.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact_fmus.results import Result


@dataclass(frozen=True)
class Touch:
    """One stay in contact"""

    contact: str
    begin: float  # s
    end: float  # s; of one under way, the end of the result

    @property
    def duration(self) -> float:
        return self.end - self.begin


def contact_names(result: Result) -> list[str]:
    return [name.removesuffix(".gap") for name in result.columns if name.endswith(".gap")]


def touches(result: Result) -> list[Touch]:
    """In the order of their onsets"""
    found: list[Touch] = []
    for name in contact_names(result):
        reported = f"{name}.last_onset_time" in result.columns and f"{name}.onsets" in result.columns
        found += _reported(result, name) if reported else _from_gap(result, name)
    return sorted(found, key=lambda touch: (touch.begin, touch.contact))


def _reported(result: Result, name: str) -> list[Touch]:
    """The last duration that is told for an onset is that of the whole contact."""
    count = np.asarray(result.columns[f"{name}.onsets"])
    onset, lasted = result.columns[f"{name}.last_onset_time"], result.columns[f"{name}.last_duration"]
    last = np.flatnonzero(np.append(np.diff(count) != 0, True) & (count > 0))
    return [Touch(name, float(onset[row]), float(onset[row] + lasted[row])) for row in last]


def _from_gap(result: Result, name: str) -> list[Touch]:
    time, gap = result.time, np.asarray(result.columns[f"{name}.gap"], dtype=float)
    touching = gap < 0.0
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    # Straight lines between the rows.
    share = np.clip(gap[edges] / (gap[edges] - gap[edges + 1]), 0.0, 1.0)
    times = time[edges] + share * (time[edges + 1] - time[edges])
    if len(touching) and touching[0]:
        times = np.insert(times, 0, time[0])
    if len(touching) and touching[-1]:
        times = np.append(times, time[-1])
    return [Touch(name, float(a), float(b)) for a, b in times.reshape(-1, 2)]
