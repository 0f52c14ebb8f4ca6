"""What all pages share: formulas typeset or plain, tables that fit a small screen"""

import re
from pathlib import Path

import pytest
from lxml import etree

from contact_fmus.pages import FormulaError, Table, plain, typeset, write_pages
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


def math_of(text):
    return etree.fromstring(f"<p>{typeset(text)}</p>")


def test_names_have_indices_and_roots_what_they_hold():
    p = math_of("lasts $pi sqrt(m/p_n)$, whatever")
    assert p.text == "lasts " and p[0].tail == ", whatever"
    assert p.xpath("string(math/mi)") == "π"
    assert p.xpath("string(math/msqrt)") == "m/pn"
    assert p.xpath("string(math/msqrt/msub/mi)") == "p" and p.xpath("string(math/msqrt/msub/mtext)") == "n"


def test_numbers_powers_and_signs():
    p = math_of("$1e6 <= x^2 - 2.5e-3 (a + b)$")
    assert [part.text for part in p.xpath("math/msup[1]/mn")] == ["10", "6"]
    assert p.xpath("string(math/msup[2])") == "x2"
    assert p.xpath("math/mo/text()") == ["≤", "−", "·"]
    assert p.xpath("string(math/mrow)") == "(a+b)"


def test_what_is_no_formula_stays_and_is_escaped():
    assert typeset("a < b & c_d, 5 $") == "a &lt; b &amp; c_d, 5 $"


def test_plain_text_has_no_dollar():
    assert plain("lasts $pi sqrt(m/p_n)$ at $tau_n <= 2$") == "lasts π √(m/p_n) at τ_n ≤ 2"


@pytest.mark.parametrize("formula", ["a ; b", "sqrt(a", "a)", "x^", "(a"])
def test_a_formula_that_cannot_be_read_is_refused(formula):
    with pytest.raises(FormulaError, match=re.escape(formula)):
        typeset(f"${formula}$")


@pytest.mark.parametrize("words", WORDS, ids=range(len(WORDS)))
def test_every_formula_of_the_pages_can_be_read(words):
    typeset(words)


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
