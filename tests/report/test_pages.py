"""What all pages share: formulas typeset or plain, tables that fit a small screen"""

from pathlib import Path

import pytest
from lxml import etree

from contact_fmus.pages import FORMULA, Table, plain, typeset, write_pages
from contact_fmus.stability.motions import LAWS
from contact_fmus.stability.page import WORDS as ATLAS
from contact_fmus.stability.scenes import FAMILIES
from support.sources import ROOT

WORDS = [
    *(
        scenario.read_text(encoding="utf-8")
        for scenario in sorted((ROOT / "scripts/scenarios").glob("*.toml"))
    ),
    *ATLAS["LIMITS"],
    *ATLAS["AXES"].values(),
]


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
