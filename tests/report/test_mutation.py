"""What scripts/mutate.sh takes for a small way to break the code."""

import pytest

from contact_fmus.mutation.choice import chosen
from contact_fmus.mutation.operators import changes_of
from support.sources import SOURCE

HEAD = "int f(int a)\n{\n    "


def broken(statement):
    source = f"{HEAD}{statement}\n}}\n"
    return {source[: one.start] + one.text + source[one.end :] for one in changes_of(source)}


def with_body(*statements):
    return {f"{HEAD}{statement}\n}}\n" for statement in statements}


@pytest.mark.parametrize(
    "statement, expected",
    [
        ("return a < b;", ["return a <= b;", "return a >= b;", "return 0;", "return -(a < b);"]),
        ("double x = -y;", ["double x = y;"]),
        ("x += 2;", ["x -= 2;", "x += 3;", "x += 1;", ";"]),
        ("if (a && b) { g(a); }", ["if (a || b) { g(a); }", "if (!(a && b)) { g(a); }"]),
        ("const double x = 1.5 * y;", ["const double x = 0.0 * y;", "const double x = (2.0 * 1.5) * y;"]),
        ("x = fmin(y, z);", ["x = fmax(y, z);", ";"]),
    ],
)
def test_a_statement_is_broken_in_these_ways(statement, expected):
    assert with_body(*expected) <= broken(statement)


@pytest.mark.parametrize(
    "statement",
    ["/* a + 1, \n b < 2 */", "// a + 1", '"a + 1"', "#define N 3 + \\\n 4", "struct part *x;", "Handle x;"],
)
def test_what_is_no_code_or_only_declares_is_left_alone(statement):
    assert broken(statement) == set()


def test_a_seed_decides_and_every_file_with_code_has_its_share():
    some = chosen(SOURCE, seed=7)
    assert some == chosen(SOURCE, seed=7)
    assert some[:50] != chosen(SOURCE, seed=8)[:50]
    files = {one.file for one in some}
    assert len({one.file for one in some[: len(files)]}) == len(files)
    one_file = chosen(SOURCE, seed=7, only="geometry.c")
    assert {one.file for one in one_file} == {"contact/geometry.c"}


def test_a_change_changes_the_line_it_names():
    for one in chosen(SOURCE, seed=7)[:100]:
        source = (SOURCE / one.file).read_text()
        changed = one.apply(source)
        before, after = ([" ".join(line.split()) for line in text.split("\n")] for text in (source, changed))
        first = next(i for i, (a, b) in enumerate(zip(before, after, strict=False)) if a != b)
        assert first + 1 >= one.line
        assert before[: one.line - 1] == after[: one.line - 1]
