"""A fast part of the atlas: event_driven is right everywhere, CVODE wherever it ends; the page tells it"""

import csv
import math
import re
from collections import Counter
from dataclasses import replace
from operator import attrgetter

import pytest
from lxml import etree

from contact_fmus.stability import command
from contact_fmus.stability import run as runs
from contact_fmus.stability.command import QUICK
from contact_fmus.stability.motions import HeadOn, Rolling, Similar, Units, bases
from contact_fmus.stability.page import draw_page, groups, write_csv
from contact_fmus.stability.scenes import FAMILIES, Scene, all_scenes

CVODE = runs.METHODS[1:]
# What the page names as limits of CVODE: the depth of an impact below its tolerance, flights it does not see.
NAMED = ("mass ratio", "jump", "all at once")

HELD = ("tumbling rate",)  # neither body can move, and there is no momentum to speak of


@pytest.fixture(scope="module")
def scenes():
    return all_scenes()


@pytest.fixture(scope="module")
def rows(scenes):
    """A third of what `scripts/stability.sh --quick` runs"""
    return [row for _, found in runs.run_all(runs.thinned(scenes, QUICK), 2) for row in found]


@pytest.mark.parametrize("family", [family.name for family in FAMILIES])
def test_event_driven_is_right(rows, family):
    own = [row for row in rows if row.family == family and row.method == "event_driven"]
    assert len(own) >= 4
    told = attrgetter("wrong", "status", "message", "value", "geometry", "law", "note", "communication_steps")
    assert [told(row) for row in runs.not_right(own, "event_driven")] == []
    for row in own:
        assert math.isfinite(row.error), row
        assert math.isfinite(row.balance), row
        assert math.isfinite(row.momentum) != (family in HELD), row


def test_the_last_line_names_the_methods(rows):
    few = [
        replace(row, wrong="energy" if row.method == "cvode_bdf" else "", status="ok")
        for row in rows[: 4 * len(runs.METHODS)]
    ]
    assert command.ending(few) == "12 runs, 4 wrong (cvode_bdf 4), 0 refused"


def test_a_run_that_did_not_come_to_its_end_is_not_right():
    """Figures of nothing are never wrong: the status has to be asked for."""
    scene = Scene("damping", 0.2, HeadOn(ratio=0.2))
    right = runs.run_scene(scene, ("event_driven",))
    assert runs.not_right(right, "event_driven") == []
    for status in ("refused", "discarded", "error"):
        outcome = runs.Outcome(status=status, message="fmi2DoStep failed with status 3 (error).")
        row = runs.row_of(scene, "event_driven", 1, outcome, runs.Figures())
        assert row.wrong == "" and runs.not_right([*right, row], "event_driven") == [row]


def test_the_check_fails_where_a_run_did_not_come_to_its_end(monkeypatch, tmp_path, capsys):
    rows = runs.run_scene(Scene("damping", 0.2, HeadOn(ratio=0.2)), ("event_driven",))
    monkeypatch.setattr(command, "_measured", lambda options: rows)
    monkeypatch.setattr(command, "draw_page", lambda *_: [])
    assert command.main(["--check", "--output", str(tmp_path)]) == 0
    rows[0].status = "error"
    assert command.main(["--output", str(tmp_path)]) == 0
    assert command.main(["--check", "--output", str(tmp_path)]) == 1
    assert "not right: damping" in capsys.readouterr().out


@pytest.mark.parametrize("method", CVODE)
def test_cvode_is_right_where_it_ends(rows, method):
    wrong = [
        (row.wrong, row.family, row.value, row.geometry, row.law, row.note, row.communication_steps)
        for row in rows
        if row.method == method and row.wrong and row.family not in NAMED
    ]
    assert wrong == []
    ended = [row for row in rows if row.method == method and row.status == "ok"]
    assert all(math.isfinite(row.error) and math.isfinite(row.balance) for row in ended)


@pytest.mark.parametrize("method", CVODE)
def test_cvode_refuses_at_its_work_limit_and_nowhere_else(rows, method):
    refused = [row for row in rows if row.method == method and row.status != "ok"]
    assert {row.status for row in refused} == {"discarded"}
    assert all("solver.max_internal_steps" in row.message for row in refused)
    ended = sum(row.status == "ok" for row in rows if row.method == method)
    assert ended > 5 * len(refused) > 0


def test_the_full_atlas_has_5000_scenes_for_each_method(scenes):
    assert sum(len(scene.steps) for scene in scenes) >= 5000
    assert len({(scene.name, scene.motion, scene.steps) for scene in scenes}) == len(scenes)
    assert Counter(scene.family for scene in scenes).keys() == {family.name for family in FAMILIES}


SPANS = {
    "stiffness": (1.0, 1e15), "mass": (1e-9, 1e9), "mass ratio": (1e-12, 1e12), "size": (1e-9, 1e6),
    "radius ratio": (1.0, 1e9), "clearance": (1e-12, 0.1), "speed": (0.0, 1e6), "damping": (0.0, 1e4),
    "communication step": (1e-9, 1e3), "offset": (0.0, 1e9), "plane": (1.0, 1e15), "modulus": (1e5, 1e13),
    "over the edge": (0.0, 1.0), "edge-on impact": (1e-6, 1e6), "restitution": (0.0, 1.0),
    "exponent": (1.0, 1.5), "slip velocity": (1e-12, 10.0), "friction": (1e-9, 1e6), "spin": (0.0, 1e6),
    "inertia ratio": (1e-9, 1e9), "tumbling rate": (1e-6, 1e6),
}  # fmt: skip


def test_the_declared_ranges_are_swept(scenes):
    def span(family):
        own = [scene.value for scene in scenes if scene.family == family]
        return min(own), max(own)

    assert {family: span(family) for family in SPANS} == SPANS
    assert span("force")[1] == 1e12
    sizes = [s.motion.end / n for s in scenes for n in s.steps if s.family == "communication step"]
    assert math.isclose(min(sizes), 1e-9) and math.isclose(max(sizes), 1e3)


def test_other_units_give_the_same_bits():
    """event_driven: nothing in it knows a metre, a kilogram or a second."""
    units = [Units(), Units(length=-30), Units(mass=20), Units(time=-20), Units(20, -20, 10)]
    for number in range(0, len(bases()), 9):
        name = bases()[number]["name"]
        scenes = [Scene("units", 0.0, Similar(number, system), steps=(3,)) for system in units]
        found = [row for scene in scenes for row in runs.run_scene(scene, runs.METHODS[:1])]
        assert [row.status for row in found] == ["ok"] * len(units), (name, [row.message for row in found])
        assert all(row.bits for row in found), name
        assert len({row.bits for row in found}) == 1, name


def test_a_wrong_answer_is_found():
    """Of each check, the least that is too much"""
    for method in runs.METHODS:
        for name, limit in runs.LIMITS[method].items():
            assert runs.Figures(**{name: 1.01 * limit}).failures(method) == [name]
            assert runs.Figures(**{name: 0.99 * limit}).failures(method) == []
        assert runs.Figures(missed=True).failures(method) == ["onsets"]
        assert runs.Figures(finite=False).failures(method) == ["finite"]


def test_a_scene_of_another_law_is_told_apart(monkeypatch):
    """The closed form of one damping against the FMU with another one"""
    scene = Scene("damping", 0.2, HeadOn(ratio=0.2))
    assert {row.wrong for row in runs.run_scene(scene)} == {""}
    expected = Scene("damping", 0.2, HeadOn(ratio=0.2001)).expected()
    monkeypatch.setattr(Scene, "expected", lambda _: expected)
    assert all("error" in row.wrong for row in runs.run_scene(scene))


def test_a_wrong_orientation_is_found(monkeypatch):
    """The closed form of one spin against the FMU with another one; the ball is where it should be"""
    scene = Scene("spin", 100.0, Rolling(spin=-100.0, end=0.1))
    assert runs.not_right(runs.run_scene(scene), "event_driven") == []
    expected = dict.fromkeys(scene.steps, replace(scene.motion.expected(), turned=-9.8))
    monkeypatch.setattr(Scene, "expected", lambda _: expected)
    assert {row.wrong for row in runs.run_scene(scene)} == {"error"}


def test_the_page_stands_alone_and_tells_every_refusal(rows, tmp_path):
    refused = sorted({row.family for row in rows if row.status != "ok"})
    few = {*refused[:4], *[family.name for family in FAMILIES[:2]]}  # a family is nine panels
    rows = [row for row in rows if row.family in few]
    assert any(row.status != "ok" for row in rows)
    write_csv(rows, tmp_path / "runs.csv")
    write_csv(groups(rows), tmp_path / "summary.csv")
    draw_page(rows, tmp_path, "A few scenes.")
    page = etree.HTML((tmp_path / "index.html").read_text(encoding="utf-8"))
    assert len(page.xpath("//img")) == 3
    assert all(source.startswith("data:image/png;base64,") for source in page.xpath("//img/@src"))
    assert page.xpath("//link | //script | //iframe") == []
    refused = page.xpath("//table[caption='Refused, by the message']/tr/td[last()]/text()")
    shown = sum(int(text.partition(" of ")[0]) for text in refused)
    assert shown == sum(row.status != "ok" and not row.wrong for row in rows)
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"!\[[^\]]+\]\((\w+\.png)\)", text) == ["error.png", "energy.png", "steps.png"]
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        assert len({line.replace("\\|", "").count("|") for line in table.splitlines()}) == 1, table
    with (tmp_path / "runs.csv").open(encoding="utf-8") as stream:
        assert len(list(csv.DictReader(stream))) == len(rows)
