"""The path of a new user: the wheel in an environment of its own, far from any clone, and a scene from
`new` to an animation, by FMI 3.0 (test_wheel.py has FMI 2.0). What the user sees is photographed, frame by
frame; the environment variable CONTACT_SCREENSHOTS names a folder that keeps the pictures."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from contact_fmus import Result
from support.browser import Browser

FRAMES = 8  # over the whole run
BALL = """(() => {
  const ball = contactAnimation.world.bodies.find((one) => one.moves);
  const at = contactAnimation.project(ball.name);
  const stage = document.querySelector('.stage').getBoundingClientRect();
  return [stage.left + at.x, stage.top + at.y, 0.6 * contactAnimation.world.pixelRadius(ball)];
})()"""


def photographs(page, times, folder, name):
    """A picture at each time, kept in the folder too, and where its ball is: column, row, part of a radius"""
    found = []
    for number, time in enumerate(times):
        page.drawn(time)
        (folder / f"{name}_{number:02}.png").write_bytes(page.png())
        found.append((page.picture().astype(int), page.run(BALL)))
    return found


@pytest.fixture
def folder(tmp_path):
    kept = Path(os.environ.get("CONTACT_SCREENSHOTS", tmp_path / "screenshots"))
    kept.mkdir(parents=True, exist_ok=True)
    return kept


def test_from_a_new_scene_to_its_animation(command, folder, tmp_path):
    assert command("new", "Mine", "--shape", "plane").returncode == 0
    built = command("build", "Mine.toml", "--fmi", "3", XDG_CACHE_HOME=str(tmp_path / "cache"))
    assert built.returncode == 0, built.stderr
    run = command("run", "Mine.fmu", "--csv", "mine.csv", "--json")
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout)["values"]["contact.onsets"] >= 2
    for output in ("mine.png", "mine.html"):
        drawn = command("plot", "Mine.fmu", "-o", output)
        assert (drawn.returncode, drawn.stderr) == (0, "")
    assert np.std(np.array(Image.open(tmp_path / "mine.png").convert("L"))) > 10
    (folder / "plot.png").write_bytes((tmp_path / "mine.png").read_bytes())
    animated = command("animate", "Mine.fmu", "-o", "film.html")
    assert (animated.returncode, animated.stderr) == (0, "")

    result = Result.read(tmp_path / "mine.csv")
    inside = np.flatnonzero(result.columns["contact.active"])
    touch = float(result.time[inside[np.argmax(result.columns["contact.normal_force"][inside])]])
    with Browser() as browser:
        page = browser.open(tmp_path / "film.html", width=900, height=760)
        page.wait_for("window.contactAnimation && contactAnimation.frames > 1")
        begin, end = result.time[[0, -1]]
        frames = photographs(page, np.linspace(begin, end, FRAMES), folder, "film")
        (seen,) = photographs(page, [touch], folder, "touch")
        assert page.run("contactAnimation.world.contacts[0].forces.some((one) => one.arrow.arrow.visible)")
        assert (page.complaints, page.requests) == ([], [])
        charts = browser.open(tmp_path / "mine.html", width=900, height=900)
        charts.wait_for("!!window.contactPlot")
        (folder / "charts.png").write_bytes(charts.png())
        assert (charts.complaints, charts.requests) == ([], [])
    # The ball is blue where it should be, and it moves from picture to picture.
    for picture, (column, row, radius) in [*frames, seen]:
        red, _, blue = picture[int(row), int(column + radius)]
        assert blue > red + 40
    places = [place[1] for _, place in frames]
    assert len({round(place) for place in places}) > FRAMES / 2
