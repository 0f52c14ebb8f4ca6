"""Instruction counts are the same whenever they are taken, and promises hold or are said not to."""

import re
from dataclasses import replace

import pytest

from contact_fmus.bench import instructions
from contact_fmus.fmu.files import fmu_file, fmus_folder


def test_every_case_that_is_counted_has_a_bound_and_every_bound_a_case():
    assert [case.name for case in instructions.cases()] == list(instructions.read_bounds()["counts"])


def test_two_counts_of_one_run_are_the_same_and_more_work_is_more():
    once = instructions.flight_case("SphereSphere")
    count = instructions.instructions(once)
    assert instructions.instructions(once) == count
    assert instructions.instructions(replace(once, steps=2 * once.steps)) > 1.5 * count


@pytest.mark.parametrize("fmu", ["SphereSphere", "SphereCylinder"])
def test_the_compiler_of_an_fmu_is_found_in_it(fmu):
    assert re.fullmatch(r"(gcc|clang) \d+|another", instructions.compiler_of(fmu_file(fmu)))


@pytest.mark.parametrize("name", instructions.read_bounds()["counts"])
def test_the_promise_holds_and_fails_where_it_is_exceeded(name, monkeypatch, capsys):
    case = next(case for case in instructions.cases() if case.name == name)
    monkeypatch.setattr(instructions, "cases", lambda: [case])
    assert instructions.main(["--check"]) == 0
    bounds = instructions.read_bounds()
    bounds["counts"][name] *= 0.5
    monkeypatch.setattr(instructions, "read_bounds", lambda: bounds)
    assert instructions.main(["--check"]) == 1
    assert "does not hold" in capsys.readouterr().out


def test_a_case_without_a_bound_does_not_pass(monkeypatch):
    case = replace(instructions.cases()[2], name="nobody promised this")
    monkeypatch.setattr(instructions, "cases", lambda: [case])
    assert instructions.main(["--check"]) == 1


def test_another_build_of_the_same_code_has_the_same_counts(monkeypatch, capsys):
    case = next(case for case in instructions.cases() if case.name == "P1, 1 step")
    monkeypatch.setattr(instructions, "cases", lambda: [case])
    assert instructions.main(["--against", str(fmus_folder())]) == 0
    assert "1.0000" in capsys.readouterr().out


def test_what_the_fmu_refuses_is_no_count():
    case = instructions.flight_case("SphereSphere")
    with pytest.raises(instructions.CountError, match=r"source\.radius"):
        instructions.instructions(replace(case, start={**case.start, "source.radius": -1.0}))
