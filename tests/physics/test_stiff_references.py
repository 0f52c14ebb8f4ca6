"""The references of the stiffness sweep: each kind recomputed where a second way is quick, and what they say
of the motion.
"""

import json

import numpy as np
import pytest

from support.checks import check_close
from support.reference.make_stiff_references import COUNTABLE, DAMPING, END, FILE, expansion
from support.reference.stiff_motion import MASS, damped_motion, mean_motion

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


@pytest.mark.parametrize("shape", SHAPES)
def test_the_expansion_meets_the_taylor_integrator_where_both_reach(shape):
    place, left_out = expansion(shape, COUNTABLE)
    assert left_out < 1e-12
    check_close("position", place, ROWS[shape, 0.0, COUNTABLE]["position"], left_out)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_stiffest_damped_motion_has_no_oscillation_left(shape):
    mean = mean_motion(shape, 1e15, END)
    check_close("position", mean, ROWS[shape, DAMPING, 1e15]["position"], 1e-13)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_undamped_motion_stays_near_the_one_without_oscillation(shape):
    """Off by the amplitude and its like: less than m g/p_n."""
    rows = [row for key, row in ROWS.items() if key[:2] == (shape, 0.0)]
    assert len(rows) == 7
    for row in rows:
        off = np.linalg.norm(mean_motion(shape, row["penalty_factor"], END) - row["position"])
        assert off * row["penalty_factor"] < 9.81 * MASS


def test_the_uncertainties_stay_below_what_is_asked():
    assert len(ROWS) == 36
    assert max(row["uncertainty"] for row in ROWS.values()) < 2e-13
