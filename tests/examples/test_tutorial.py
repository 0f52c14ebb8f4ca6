"""docs/tutorial.md: every command and script of the page runs, in order, and gives what the page says"""

import csv
import os
import re
import sys
from pathlib import Path

import pytest

from support.programs import checked, environment
from support.sources import ROOT

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def changed(scene, lines):
    """The scene file with `lines` put under their headings; a line takes the place of one with its key"""
    heading = None
    for line in lines.splitlines():
        if line.startswith("["):
            heading = line
        elif line:
            key = line.split(" = ")[0]
            section = re.search(rf"^{re.escape(heading)}\n(?:(?!^\[).*\n)*", scene, re.MULTILINE)
            old = section[0]
            new, count = re.subn(rf"^{re.escape(key)} = .*$", line, old, flags=re.MULTILINE)
            scene = scene.replace(old, new if count else old.rstrip("\n") + f"\n{line}\n\n")
    return scene


@pytest.fixture(scope="module")
def said(tmp_path_factory, quick_compiler):
    """What each command line of the page printed; and the folder"""
    folder = tmp_path_factory.mktemp("tutorial")
    printed = {}
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    around = environment(PATH=path, CC=quick_compiler)
    for language, name, text in BLOCK.findall(PAGE):
        if name:
            (folder / name).write_text(text, encoding="utf-8")
        elif language == "toml":
            file = folder / "Slide.toml"
            file.write_text(changed(file.read_text(encoding="utf-8"), text), encoding="utf-8")
        elif language == "sh":
            for line in text.splitlines():
                printed[line.split()[1]] = checked(["sh", "-c", line], folder, environment=around)
    return printed, folder


def test_the_ball_rolls_with_five_sevenths_of_its_speed(said):
    printed, folder = said
    (shown,) = re.findall(r"^```\n(contact\.onsets.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    for line in shown.splitlines():
        assert line in printed["run"]
    assert "(2.14285714, 0," in printed["run"]
    assert pytest.approx(2.14285714, abs=1e-8) == 3 * 5 / 7
    assert len((folder / "slide.csv").read_text(encoding="utf-8").splitlines()) > 2000


def test_the_animation_is_one_page_without_links_to_elsewhere(said):
    page = (said[1] / "Slide.html").read_text(encoding="utf-8")
    assert "ball" in page
    assert not re.search(r'(?:src|href)="https?:', page)


def test_both_importers_get_the_same_velocity(said):
    printed, _ = said
    first = re.search(r"2\.0 s: (\S+) m/s, \S+ rad/s, (\d+) touches", printed["with_fmpy.py"])
    second = re.search(r"libcosim: (\S+) m/s after (\d+) touches", printed["with_libcosim.py"])
    assert first.groups() == second.groups()
    assert float(first[1]) > 2.5  # a coefficient of 0.02 has not yet made it roll


def test_the_sweep_has_a_row_for_each_run_and_a_picture(said):
    results = said[1] / "results" / "friction"
    with open(results / "results.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(rows) == 30
    assert {row["status"] for row in rows} == {"ok"}
    for row in rows:
        if row["ball.center[3]"] == "0.1":  # it slides from the start, at -mu g, until it rolls
            sliding = 3 - float(row["contact.friction_coefficient"]) * 9.81 * 0.5
            assert float(row["speed"]) == pytest.approx(max(sliding, 3 * 5 / 7), abs=1e-3)
    assert (results / "plot.png").stat().st_size > 10_000
