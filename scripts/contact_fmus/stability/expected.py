"""What a run is held against"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

from .head_on import HeadOn
from .line_motion import DIGITS, Line

EPSILON = 2.0**-52
SLOW = 1e-6  # onsets slower than this part of the fastest motion are not counted on


@dataclass(frozen=True)
class Expected:
    """The end of a run"""

    displacement: dict[str, Sequence[Any]]  # of the free bodies, in as many digits as it takes
    way: float  # what errors are measured by, m
    rounding: float  # what the last digits of the numbers given leave open, m
    fastest: float  # m/s
    onsets: int
    sure: bool  # whether rounding cannot change the number of onsets
    strong: int  # onsets that nothing may miss
    last_onset: float | None
    onset_rounding: float = 0.0  # s
    through_middle: bool = False  # of a solid body, where the normal turns round
    turned: Any = None  # rad, the source about y; None where nothing is said of it


def of_head_on(motion: HeadOn, jumps: Sequence[tuple[float, float]] = ()) -> Expected:
    """`jumps`: times, and where the destination is from then on"""
    line, shift = motion.line(), 0.0
    for time, place in jumps:
        line.run(time)
        line.moved(shift - place)
        shift = place
    line.run(motion.end)
    with mp.workdps(DIGITS):
        along = mpf(motion.along_speed) * mpf(motion.end)
        moved = {body: [mpf(0), mpf(0), u] for body, u in _along_z(motion, line).items()}
        moved["source"][1] = along
        largest = max(float(abs(u[2])) for u in moved.values())
    fastest = float(line.fastest)
    way = max(largest, fastest * motion.end, float(line.deepest))
    apart = largest if motion.destination_mass is not None else 0.0  # both may have gone far together
    resolution = EPSILON * (float(line.reach) + apart)
    vanishing = line.touching and line.depth() < 1e3 * resolution
    slowest = min((float(v) for v in line.onset_speeds), default=math.inf)
    return Expected(
        displacement=moved,
        way=way,
        rounding=4 * resolution * (len(line.onset_times) + 1) + 4 * EPSILON * abs(float(along)),
        fastest=fastest,
        onsets=len(line.onset_times),
        sure=slowest > SLOW * fastest + 1e3 * resolution / motion.end
        and line.closest_end > 1e3 * EPSILON * way
        and not vanishing,
        strong=sum(float(v) > 1e-3 * fastest for v in line.onset_speeds),
        last_onset=float(line.onset_times[-1]) if line.onset_times else None,
        onset_rounding=8 * resolution * len(line.onset_times) / slowest if slowest > 0 else 0.0,
        through_middle=line.through_middle,
    )


def _along_z(motion: HeadOn, line: Line) -> dict[str, mpf]:
    """Displacements from the relative motion and that of the centre of mass"""
    begin = mpf(motion.source_center()[2]) - mpf(motion.offset)
    if motion.destination_mass is None:
        return {"source": line.place - begin}
    masses = mpf(motion.source_mass), mpf(motion.destination_mass)
    together = (-mpf(motion.speed) * masses[0] - mpf(motion.force) * line.time / 2) / sum(masses)
    middle = together * line.time - mpf(motion.gravity) * line.time**2 / 2
    relative = (line.place - begin) / sum(masses)
    return {"source": middle + masses[1] * relative, "destination": middle - masses[0] * relative}
