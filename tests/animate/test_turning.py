"""Bodies that turn are seen to turn: by their stripes."""

import numpy as np


def pictures(page, times):
    """What the page shows at these times."""
    found = []
    for time in times:
        page.run(f"contactAnimation.seek({time})")
        page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        found.append(page.picture().astype(int))
    return found


def changed(one, other):
    """Part of the pixels that differ by more than shading does."""
    return float(np.mean(np.max(np.abs(one - other), axis=2) > 24))


def test_a_table_that_turns_is_seen_to_turn(opened):
    """By an eighth of a turn light and dark change places; by a quarter they are where they were."""
    table = opened("Turntable", width=700, height=500)
    eighth = np.pi / 4 / 3.0
    first, turned, again = pictures(table, (0.0, eighth, 2 * eighth))
    assert changed(first, turned) > 0.2
    assert changed(first, again) < 0.5 * changed(first, turned)


def test_a_floor_that_stands_still_keeps_its_looks(opened):
    """The ball alone moves over it, and turns."""
    floor = opened("SpinningBall", width=700, height=500)
    first, later = pictures(floor, (0.0, 0.1))
    assert 0.0 < changed(first, later) < 0.2
