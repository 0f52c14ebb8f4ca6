"""The benchmark: Idle is a valid FMU, ratios are those of pairs, and a slowdown shows."""

import io
import re
import zipfile
from dataclasses import replace

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from rich.console import Console

from contact_fmus.bench import command, instructions, ratios
from contact_fmus.bench.ratios import Comparison, Effort, Ratio
from contact_fmus.fmu.files import fmu_file, fmus_folder
from contact_fmus.fmu.host import Result
from support.fmi2 import elf, vdmcheck
from support.programs import PATIENCE

LITTLE = Effort(turns=8, flight_steps=1000, tolerances=(1e-9,), budget=0.3, limit=PATIENCE)


def shown(rows):
    stream = io.StringIO()
    command.print_rows("title", rows, Console(file=stream, width=130))
    return stream.getvalue()


# --- Idle.fmu ------------------------------------------------------------------------------------------


def test_idle_is_a_valid_fmu():
    assert validate_fmu(str(ratios.idle_file())) == []


@pytest.mark.parametrize("model", vdmcheck.MODELS)
def test_vdmcheck_reports_nothing_about_idle(model):
    assert vdmcheck.check(ratios.idle_file(), model) == []


def test_idle_exports_what_the_shipped_fmus_export(tmp_path):
    """Theirs are compared with the standard's header in test_validity.py."""
    exported = []
    for file in (ratios.idle_file(), fmu_file("SphereSphere")):
        with zipfile.ZipFile(file) as fmu:
            exported.append(elf.exported(fmu.extract(f"binaries/linux64/{file.stem}.so", tmp_path)))
    assert exported[0] == exported[1]


def test_idle_runs_and_its_outputs_stay():
    result = fmpy.simulate_fmu(str(ratios.idle_file()), stop_time=1.0, output_interval=0.25)
    assert list(result["time"]) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert set(result["position[3]"]) == {1.0}
    assert set(result["velocity[1]"]) == {0.0}


# --- ratios --------------------------------------------------------------------------------------------


def test_what_slows_both_down_leaves_the_ratio_alone():
    machine = [1.0, 5.0, 0.7, 12.0, 1.1, 3.0]  # how slow it is, pair by pair
    ratio = ratios.ratio_of([1.3e-3 * slow for slow in machine], [1e-3 * slow for slow in machine])
    assert (ratio.median, ratio.low, ratio.high) == pytest.approx((1.3, 1.3, 1.3))


def test_the_ratio_is_the_median_of_pairs_with_their_middle_half():
    ratio = ratios.ratio_of([1.0, 2.0, 3.0, 4.0, 500.0], [1.0] * 5)
    assert (ratio.low, ratio.median, ratio.high) == (2.0, 3.0, 4.0)
    assert ratio.bounds is None  # five pairs on one side of the median: one case in sixteen


def test_the_median_lies_between_its_bounds_as_often_as_said():
    """In 2000 experiments of 20 pairs with a heavy tail, as a busy machine's; three standard errors."""
    random = np.random.default_rng(1)
    count, hits = 2000, 0
    for _ in range(count):
        noise = random.lognormal(sigma=1.0, size=20)  # its median is 1
        low, high = ratios.ratio_of(noise, [1.0] * 20).bounds
        hits += low <= 1.0 <= high
    assert hits / count > 1.0 - ratios.DOUBT - 3 * (0.05 * 0.95 / count) ** 0.5
    assert hits / count < 1.0


def test_builds_are_called_different_only_where_the_pairs_are_sure():
    row = Comparison("work", "this build", "that")
    cases = [((1.2, 1.3), "slower"), ((0.7, 0.8), "quicker"), ((0.9, 1.3), "same"), (None, "too few pairs")]
    for bounds, verdict in cases:
        assert verdict in shown(
            [replace(row, first_time=1.0, second_time=1.0, ratio=Ratio(1.2, 1, 2, bounds))]
        )


def test_a_pair_that_could_not_be_measured_says_why():
    assert "refused" in shown([Comparison("what", "first", "second", note="fmu_host: refused")])


# --- instruction counts --------------------------------------------------------------------------------


def test_every_case_that_is_counted_has_a_bound_and_every_bound_a_case():
    assert [case.name for case in instructions.cases()] == list(instructions.read_bounds()["counts"])


def test_two_counts_of_one_run_are_the_same_and_more_work_is_more():
    once = ratios.flight_case("SphereSphere", LITTLE)
    count = instructions.instructions(once)
    assert instructions.instructions(once) == count
    twice = replace(once, steps=2 * once.steps)
    assert instructions.instructions(twice) > 1.5 * count


@pytest.mark.parametrize("fmu", ["SphereSphere", "SphereCylinder"])
def test_the_compiler_of_an_fmu_is_found_in_it(fmu):
    assert re.fullmatch(r"(gcc|clang) \d+|another", instructions.compiler_of(fmu_file(fmu)))


@pytest.mark.parametrize("name", ["P1, 1 step", "P2, 997 steps"])
def test_the_promise_holds_and_fails_where_it_is_exceeded(name, monkeypatch, capsys):
    case = next(case for case in instructions.cases() if case.name == name)
    monkeypatch.setattr(instructions, "cases", lambda: [case])
    assert command.main(["--instructions", "--check"]) == 0
    bounds = instructions.read_bounds()
    bounds["counts"][name] *= 0.5
    monkeypatch.setattr(instructions, "read_bounds", lambda: bounds)
    assert command.main(["--instructions", "--check"]) == 1
    assert "does not hold" in capsys.readouterr().out


def test_a_case_without_a_bound_does_not_pass(monkeypatch):
    case = replace(instructions.cases()[2], name="nobody promised this")
    monkeypatch.setattr(instructions, "cases", lambda: [case])
    assert command.main(["--instructions", "--check"]) == 1


def test_another_build_of_the_same_code_has_the_same_counts(capsys):
    case = next(case for case in instructions.cases() if case.name == "P1, 1 step")
    (count,) = instructions.measure(fmus_folder(), [case])
    assert count.other == count.instructions


def test_what_the_fmu_refuses_is_no_count():
    case = ratios.flight_case("SphereSphere", LITTLE)
    with pytest.raises(instructions.CountError, match=r"source\.radius"):
        instructions.instructions(replace(case, start={**case.start, "source.radius": -1.0}))


# --- through the host ----------------------------------------------------------------------------------


@pytest.fixture
def takes(monkeypatch):
    """A host whose machine gets slower from turn to turn, and whose cases take the seconds that they are said
    to, by name"""

    def given(**seconds):
        def run(cases, turns, **_options):
            assert [case.name for case in cases] == [cases[k].name for k in (0, 1, 1, 0)]  # A B B A
            times = [[seconds[case.name] * 1.1**turn for turn in range(turns)] for case in cases]
            return [Result(case.name, one, one, {}) for case, one in zip(cases, times, strict=True)]

        monkeypatch.setattr(ratios, "run_host", run)

    return given


def test_a_slowdown_shows_and_none_is_seen_where_there_is_none(takes):
    takes(once=1e-3, again=1e-3, twice=2e-3)
    once = replace(ratios.flight_case("SphereSphere", LITTLE), name="once")
    twice, again = replace(once, name="twice"), replace(once, name="again")
    slower = ratios.compare(Comparison("work", "twice", "once"), twice, once, LITTLE)
    same = ratios.compare(Comparison("work", "once", "again"), once, again, LITTLE)
    assert slower.ratio.median == pytest.approx(2.0)
    assert slower.first_time == pytest.approx(2.0 * slower.second_time)
    assert slower.least == pytest.approx((2e-3, 1e-3))
    assert same.ratio.median == pytest.approx(1.0)
    assert "slower" in shown([slower]) and "same" in shown([same])


def test_another_build_is_run_beside_this_one_with_the_same_case(tmp_path, monkeypatch):
    case, asked = ratios.flight_case("SphereSphere", LITTLE), []
    monkeypatch.setattr(ratios, "compare", lambda row, *cases: asked.append((row, *cases)))
    ratios.against_baseline(tmp_path, "that", LITTLE, [case])
    ((row, first, second, _),) = asked
    assert (row.first, first) == ("this build", case)
    assert (row.second, second.fmu) == ("that", tmp_path / case.fmu.name)
    assert replace(second, name=case.name, fmu=case.fmu) == case


def test_flight_is_measured_against_idle():
    for row in ratios.flights(LITTLE):
        assert (row.second, row.note) == ("Idle", "")
        assert row.first in shown([row])


def test_cvode_is_measured_against_event_driven_with_errors():
    (row,) = ratios.against_cvode(LITTLE, ["P2"])
    assert row.first.startswith("cvode")
    assert row.second.startswith("event_driven")
    assert row.errors[0] <= 1e-7
    assert row.errors[1] <= 1e-9


def test_a_case_that_the_fmu_refuses_is_noted():
    case = ratios.flight_case("SphereSphere", LITTLE)
    bad = replace(case, start={**case.start, "source.radius": -1.0})
    row = ratios.compare(Comparison("flight", "bad", "good"), bad, case, LITTLE)
    assert row.ratio is None
    assert "source.radius" in row.note


def test_a_baseline_that_is_no_commit_is_refused():
    with pytest.raises(RuntimeError, match="no-such-commit"), command.built("no-such-commit"):
        pass
