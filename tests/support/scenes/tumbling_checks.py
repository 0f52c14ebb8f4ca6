"""Onsets of one scene of tumbling_scenes.py, run in one communication step, against reference/tumbling.py."""

import math

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import start
from support.reference.tumbling import TumblingPair
from support.scenes.tumbling_scenes import END, random_tumbling_scene

FIRST_TOUCH = 1e-9  # s
TOLERANCE = 1e-10
AFTER = 1e-7  # s after the first touch, where the FMU tells when it was; less than any contact lasts here


def first_onset(fmu, values, expected, method):
    """By a step that ends just after the expected one; inf where nothing has touched by then."""
    start(fmu, values, TOLERANCE, method)
    fmu.step(expected + AFTER)
    return fmu["contact.last_onset_time"] if fmu["contact.onsets"] else math.inf


def failures(fmu, seed, method="event_driven", ends="open"):
    """Lines on what is wrong, and how far off the first touch was [s]."""
    values = random_tumbling_scene(seed, ends)
    onsets = TumblingPair(values).run(END)
    try:
        start(fmu, values, TOLERANCE, method)
        fmu.step(END)
        count = fmu["contact.onsets"]
        off = abs(first_onset(fmu, values, onsets[0], method) - onsets[0]) if onsets else 0.0
    except FmuError as error:
        return [f"seed {seed}, {ends}: {error}"], 0.0
    lines = []
    if count != len(onsets):
        lines.append(f"seed {seed}, {ends}: {count} onsets, expected {len(onsets)}, at {onsets[:4]}")
    if not off <= FIRST_TOUCH:
        lines.append(f"seed {seed}, {ends}: first touch off by {off} s, at {onsets[0]}")
    return lines, off
