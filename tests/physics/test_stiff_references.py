"""The references of the stiffness sweep: each recomputed a second way."""

import json

import pytest

from support.checks import check_close
from support.reference.make_stiff_references import COUNTABLE, DAMPING, END, FILE, configuration
from support.reference.stiff_limit import StiffContact
from support.reference.stiff_motion import damped_motion

ROWS = {
    (row["shape"], row["damping"], row["penalty_factor"]): row
    for row in json.loads(FILE.read_text(encoding="utf-8"))
}
SHAPES = ("cylinder", "sphere")


@pytest.mark.parametrize("shape", SHAPES)
def test_radau_finds_the_stored_position_of_the_stiffest(shape):
    place, least = damped_motion(shape, 1e15, DAMPING, END, 1e-10)
    check_close("position", place, ROWS[shape, DAMPING, 1e15]["position"], 1e-12)
    assert least > 0


@pytest.mark.parametrize("shape, damping, penalty", ROWS)
def test_the_expansion_meets_every_stored_position_within_what_it_leaves_out(shape, damping, penalty):
    """Those of Radau's method and of the Taylor integrator too"""
    end = StiffContact(configuration(shape, penalty, damping), shape).end(END)
    assert end.least_push > 0
    assert end.left_out < 1e-12 or penalty < COUNTABLE
    check_close("position", end.position, ROWS[shape, damping, penalty]["position"], end.left_out)


def test_the_uncertainties_stay_below_what_is_asked():
    assert len(ROWS) == 36
    assert max(row["uncertainty"] for row in ROWS.values()) < 2e-13
