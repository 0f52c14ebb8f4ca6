"""Animations far from any clone: the wheel brings three.js, which a clone that has none makes. A user comes
from a new scene to one, by FMI 3.0 (test_wheel.py has FMI 2.0); what is seen is photographed, frame by frame,
and the environment variable CONTACT_SCREENSHOTS names a folder that keeps the pictures."""

import json
import os
import shutil
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from contact_fmus import Result
from support.browser import Browser
from support.programs import finished
from support.sources import ROOT

BUNDLE = "contact_fmus/animate/three.bundle.js"


def test_the_wheel_carries_three_js_with_its_licence(wheel):
    with zipfile.ZipFile(wheel) as archive:
        script = archive.read(BUNDLE).decode()
    version = json.loads((ROOT / "package.json").read_text())["devDependencies"]["three"]
    assert "The MIT License" in script[:1000] and "three.js authors" in script[:1000]
    assert f'"{version.split(".")[1]}"' in script  # its REVISION


def test_a_clone_without_three_js_makes_it(tmp_path):
    """Of what git tracks; npm comes from the path"""
    animate = "scripts/contact_fmus/animate"
    names = ("package.json", "package-lock.json", "scripts/build_backend.py", f"{animate}/three_parts.js")
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for told in ("made", "already installed"):
        run = finished([sys.executable, "scripts/build_backend.py"], cwd=tmp_path, check=True)
        assert run.stdout == f"three.js: {told}\n"
    made = (tmp_path / animate / "three.bundle.js").read_bytes()
    assert made == (ROOT / animate / "three.bundle.js").read_bytes()


def test_the_source_archive_carries_three_js(far_from_clone, tmp_path):
    command = [sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", tmp_path, ROOT]
    finished(command, check=True, env=far_from_clone)
    (file,) = tmp_path.glob("*.tar.gz")
    names = finished(["tar", "tzf", file], check=True).stdout
    assert f"/scripts/{BUNDLE}\n" in names and "/scripts/build_backend.py\n" in names


@pytest.mark.parametrize("command_line", [["animate", "BallInShell"], ["animate", "ball_on_plane"]])
def test_an_animation_of_the_installed_package_draws(command_line, command, tmp_path):
    run = command(*command_line, "-o", "page.html")
    assert (run.returncode, run.stderr) == (0, "")
    with Browser() as browser:
        page = browser.open(tmp_path / "page.html", width=900, height=700)
        page.wait_for("window.contactAnimation && contactAnimation.frames > 1")
        ball = page.run("contactAnimation.project('source')")
        picture = page.picture()
        assert (page.complaints, page.requests) == ([], [])
        top = page.run("document.querySelector('.stage').getBoundingClientRect().top")
        left = page.run("document.querySelector('.stage').getBoundingClientRect().left")
    # The ball has a colour where it is; what is behind it is grey.
    shown = picture[int(top + ball["y"]), int(left + ball["x"])].astype(int)
    assert np.ptp(shown) > 40


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


def test_from_a_new_scene_to_its_animation(command, tmp_path):
    folder = Path(os.environ.get("CONTACT_SCREENSHOTS", tmp_path / "screenshots"))
    folder.mkdir(parents=True, exist_ok=True)
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
