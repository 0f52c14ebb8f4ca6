"""The benchmark: Idle is a valid FMU, ratios are those of pairs, and a slowdown shows."""

import io
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from contact_report import bench, bench_baseline, bench_tables
from contact_report.bench import Effort, Ratio, Row
from contact_scenarios.fmu_files import fmu_file, fmus_folder
from fmpy.validation import validate_fmu
from rich.console import Console

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fmu"))
import elf
import vdmcheck

LITTLE = Effort(turns=8, flight_steps=1000, tolerances=(1e-9,), budget=0.3, limit=30.0)


def shown(rows):
    stream = io.StringIO()
    bench_tables.print_rows("title", rows, Console(file=stream, width=130))
    return stream.getvalue()


# --- Idle.fmu ------------------------------------------------------------------------------------------


def test_idle_is_a_valid_fmu():
    assert validate_fmu(str(bench.idle_file())) == []


@pytest.mark.parametrize("model", vdmcheck.MODELS)
def test_vdmcheck_reports_nothing_about_idle(model):
    assert vdmcheck.check(bench.idle_file(), model) == []


def test_idle_exports_what_the_shipped_fmus_export(tmp_path):
    """Theirs are compared with the standard's header in test_validity.py."""
    exported = []
    for file in (bench.idle_file(), fmu_file("SphereSphere")):
        with zipfile.ZipFile(file) as fmu:
            exported.append(elf.exported(fmu.extract(f"binaries/linux64/{file.stem}.so", tmp_path)))
    assert exported[0] == exported[1]


def test_idle_runs_and_its_outputs_stay():
    result = fmpy.simulate_fmu(str(bench.idle_file()), stop_time=1.0, output_interval=0.25)
    assert list(result["time"]) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert set(result["position[3]"]) == {1.0}
    assert set(result["velocity[1]"]) == {0.0}


# --- ratios --------------------------------------------------------------------------------------------


def test_what_slows_both_down_leaves_the_ratio_alone():
    machine = [1.0, 5.0, 0.7, 12.0, 1.1, 3.0]  # how slow it is, pair by pair
    ratio = bench.ratio_of([1.3e-3 * slow for slow in machine], [1e-3 * slow for slow in machine])
    assert (ratio.median, ratio.low, ratio.high) == pytest.approx((1.3, 1.3, 1.3))


def test_the_ratio_is_the_median_of_pairs_with_their_middle_half():
    ratio = bench.ratio_of([1.0, 2.0, 3.0, 4.0, 500.0], [1.0] * 5)
    assert (ratio.low, ratio.median, ratio.high) == (2.0, 3.0, 4.0)
    assert ratio.bounds is None  # five pairs on one side of the median: one case in sixteen


def test_the_median_lies_between_its_bounds_as_often_as_said():
    """In 2000 experiments of 20 pairs with a heavy tail, as a busy machine's; three standard errors."""
    random = np.random.default_rng(1)
    count, hits = 2000, 0
    for _ in range(count):
        noise = random.lognormal(sigma=1.0, size=20)  # its median is 1
        low, high = bench.ratio_of(noise, [1.0] * 20).bounds
        hits += low <= 1.0 <= high
    assert hits / count > 1.0 - bench.DOUBT - 3 * (0.05 * 0.95 / count) ** 0.5
    assert hits / count < 1.0


def test_builds_are_called_different_only_where_the_pairs_are_sure():
    row = Row("work", "this build", "that")
    cases = [((1.2, 1.3), "slower"), ((0.7, 0.8), "quicker"), ((0.9, 1.3), "same"), (None, "too few pairs")]
    for bounds, verdict in cases:
        assert verdict in shown(
            [replace(row, first_time=1.0, second_time=1.0, ratio=Ratio(1.2, 1, 2, bounds))]
        )


@pytest.mark.parametrize(
    "limits, median, good",
    [
        ({"at_least": 100.0}, 99.9, False),
        ({"at_least": 100.0}, 100.0, True),
        ({"at_most": 2.0}, 2.1, False),
        ({"at_most": 2.0}, 1.9, True),
        ({}, 1.9, None),
    ],
)
def test_a_row_says_whether_its_ratio_is_as_asked(limits, median, good):
    row = Row("what", "first", "second", 1.0, 1.0, Ratio(median, median, median), **limits)
    assert row.good is good
    assert ("does not hold" in shown([row])) == (good is False)


def test_the_stiffness_that_is_checked_is_there():
    """A check of no rows would hold."""
    pairs = bench.stiff_problems()
    assert [(soft.penalty_factor, stiff.penalty_factor) for soft, stiff in pairs] == [(1e7, 1e15)] * 2


def test_a_row_that_could_not_be_measured_is_not_good():
    row = Row("what", "first", "second", at_least=1.0, note="fmu_host: refused")
    assert row.good is False
    assert "refused" in shown([row])


# --- through the host ----------------------------------------------------------------------------------


def test_a_slowdown_shows_and_none_is_seen_where_there_is_none():
    """The slowdown: the same flight in twice as many steps, so that it does the work of a step twice."""
    once = bench.flight_case("SphereSphere", LITTLE)
    twice = replace(once, name="twice", steps=2 * once.steps)
    slower = bench.compare(Row("work", "twice", "once"), twice, once, LITTLE)
    same = bench.compare(Row("work", "once", "once"), once, replace(once, name="again"), LITTLE)
    assert slower.ratio.median == pytest.approx(2.0, rel=0.25)
    assert "slower" in shown([slower])
    assert same.ratio.median == pytest.approx(1.0, rel=0.2)


def test_another_build_of_the_same_code_takes_the_same_time():
    (row,) = bench.against_baseline(
        fmus_folder(), "itself", LITTLE, [bench.flight_case("SphereSphere", LITTLE)]
    )
    assert row.ratio.median == pytest.approx(1.0, rel=0.2)


def test_flight_is_measured_against_idle():
    for row in bench.flights(LITTLE):
        assert row.second == "Idle"
        assert row.ratio.median > 1.0
        assert row.first_time > row.second_time > 0.0


def test_cvode_is_measured_against_event_driven_with_errors():
    (row,) = bench.against_cvode(LITTLE, ["P2"])
    assert row.first.startswith("cvode")
    assert row.second.startswith("event_driven")
    assert row.errors[0] <= 1e-7
    assert row.errors[1] <= 1e-9
    assert row.ratio.median > 1.0


def test_a_case_that_the_fmu_refuses_is_noted():
    case = bench.flight_case("SphereSphere", LITTLE)
    bad = replace(case, start={**case.start, "source.radius": -1.0})
    row = bench.compare(Row("flight", "bad", "good"), bad, case, LITTLE)
    assert row.ratio is None
    assert "source.radius" in row.note


def test_a_baseline_that_is_no_commit_is_refused():
    with pytest.raises(RuntimeError, match="no-such-commit"), bench_baseline.built("no-such-commit"):
        pass
