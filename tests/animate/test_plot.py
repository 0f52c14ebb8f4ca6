"""`plot`: what is drawn of any scene"""

import json
import re

import numpy as np
import pytest
from PIL import Image

from contact_fmus.__main__ import main
from contact_fmus.plot.panels import Touch, chosen, together, touches, usual
from contact_fmus.plot.path import outline
from contact_fmus.plot.source import motion_of, open_runs
from contact_fmus.results import Result


@pytest.fixture(scope="module")
def shell():
    return open_runs("BallInShell", (), None)[0].result


def test_every_contact_of_a_run_is_found_and_shown(shell):
    """Against the count that the FMU itself reports, and with points inside each"""
    found = touches(shell)
    assert len(found) == shell.columns["contact.onsets"][-1] > 10
    for touch in found:
        inside = (shell.time > touch.begin) & (shell.time < touch.end)
        assert np.count_nonzero(inside) >= 5
        assert np.all(shell.columns["contact.gap"][inside] < 0.0)


def test_a_contact_between_prescribed_motions_is_read_from_the_gap():
    time = np.linspace(0.0, 1.0, 11)
    found = touches(Result(time, {"c.gap": 0.35 - time, "d.gap": np.abs(time - 0.5) - 0.25}))
    assert [(t.contact, t.begin, t.end) for t in found] == [
        ("d", pytest.approx(0.25), pytest.approx(0.75)),
        ("c", pytest.approx(0.35), 1.0),
    ]
    later = Touch("d", 1.5, 2.0)
    assert together([*found, later]) == [(found[0].begin, 1.0), (1.5, 2.0)]
    assert together([Touch("c", 0.0, 3.0), later]) == [(0.0, 3.0)]


def test_a_torus_that_is_seen_along_its_axis_is_a_ring():
    motion = motion_of(open_runs("grooved_bearing", (), None)[0].result)
    ring = outline(motion, "outer", 0, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), {})
    assert ring.get_radii() == pytest.approx((0.025, 0.025)) and ring.get_width() == pytest.approx(0.0104)


def test_a_result_file_is_drawn_as_the_run_it_came_from(shell, tmp_path):
    shell.write_csv(tmp_path / "run.csv")
    again = open_runs(str(tmp_path / "run.csv"), (), None)[0].result
    assert touches(again) == touches(shell)
    there, here = motion_of(again), motion_of(shell)
    for body in ("source", "destination"):
        assert np.array_equal(there.position(body), here.position(body))
        assert (there.radius(body), there.is_hollow(body)) == (here.radius(body), here.is_hollow(body))


def test_a_scene_of_any_names_has_its_panels(built):
    runs = open_runs(str(built["ThreeBalls"]), (), None)
    panels = {panel.title: [line.label for line in panel.lines] for panel in usual(runs[0].result)}
    assert panels["gap"] == panels["normal force"] == ["first", "second"]
    assert panels["position, x"] == ["left", "middle", "right"]
    assert panels["energy"] == ["kinetic", "stored in contact", "total"]
    motion = motion_of(runs[0].result)
    assert [motion.moves(body) for body in ("left", "middle", "right")] == [True, True, True]


def test_an_energy_that_is_rounding_has_no_line():
    time = np.linspace(0.0, 1.0, 11)
    columns = {"contact.gap": time, "contact.normal_force": 0.0 * time, "energy.kinetic": 1.0 - time}
    columns |= {"energy.contact": 1e-9 * time, "energy.dissipated": 1e-20 * time}
    panels = {panel.title: [line.label for line in panel.lines] for panel in usual(Result(time, columns))}
    assert panels["energy"] == ["kinetic", "stored in contact"]


@pytest.mark.parametrize("patterns, names", [
    (["contact.gap"], ["contact.gap"]),
    (["source.position"], ["source.position[1]", "source.position[2]", "source.position[3]"]),
    (["source.position[3]"], ["source.position[3]"]),
    (["energy.k*", "*.gap"], ["energy.kinetic", "contact.gap"]),
])  # fmt: skip
def test_variables_are_chosen_by_name_vector_or_pattern(shell, patterns, names):
    assert [line.name for panel in chosen(shell, patterns) for line in panel.lines] == names


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf", "html"])
def test_each_format_is_written_and_the_same_twice(suffix, tmp_path):
    files = [tmp_path / f"{name}.{suffix}" for name in "ab"]
    for file in files:
        assert main(["plot", "free_pair", "-o", str(file)]) == 0
    assert files[0].read_bytes() == files[1].read_bytes()
    if suffix == "png":
        assert np.std(np.array(Image.open(files[0]).convert("L"))) > 10


def test_the_page_draws_and_zooms(shown, tmp_path):
    file = tmp_path / "plot.html"
    assert main(["plot", "BallInShell", "-o", str(file)]) == 0
    page = shown(file, "!!window.contactPlot", width=800, height=900)
    page.run("contactPlot.setCursor(0.3032)")
    values = page.run("[...document.querySelectorAll('output')].map((one) => one.value)")
    assert values[0].startswith("−2.3")  # mm, the gap of the scenario's page
    x, y = page.run(
        "(r => [r.left + 0.5 * r.width, r.top + 60])(document.querySelector('.plot').getBoundingClientRect())"
    )
    page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-400)
    page.wait_for("contactPlot.all[0].range[1] - contactPlot.all[0].range[0] < 2")


def test_a_result_needs_its_fmu_for_an_animation(shell, tmp_path, capsys):
    file = tmp_path / "run.csv"
    Result(shell.time, shell.columns).write_csv(file)
    assert main(["animate", str(file), "-o", str(tmp_path / "a.html")]) == 2
    assert "name it by --fmu" in capsys.readouterr().err
    assert main(["animate", str(file), "--fmu", str(shell.fmu), "-o", str(tmp_path / "a.html")]) == 0
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)[1])
    assert [body["name"] for body in data["bodies"]] == ["source", "destination"]
    assert len(data["touches"]) == shell.columns["contact.onsets"][-1]


def test_a_picture_alone_shows_contacts_shorter_than_a_step_in_full(tmp_path, monkeypatch):
    """Each reaches the largest force that the FMU tells of it and of those after it, which are weaker."""
    drawn = []
    monkeypatch.setattr("contact_fmus.plot.command.draw", lambda result, file: drawn.append(result))
    for options in ([], ["--csv", str(tmp_path / "run.csv")]):
        assert main(["run", "BouncingBall", "--plot", str(tmp_path / "run.png"), *options]) == 0
    whole, table = drawn
    assert len(table.time) < 500 < len(whole.time)
    force = whole.columns["contact.normal_force"]
    for touch in touches(whole):
        inside = (whole.time >= touch.begin) & (whole.time <= touch.end)
        told = whole.columns["contact.peak_force"][whole.time > touch.begin].max()
        assert force[inside].max() > 0.98 * told


@pytest.mark.parametrize("suffix", ["png", "html"])
def test_a_run_draws_what_it_found(suffix, tmp_path):
    file = tmp_path / f"run.{suffix}"
    assert main(["run", "SphereSphere", "--stop", "0.5", "--plot", str(file)]) == 0
    assert file.stat().st_size > 10_000
