"""What a page shows is told apart: names, shadows, colours, labels of axes, and stripes of what turns."""

import json

import numpy as np
import pytest

from contact_fmus.__main__ import main
from support.pinhole import Camera

NAMES = """(() => {
  const overlay = contactAnimation.overlay, write = overlay.write, places = {};
  overlay.write = (text, x, y) => (places[text] = [x, y]);
  overlay.draw();
  overlay.write = write;
  return places;
})()"""
# Of each chart: its title, the limits of its axis and the labels of its ticks
AXES = """(() => {
  const pen = CanvasRenderingContext2D.prototype, fill = pen.fillText;
  const found = contactPlot.all.map((chart) => {
    const labels = [];
    pen.fillText = function (text) {
      if (this.textAlign === "right" && !text.includes("[")) labels.push(text);
    };
    chart.draw();
    return { limits: chart.limits, bent: chart.bent, labels };
  });
  pen.fillText = fill;
  return found;
})()"""
FRAME = 16  # pixels that the edge and the round corners of the picture take
STILL = "getComputedStyle(document.documentElement).getPropertyValue('--still').trim()"


def covered(page, body):
    """Where the body alone is, as a picture of true and false"""
    page.run(f"contactAnimation.drawFlat({json.dumps([body])})")
    found = page.stage()[:, :, 0] > 127
    page.run("contactAnimation.drawAgain()")
    inner = np.zeros_like(found)
    inner[FRAME:-FRAME, FRAME:-FRAME] = True
    return found & inner


@pytest.mark.parametrize("view", ["fit", "x y"])
def test_the_name_of_a_plane_stands_on_it(view, opened):
    page = opened("SpherePlane", width=900, height=800)
    page.run(
        f"[...document.querySelectorAll('.views button')].find((one) => one.textContent === '{view}').click()"
    )
    page.wait_for(f"'destination' in {NAMES}")  # a busy browser may not have drawn yet
    x, y = page.run(NAMES)["destination"]
    assert covered(page, "destination")[int(y), int(x)]


def test_a_shadow_lies_below_the_ball(opened):
    page = opened("SpherePlane", width=900, height=800)
    page.run("document.querySelector('[data-is=trails]').click(); contactAnimation.seek(0.2)")
    camera, picture = Camera(page.run("contactAnimation.camera()")), page.stage()
    light = []
    for x in (0.05, 0.3):  # m beside what is below the middle of the ball; its radius is 0.1 m
        column, row = camera.project(np.array([x, 0.03, 0.0]))[0]
        light.append(np.sum(picture[int(row) - 1 : int(row) + 2, int(column) - 1 : int(column) + 2]))
    assert light[0] < 0.9 * light[1]


@pytest.mark.parametrize("case", ["SphereCylinder", "ForceElement"])
def test_an_infinite_cylinder_leaves_room_in_the_picture(case, opened):
    cylinder = covered(opened(case, width=1200, height=800), "destination")
    assert 0.05 < np.mean(cylinder) < 0.5
    assert not cylinder[:, FRAME].any() and not cylinder[:, -FRAME - 1].any()


def test_bodies_that_could_move_have_colours_of_their_own(opened):
    page = opened("ForceElement", width=900, height=700)
    colors = page.run(
        "contactAnimation.world.bodies.map((one) => '#' + one.materials[0].color.getHexString())"
    )
    assert len({*colors, page.run(STILL)}) == 3
    still = opened("SphereCylinder", width=900, height=700)
    of_floor = still.run("'#' + contactAnimation.world.bodies[1].materials[0].color.getHexString()")
    assert of_floor == still.run(STILL)


def test_what_turns_and_rubs_has_charts_and_energies_differ_in_colour(opened):
    page = opened("GolfersDilemma", width=900, height=700)
    titles = page.run("[...document.querySelectorAll('figcaption b')].map((one) => one.textContent)")
    for wanted in ("angular velocity of source [rad/s]", "friction force, size", "slip velocity, size"):
        assert [title for title in titles if title.startswith(wanted)] != [], titles
    looks = "[...document.querySelectorAll('.chart:last-child .legend i')].map((one) => one.style.borderTop)"
    energies = page.run(looks)
    assert len(set(energies)) == len(energies) >= 6
    assert "friction" not in " ".join(
        opened("BallInShell").run("[...document.querySelectorAll('b')].map((one) => one.textContent)")
    )


@pytest.mark.parametrize("case", ["GolfersDilemma", "Turntable", "SpinningBall", "Bowling"])
def test_an_axis_shows_no_rounding_and_its_labels_differ(case, shown, tmp_path):
    file = tmp_path / "plot.html"
    assert main(["plot", case, "-o", str(file)]) == 0
    page = shown(file, "!!window.contactPlot", width=900, height=900)
    axes = page.run(AXES)
    assert len(axes) >= 4
    for axis in axes:
        low, high = axis["limits"]
        assert high - low >= 1e-6 * max(abs(low), abs(high))
        assert len(set(axis["labels"])) == len(axis["labels"]) >= 2
    page.run("contactPlot.setRange(contactPlot.whole[1] * 0.5, contactPlot.whole[1] * 0.5003)")
    assert all(len(set(axis["labels"])) == len(axis["labels"]) for axis in page.run(AXES))


def pictures(page, times):
    """What the page shows at these times"""
    found = []
    for time in times:
        page.drawn(time)
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
