"""Batches: the same bits as runs one by one, by the compiled loop and without it; runs that fail"""

import re
from math import comb
from pathlib import Path

import numpy as np
import pytest
from scipy.special import chdtri

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.sweep.native import library_file
from support.sweeps import BOUNCES, read, run_here, study_text, write_study

POINTS = [0.5, 0.7, 1.0, 1.5, 2.0]  # steps of 2 s / 4, and the time of an output


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return read(write_study(tmp_path_factory.mktemp("study")))


def alone(study, values, place):
    """One run in an instance of its own: the columns of OUTPUTS, gap.mean apart"""
    with ContactFmu(study.fmu) as fmu:
        items = fmu.variable("contact.dashpot")
        start = {name: column[place, 0] for name, column in values.items()}
        start["contact.dashpot"] = items.items[items.item_values.index(start["contact.dashpot"])]
        fmu.start({"contact.method": "penalty_dynamic", **start})
        peaks, gaps, times = [fmu["contact.peak_force"]], [fmu["contact.gap"]], [0.0]
        for point in POINTS:
            fmu.step(point - fmu.time)
            peaks.append(fmu["contact.peak_force"])
            gaps.append(fmu["contact.gap"])
            times.append(fmu.time)
            if point == 0.7:
                speed = fmu["source.velocity[3]"]
        last = [fmu["source.position[3]"], fmu["contact.onsets"], float(fmu["contact.active"])]
        last.append(items.item_values[items.items.index(fmu["contact.dashpot"])])
        return [*last, max(peaks), min(gaps), speed], np.trapezoid(gaps, times) / 2.0


def test_the_compiled_loop_is_there():
    assert library_file() is not None


@pytest.mark.parametrize("compiled", [True, False])
def test_a_batch_has_the_bits_of_runs_one_by_one(study, compiled):
    values, rows = run_here(study, count=25, compiled=compiled)
    assert rows.status.tolist() == [0] * 25
    assert rows.values[1].max() > 3  # it bounces
    for place in range(25):
        expected, mean = alone(study, values, place)
        assert rows.values[[0, 1, 2, 3, 4, 5, 7], place].tolist() == expected
        assert rows.values[6, place] == pytest.approx(mean, rel=1e-12)


def test_the_loop_of_python_gives_the_same_bits(study):
    _, fast = run_here(study)
    _, slow = run_here(study, compiled=False)
    assert fast.values.tobytes() == slow.values.tobytes()


def test_a_stretch_has_the_bits_of_the_whole(study):
    _, whole = run_here(study)
    _, part = run_here(study, 17, 20)
    assert part.values.tobytes() == np.ascontiguousarray(whole.values[:, 17:37]).tobytes()


@pytest.mark.parametrize("compiled", [True, False])
def test_a_run_that_fails_leaves_the_others_alone(tmp_path, compiled):
    """The inside of a shell smaller than the ball is refused when the set-up ends."""
    vary = {"source.radius": "[0.1, 0.7, 0.2, 0.9, 0.3]"}
    text = study_text(vary=vary, outputs={"height": '"source.position[3]"'}, count=0)
    text = text.replace("[vary]", '"contact.location" = "inside"\n"source.center" = [0.0, 0.0, 0.0]\n[vary]')
    study = read(write_study(tmp_path, text))
    values, rows = run_here(study, compiled=compiled)
    assert rows.status[[0, 2, 4]].tolist() == [0, 0, 0]
    assert sorted(rows.messages) == [1, 3]
    assert np.isnan(rows.values[0, [1, 3]]).all()
    for place in (1, 3):
        start = {"contact.location": "inside", "source.center": [0, 0, 0]}
        start |= {"contact.method": "penalty_dynamic", "source.radius": values["source.radius"][place, 0]}
        with ContactFmu(study.fmu) as fmu, pytest.raises(FmuError) as refused:
            fmu.start(start)
        assert rows.messages[place]
        assert refused.value.messages[0].text.startswith(rows.messages[place])
        assert rows.status[place] == refused.value.status


def test_a_library_that_is_none_is_an_error_in_words(study, tmp_path):
    from contact_fmus.errors import RunFailure
    from contact_fmus.sweep import native
    from contact_fmus.sweep.drive import make_batch, make_plan

    batch = make_batch(study, 0, study.samples().values(0, 2))
    (tmp_path / "bad.so").write_bytes(b"no library")
    with pytest.raises(RunFailure, match="library cannot be used"):
        native.run(make_plan(study), batch, tmp_path / "bad.so", "", library_file())


def test_all_parameters_of_the_study_vary(study):
    values = study.samples().values(0, 50)
    assert list(values) == list(BOUNCES)
    assert all(len(np.unique(column)) > 1 for column in values.values())


CAPPED = """fmu = "SphereCylinder"
[experiment]
stop_time = 0.4
steps = 2
[start]
"destination.finite_length" = true
"destination.ends" = "capped"
"contact.method" = "penalty"
"contact.penalty_factor" = 1e5
"source.center[3]" = 0.7
"destination.axis[2]" = 0.0
"destination.axis[3]" = 1.0
[vary]
"source.center[1]" = [0.0, 0.4, 0.499999999, 0.500000001, 0.51, 0.65]
[outputs]
"bounces" = "contact.onsets"
"zone" = { variable = "contact.zone", at = 0.15 }
"aside" = "source.velocity[1]"
"""


@pytest.mark.parametrize("compiled", [True, False])
def test_balls_that_fall_over_the_edge_of_a_capped_cylinder(tmp_path, compiled):
    """On the cap they bounce straight up, at the rim aside, and beyond it they pass"""
    study = read(write_study(tmp_path, CAPPED))
    _, rows = run_here(study, compiled=compiled)
    assert rows.status.tolist() == [0] * 6
    bounces, zones, aside = rows.values[:3]
    assert (bounces > 0).tolist() == [True] * 5 + [False]
    assert np.all(aside[:3] == 0.0) and np.all(aside[3:5] > 0.0) and aside[5] == 0.0
    with ContactFmu(study.fmu) as fmu:
        items = fmu.variable("contact.zone")
        shown = [items.items[items.item_values.index(value)] for value in zones]
    assert shown == ["cap", "cap", "cap", "rim", "rim", "none"]


# The Galton board of scripts/studies: by which gaps do the balls leave?

STUDY = Path(__file__).resolve().parents[2] / "scripts" / "studies" / "galton_board.toml"
GRAVITY, PITCH, ROWS, DROP = 9.81, 0.023, 7, 0.018  # m/s^2; m between pegs of a row, m between rows
# Balls by gap, of the 100,000 of the study (results.parquet, counted by gaps_of)
STUDIED = np.array([408, 4587, 16215, 28693, 28818, 16342, 4517, 420])
BINOMIAL = np.array([comb(ROWS, k) for k in range(ROWS + 1)]) / 2**ROWS


def gaps_of(x, z, speed_x, speed_z):
    """The gap of each ball, counted from the left, from where it is later: it falls freely from there"""
    level = -(ROWS - 1) * DROP - 0.01  # a ball's centre below the middles of the lowest pegs
    assert np.all(z < level - 0.1)
    since = (-speed_z - np.sqrt(speed_z**2 - 2.0 * GRAVITY * (level - z))) / GRAVITY
    left = x - speed_x * since
    return np.clip(np.floor(left / PITCH + (ROWS + 1) / 2), 0, ROWS).astype(int)


def test_the_gaps_are_those_of_the_large_study_and_nearly_binomial(tmp_path):
    """The chance of a wrong alarm is 1e-6, that of a chi-squared beyond its limit."""
    few, text = tmp_path / "few.toml", STUDY.read_text(encoding="utf-8")
    few.write_text(re.sub(r"count = .*\nseed = 1", "count = 1500\nseed = 2", text))
    _, rows = run_here(read(few))
    assert not rows.status.any()
    counts = np.bincount(gaps_of(*rows.values), minlength=ROWS + 1)
    total, share = counts + STUDIED, counts.sum() / (counts.sum() + STUDIED.sum())
    apart = np.sum((counts - share * total) ** 2 / (share * (1.0 - share) * total))
    assert apart < chdtri(ROWS, 1e-6)
    off = STUDIED - STUDIED.sum() * BINOMIAL  # the walls push back: fewer balls at the ends than binomial
    assert np.abs(off).sum() / 2.0 < 0.04 * STUDIED.sum()
