"""Lasting contact at any stiffness: the motion is right to a nanometre from 1e5 to 1e15 N/m, no energy is
gained, and the work does not follow the stiffness.

References: the Taylor integrator where it can follow the oscillation, and the expansion of
stiff_motion.py, each checked against the other where both reach."""

import json
from functools import cache

import numpy as np
import pytest

from support.checks import FMU, check_close, run
from support.reference.integrator import Reference
from support.reference.make_stiff_references import COUNTABLE, DAMPING, END, FILE, configuration
from support.reference.stiff_motion import StiffContact, damped_motion
from support.reference.stored import both_bodies
from support.scenes.stiff_scenes import SCENES, settled, stiff_scene

METHOD = "event_driven"
TOLERANCE = 1e-10
EXACT = 1e-9  # m
SHARE = 0.1  # of the critical dashpot
FOLLOWED = [1e5, 1e6]  # N/m, where the Taylor integrator is the reference
LIMIT = [1e7, 1e9, 1e11, 1e13, 1e15]
UNDAMPED = [1e7, 1e9, 1e11]
WORK = 150_000  # internal steps of a run at most; one that follows each oscillation stops there and fails


def run_bounded(opened, shape, values, end, steps, each=None):
    values = {**values, "solver.max_internal_steps": WORK // steps}
    return run(opened(FMU[shape]), values, end, steps, TOLERANCE, METHOD, each)


@cache
def limit(name, stiffness, share, rest=False):
    shape, values, end = stiff_scene(name, stiffness, share)
    return StiffContact(settled(shape, values) if rest else values, shape).end(end)


@pytest.mark.parametrize("share", [SHARE, 0.0])
@pytest.mark.parametrize("name", SCENES)
def test_the_two_references_agree(name, share):
    """They agree up to what the expansion leaves out, which falls with the stiffness. The contact lasts."""
    before = np.inf
    for stiffness in (1e5, 1e6):
        shape, values, end = stiff_scene(name, stiffness, share)
        values, end = settled(shape, values) if share == 0 else values, end / 4
        expected = StiffContact(values, shape).end(end)
        followed = Reference(values, shape).run(end)
        assert followed.onsets == 1
        for body, place in (("source", expected.position), ("destination", expected.destination)):
            check_close(f"{body} position", followed.position[body], place, expected.left_out)
        assert expected.left_out < before / 20
        before = expected.left_out


@pytest.mark.parametrize("stiffness", FOLLOWED)
@pytest.mark.parametrize("name", SCENES)
def test_softer_walls(opened, name, stiffness):
    shape, values, end = stiff_scene(name, stiffness, SHARE)
    end /= 4
    fmu = run_bounded(opened, shape, values, end, 1)
    expected = Reference(values, shape).run(end)
    for body in ("source", "destination"):
        check_close(f"{body} position", fmu[f"{body}.position"], expected.position[body], EXACT)


def check_end(fmu, expected):
    assert expected.left_out < EXACT / 2
    assert expected.least_push > 0 or fmu["contact.location"] == "outside"
    position = np.concatenate([expected.position, expected.destination])
    check_close("positions", both_bodies(fmu, "position"), position, EXACT)


@pytest.mark.parametrize("steps", [1, 97])
@pytest.mark.parametrize("stiffness", LIMIT)
@pytest.mark.parametrize("name", SCENES)
def test_damped_walls(opened, name, stiffness, steps):
    """The ball starts on the wall, so that the load comes at once."""
    shape, values, end = stiff_scene(name, stiffness, SHARE)
    check_end(run_bounded(opened, shape, values, end, steps), limit(name, stiffness, SHARE))


@pytest.mark.parametrize("stiffness", UNDAMPED)
@pytest.mark.parametrize("name", SCENES)
def test_undamped_walls(opened, name, stiffness):
    """The ball starts where nothing oscillates."""
    shape, values, end = stiff_scene(name, stiffness, 0.0)
    fmu = run_bounded(opened, shape, settled(shape, values), end, 1)
    check_end(fmu, limit(name, stiffness, 0.0, rest=True))


@pytest.mark.parametrize("stiffness", UNDAMPED)
def test_an_undamped_wall_that_is_loaded_at_once(opened, stiffness):
    """P3 oscillates by the depth of its own weight and nearly loses touch at each turn."""
    shape, values, end = stiff_scene("P3", stiffness, 0.0)
    check_end(run_bounded(opened, shape, values, end, 1), limit("P3", stiffness, 0.0))


@pytest.mark.parametrize("share, stiffness", [(SHARE, k) for k in LIMIT] + [(0.0, k) for k in UNDAMPED])
@pytest.mark.parametrize("name", SCENES)
def test_energy_balances_and_none_is_gained(opened, name, stiffness, share):
    shape, values, end = stiff_scene(name, stiffness, share)
    values = settled(shape, values) if share == 0 else values
    totals, mechanical = [], []

    def note(fmu):
        totals.append(fmu["energy.total"])
        mechanical.append(fmu["energy.total"] - fmu["energy.dissipated"])

    run_bounded(opened, shape, values, end, 20, note)
    check_close("energy.total", totals, [totals[0]] * len(totals), EXACT)
    gained = np.diff(mechanical)
    assert np.all(gained <= EXACT), gained


@pytest.mark.parametrize("name", SCENES)
def test_the_work_does_not_follow_the_stiffness(opened, name):
    """Internal steps are far fewer than oscillations: 2 s at 1e15 N/m and 0.1 kg have 3e7 of them."""
    steps = {}
    for stiffness in (1e7, 1e15):
        shape, values, end = stiff_scene(name, stiffness, SHARE)
        steps[stiffness] = run_bounded(opened, shape, values, end, 1)["solver.steps"]
    assert steps[1e15] <= 1.5 * steps[1e7] + 20, steps


# The references of the stiffness sweep: each recomputed a second way.

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
    """The stored positions are those of Radau's method and of the Taylor integrator."""
    end = StiffContact(configuration(shape, penalty, damping), shape).end(END)
    assert end.least_push > 0
    assert end.left_out < 1e-12 or penalty < COUNTABLE
    check_close("position", end.position, ROWS[shape, damping, penalty]["position"], end.left_out)


def test_the_uncertainties_stay_below_what_is_asked():
    assert len(ROWS) == 36
    assert max(row["uncertainty"] for row in ROWS.values()) < 2e-13
