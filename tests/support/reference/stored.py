"""Scenes with their ends (make_references.py writes these), and how a run is compared with one of them."""

import json
from functools import cache
from pathlib import Path

import numpy as np

from support.checks import differences

FOLDER = Path(__file__).parent


@cache
def stored(name):
    """Returns the rows of <name>_references.json: name, shape, values, end, and figures found."""
    return json.loads((FOLDER / f"{name}_references.json").read_text(encoding="utf-8"))


def both_bodies(fmu, name):
    return np.concatenate([fmu[f"source.{name}"], fmu[f"destination.{name}"]])


def measured(fmu, name):
    """Returns an outcome of make_references.py, read from an FMU at the end of its run."""
    if name in ("displacement", "velocity"):
        return both_bodies(fmu, name)
    return fmu[name]


# Where a contact is left slowly, rounding alone moves its end by gap / speed; the impulse is not an output.
UNWEIGHED = {"impulse", "contact.last_duration"}


def errors_beyond(fmu, row, tolerance, factor):
    """Returns what differs from the reference by more than factor * tolerance: of displacements relative to
    1 m or their size, of all else as far as a nudge of the given numbers by as much would move it."""
    wrong = []
    for name, condition in row["condition"].items():
        if name in UNWEIGHED:
            continue
        size = max(1.0, float(np.max(np.abs(row[name]))))
        if name != "displacement":
            size += condition
        wrong += differences(name, measured(fmu, name), row[name], factor * tolerance * size)
    if row["steady"] and fmu["contact.onsets"] != row["onsets"]:
        wrong.append(f"onsets: got {fmu['contact.onsets']}, expected {row['onsets']}")
    return wrong
