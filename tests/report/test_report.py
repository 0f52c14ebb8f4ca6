"""The report tells what was measured: all rows, right errors, figures and tables that belong together."""

import dataclasses
import getpass
import itertools
import json
import platform
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from contact_fmus.__main__ import main
from contact_fmus.bench import problems
from contact_fmus.bench.problems import ABSOLUTE, CVODE, METHODS, SETS, STIFF_TOLERANCE, TURNING, Setting
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.host import HostTimeout, run_host
from contact_fmus.pages import FORMULA, Table, plain, typeset, write_pages
from contact_fmus.report import measure
from contact_fmus.report import page as report_page
from contact_fmus.report.measure import (
    PEER,
    QUICK,
    RELATIVE_TOLERANCE,
    Row,
    read_rows,
    stiff_setting,
    write_rows,
)
from contact_fmus.stability.motions import LAWS
from contact_fmus.stability.page import WORDS as ATLAS
from contact_fmus.stability.scenes import FAMILIES
from support.programs import PATIENCE, finished
from support.sources import ROOT

PROBLEMS = {name: x for _, make in SETS.values() for name, x in make().items() if name not in QUICK.without}
FIGURES, STEPS = [*SETS, "stiffness"], QUICK.communication_steps


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """What `scripts/report.sh --quick` leaves, less set-up, build, optional parts and repeated long runs"""
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measure, "QUICK", dataclasses.replace(QUICK, limit=PATIENCE, budget=1e-3))
        assert measure.main(["--quick", "--output", str(folder)]) == 0
    assert report_page.main(["--output", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def rows(report):
    return read_rows(report / "results.csv")


def key_of(row):
    return row.problem, row.solver, row.setting, row.parameter, row.communication_steps


def test_there_is_a_row_for_everything_asked_for(rows):
    wanted = [*itertools.product(PROBLEMS, METHODS, [RELATIVE_TOLERANCE], QUICK.tolerances, STEPS)]
    for name, family in problems.stiff_families().items():
        factors = [one.penalty_factor for one in family if one.penalty_factor in QUICK.penalty_factors]
        wanted += itertools.product([name], METHODS, [stiff_setting(STIFF_TOLERANCE)], factors, STEPS)
    assert sorted(map(key_of, rows)) == sorted(wanted)


def test_every_row_is_measured(rows):
    for row in rows:
        good = PROBLEMS[row.problem].uncertainty if row.problem in PROBLEMS else 0.0
        note = f"the reference is good to {good:.0e} m" if row.measured and row.error_m < good else ""
        assert row.measured and row.note == note, row
        assert 0 < row.time_min_s <= row.time_s, row
        assert row.onsets >= 1, row


def test_a_run_that_takes_too_long_ends_its_ladder(opened, monkeypatch):
    """CVODE's runs are said to take too long, however quick the machine is."""

    def hurried(cases, *arguments, **options):
        if any("cvode" in str(case.start["solver.method"]) for case in cases):
            raise HostTimeout("too long")
        return run_host(cases, *arguments, **options | {"timeout": None})

    monkeypatch.setattr(measure, "run_host", hurried)
    plan = dataclasses.replace(QUICK, limit=0.1, budget=PATIENCE)
    family = problems.stiff_families()["stiff cylinder, undamped"]
    slow = [Setting(one, "cvode_bdf", 1e-9, 1) for one in family if one.penalty_factor >= 1e7]
    quick = [Setting(problems.benchmarks()["P2"], "event_driven", 1e-9, 1)]
    rows = [measure.row_of(*pair) for pair in measure.run_ladders([slow, quick], plan).items()]
    assert rows[0].note == "not done after 0.1 s"
    assert {row.note for row in rows[1:-1]} == {f"not run: {rows[0].note} at 1e-09, p_n = 1e+07 N/m"}
    assert not any(row.measured for row in rows[:-1])
    assert rows[-1].measured and rows[-1].problem == "P2"


def test_tight_runs_are_near_the_reference_and_count_the_contacts(rows):
    contacts = {"P1": 8, "P2": 2, "P3": 1, "P3b": 63}
    contacts |= {"P1 plane": 8, "P2 plane": 3, "P1 rim": 3, "P2 rim": 2, "P3 rim": 1, "P3b rim": 69}
    contacts |= {"P1 Hertz": 8, "P2 Hertz": 2, "P3 Hertz": 1, "P3b Hertz": 123}
    contacts |= {one["name"]: one["onsets"] for one in json.loads(TURNING.read_text(encoding="utf-8"))}
    contacts |= {"cradle": 4, "cradle Hertz": 4, "skew": 1, "skew friction": 1, "rollers": 1, "torus": 1}
    tight = [row for row in rows if (row.setting, row.parameter) == (RELATIVE_TOLERANCE, 1e-10)]
    assert len(tight) == len(contacts) * len(METHODS) * len(QUICK.communication_steps)
    for row in tight:
        assert row.error_m <= 1e-8, row
        assert row.onsets == contacts[row.problem], row


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", PROBLEMS)
def test_the_errors_are_those_of_runs_with_fmpy(rows, name, method, steps):
    problem = PROBLEMS[name]
    loosest = QUICK.tolerances[0]
    tolerances = {"solver.relative_tolerance": loosest, "solver.absolute_tolerance": ABSOLUTE * loosest}
    with ContactFmu(problems.runnable(problem.fmu)) as fmu:
        fmu.start({**problem.start, **tolerances, "solver.method": method})
        for k in range(steps):
            fmu.step(problem.stop * ((k + 1) / steps) - fmu.time)
        places = np.hstack([fmu[f"{body}.position"] for body in problem.bodies])
    error = np.linalg.norm(places - problem.position)
    key = (name, method, RELATIVE_TOLERANCE, loosest, steps)
    row = next(row for row in rows if key_of(row) == key)
    assert f"{error:.3g}" == f"{row.error_m:.3g}"


def test_figures_exist_and_are_pictures(report):
    for name in FIGURES:
        assert (report / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert len(etree.fromstring((report / f"{name}.svg").read_bytes()).findall(".//{*}path")) > 50


def test_the_page_stands_alone(report):
    page = etree.HTML((report / "index.html").read_text(encoding="utf-8"))
    images = page.xpath("//img/@src")
    assert len(images) == len(FIGURES)
    assert all(source.startswith("data:image/svg+xml;base64,") for source in images)
    assert page.xpath("//link | //script | //iframe") == []
    for table in page.xpath("//table[tr/th]"):
        assert {len(row.xpath("td")) for row in table.xpath("tr[td]")} == {len(table.xpath("tr/th"))}


def test_the_readme_shows_the_figures_and_the_same_tables(report):
    text = (report / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"!\[[^\]]+\]\((\w+\.png)\)", text) == [f"{name}.png" for name in FIGURES]
    tables = re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)
    for table in tables:
        assert len({line.count("|") for line in table.splitlines()}) == 1, table
    page = etree.HTML((report / "index.html").read_text(encoding="utf-8"))
    assert len(tables) == len(page.xpath("//table"))


def test_the_ratio_is_that_of_runs_that_are_good_enough(report):
    entries = json.loads((report / "summary.json").read_text(encoding="utf-8"))["ratios"]
    keys = [(one["problem"], one["communication_steps"], one["cvode_reaches_m"]) for one in entries]
    assert keys == list(itertools.product(problems.benchmarks(), QUICK.communication_steps, (1e-7, 1e-9)))
    for entry in entries:
        ours, theirs = entry["event_driven"], entry["cvode"]
        assert ours["solver"] == "event_driven" and ours["error_m"] <= 1e-9
        assert theirs["solver"] in CVODE and theirs["error_m"] <= entry["cvode_reaches_m"]
        assert entry["ratio"] == pytest.approx(theirs["time_s"] / ours["time_s"])


def test_versions_are_told_and_no_names(report):
    text = "".join((report / name).read_text(encoding="utf-8") for name in ("README.md", "summary.json"))
    versions = json.loads((report / "summary.json").read_text(encoding="utf-8"))["versions"]
    assert re.match(r"\d+\.\d+", versions["SUNDIALS"])
    assert {"processor", "compiler", "fmpy", "FMUs"} <= versions.keys()
    assert not re.search(rf"\b{re.escape(platform.node())}\b", text)
    assert str(Path.home()) not in text and str(ROOT) not in text
    assert getpass.getuser() == "root" or getpass.getuser() not in text


@pytest.fixture
def with_parts(report, tmp_path):
    for file in report.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    peer = Row("P1", PEER, "other, method", "similar", "step size in s", 1e-3, None, 0.5, 0.4, 1e-4, None)
    unable = Row("P3", PEER, "other, method", "similar", note="no hollow one")
    write_rows(tmp_path / "peers.csv", [peer, dataclasses.replace(peer, time_s=2.5, error_m=1e-6), unable])
    (tmp_path / "peers.json").write_text('{"versions": {"other": "4.5.6"}}')
    figure = {"name": "stiffness", "caption": "A picture"}
    table = {"caption": "Its table", "header": ["a", "b"], "rows": [["x|y", 1.23456789], ["z", "any"]]}
    section = {"title": "Of its own", "paragraphs": ["Words <b>."], "tables": [table], "figures": [figure]}
    (tmp_path / "force_element.json").write_text(json.dumps({"data": [1], "sections": [section]}))
    return tmp_path


def test_optional_parts_are_shown_when_they_are_there(with_parts):
    assert report_page.main(["--output", str(with_parts)]) == 0
    html = (with_parts / "index.html").read_text(encoding="utf-8")
    text = (with_parts / "README.md").read_text(encoding="utf-8")
    assert html.count("<img ") == len(FIGURES) + 1 + 1  # of the report, of the peers, of the section
    assert "Words &lt;b&gt;." in html and "Words <b>." in text
    assert "| x\\|y | 1.235 |" in text
    for page in (html, text):
        assert "Of its own" in page and "4.5.6" in page
    assert "| other, method | similar | – | – | – | – | – | 1.0e-06 |" not in text
    assert "| other, method | similar | – | 2.50 s | – | – | – | 1.0e-06 |" in text


def test_a_part_measured_by_itself_leaves_the_others_alone(with_parts, monkeypatch, rows):
    plan = dataclasses.replace(QUICK, tolerances=[1e-6], communication_steps=[1], limit=PATIENCE)
    monkeypatch.setattr(measure, "QUICK", plan)
    asked = ["--quick", "--only", "pairs", "--note", "It rained", "--output", str(with_parts)]
    assert measure.main(asked) == report_page.main(asked[-2:]) == 0
    found, pairs = read_rows(with_parts / "results.csv"), SETS["pairs"][1]()
    alone, before = ([row for row in some if row.problem not in pairs] for some in (found, rows))
    assert alone == before and len(found) == len(alone) + len(pairs) * len(METHODS)
    text = (with_parts / "README.md").read_text(encoding="utf-8")
    assert text.count("measure --only pairs. It rained. A quick run") == text.count("Measured by itself") == 1


def test_a_part_that_is_wrong_is_refused(with_parts, capsys):
    (with_parts / "stiffness.png").unlink()
    (with_parts / "force_element.json").write_text(
        json.dumps({"sections": [{"title": "T", "figures": [{"name": "nowhere", "caption": ""}]}]})
    )
    assert main(["page", "--output", str(with_parts)]) == 2
    assert "section 'T' shows" in capsys.readouterr().err
    (with_parts / "peers.csv").write_text("problem,time\nP1,3\n")
    with pytest.raises(ValueError, match="the columns are"):
        report_page.main(["--output", str(with_parts)])


def test_rows_survive_their_file(tmp_path):
    row = Row("P1", PEER, "a, b", "same", "step", 1e-3, None, 0.1234, 0.1, 1.23e-9, 8, 'says "no"')
    empty = Row("P1", PEER, "a", "same", "step", None, None, None, None, None, None, "never done")
    write_rows(tmp_path / "rows.csv", [row, empty])
    assert (tmp_path / "rows.csv").read_text().splitlines()[0] == ",".join(measure.COLUMNS)
    assert read_rows(tmp_path / "rows.csv") == [row, empty]


def test_measuring_without_a_host_says_what_to_do(tmp_path):
    command = [sys.executable, "-m", "contact_fmus", "measure", "--quick", "--output", tmp_path]
    run = finished(command, env={"PYTHONPATH": str(ROOT / "scripts"), "CONTACT_BUILD": str(tmp_path)})
    assert run.returncode == 2
    assert "fmu_host does not exist: build it first" in run.stderr and "Traceback" not in run.stderr


# What all pages share: formulas typeset or plain, tables that fit a small screen

WORDS = [file.read_text(encoding="utf-8") for file in sorted((ROOT / "scripts/scenarios").glob("*.toml"))]
WORDS += [*ATLAS["LIMITS"], *ATLAS["AXES"].values()]


def test_names_are_slanted_and_have_their_indices_below():
    assert typeset("lasts $pi sqrt(m/p_n)$, <whatever>") == (
        "lasts <i>π</i> √(<i>m</i>/<i>p</i><sub>n</sub>), &lt;whatever&gt;"
    )


def test_powers_and_signs():
    assert typeset("$x^2 - 2 (a < b) <= delta^(3/2)$") == (
        "<i>x</i><sup>2</sup> − 2 (<i>a</i> &lt; <i>b</i>) ≤ <i>δ</i><sup>(3/2)</sup>"
    )


def test_what_is_no_formula_stays_and_is_escaped():
    assert typeset("a < b & c_d, 5 $") == "a &lt; b &amp; c_d, 5 $"


def test_plain_text_has_no_dollar():
    assert plain("lasts $pi sqrt(m/p_n)$ at $tau_n <= 2$") == "lasts π √(m/p_n) at τ_n ≤ 2"


@pytest.mark.parametrize("words", WORDS, ids=range(len(WORDS)))
def test_nothing_of_a_formula_is_left_as_it_is_written(words):
    shown = [plain(f"${formula}$") for formula in FORMULA.findall(words)]
    assert not [one for one in shown if "sqrt" in one or "<=" in one]
    marked = [str(typeset(f"${formula}$")) for formula in FORMULA.findall(words)]
    assert not [one for one in marked if "^" in one or "_" in one]


def test_every_axis_and_law_of_the_atlas_is_explained():
    assert set(ATLAS["AXES"]) == {family.name for family in FAMILIES}
    assert set(ATLAS["LAWS"]) == set(LAWS)


def test_cells_say_their_column_where_there_is_no_header(tmp_path):
    """Below 40rem a row is a card: what stands before a value comes from its cell."""
    templates = tmp_path / "templates"
    templates.mkdir()
    text = "{% extends 'base.html' %}{% from 'parts.html' import show_table %}"
    text += "{% block body %}{{ show_table(table) }}{% endblock %}"
    (templates / "page.html").write_text(text)
    table = Table("Times", ["solver", "time, s"], [["one", "1.5"], ["two", "2.5"]])
    (page,) = write_pages(templates, tmp_path, {"table": table}, {"page.html": "index.html"})
    found = etree.HTML(Path(page).read_text(encoding="utf-8"))
    assert found.xpath("//td/@data-label") == ["solver", "time, s"] * 2
    style = found.xpath("string(//style)")
    assert "prefers-color-scheme: dark" in style and "attr(data-label)" in style
