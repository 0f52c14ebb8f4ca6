"""README is short, links of all pages lead somewhere, and README shows the times that were measured"""

import csv
import re

import pytest

from support.sources import ROOT

PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md")])
LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(#[^)\s]+)?\)")
README_LINES = 130  # a user reads two screens, not six


def heading_anchors(text):
    """The anchors that a page's headings get on the usual hosts of repositories"""
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_of_a_page_leads_somewhere(page):
    for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
        file = (page.parent / target).resolve() if target else page
        assert file.exists(), f"{target} does not exist"
        if anchor:
            assert anchor[1:] in heading_anchors(file.read_text(encoding="utf-8")), f"{target}{anchor}"


def test_readme_is_two_screens():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= README_LINES


def test_every_page_is_in_the_index():
    index = ROOT / "docs" / "index.md"
    linked = {(index.parent / to).resolve() for to, _ in LINK.findall(index.read_text(encoding="utf-8"))}
    pages = {page for page in PAGES if page.is_relative_to(ROOT / "docs")} - {index}
    assert pages <= linked, f"not in docs/index.md: {sorted(map(str, pages - linked))}"


def seconds(text):
    number, unit = text.split()
    return float(number) * {"s": 1.0, "ms": 1e-3, "µs": 1e-6}[unit]


def test_readme_shows_the_times_that_the_report_measured():
    """Of P3b: the least time in which each solver reaches 1e-9 m, both sides at the same error"""
    with open(ROOT / "docs" / "report" / "results.csv", encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["problem"] == "P3b" and row["error_m"]]
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\| (1|997) \| ([^|]+) \| ([^|]+) \| (\d+) \|$", text, re.MULTILINE)
    assert [steps for steps, *_ in shown] == ["1", "997"]
    for steps, event_driven, cvode, ratio in shown:
        best = {}
        for row in rows:
            if row["communication_steps"] == steps and float(row["error_m"]) <= 1e-9:
                solver = row["solver"].split("_")[0]
                best[solver] = min(best.get(solver, float("inf")), float(row["time_s"]))
        assert seconds(event_driven) == pytest.approx(best["event"], rel=5e-3), steps
        assert seconds(cvode) == pytest.approx(best["cvode"], rel=5e-3), steps
        assert float(ratio) == pytest.approx(best["cvode"] / best["event"], rel=0.01), steps
