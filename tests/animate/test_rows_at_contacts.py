"""Rows stand on both sides of every onset and release: straight lines show no force before a touch."""

import numpy as np
import pytest

from contact_fmus import Result
from contact_fmus.__main__ import main
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file
from contact_fmus.fmu.touching import Touching
from contact_fmus.plot.panels import touches
from contact_fmus.plot.source import open_runs

ROUNDINGS = 64  # of the time between the rows of an onset, of which a step needs some
# Steps of one communication interval, so that several contacts and many bounces fall into one
STEPS = {"BouncingBall": (1, 7, 400), "BallInShell": (1, 30), "ThreeBalls": (1, 20), "ForceElement": (1, 13)}


def rows_of(name, file, steps):
    """Time, and of each contact whether it is active, its force, its gap, its onsets; and the end"""
    with ContactFmu(file) as fmu:
        stop = float(fmu.description.defaultExperiment.stopTime)
        fmu.start(stop_time=stop)
        touching, rows = Touching(fmu), []
        for time in np.linspace(0.0, stop, steps + 1):
            rows += [row(fmu) for _ in touching.step(time)] if time > 0.0 else []
            drive(fmu)
            rows.append(row(fmu))
        return [np.array(column) for column in zip(*rows, strict=True)], everything(fmu), stop


def drive(fmu):
    """A force element is moved past the axis of its cylinder, 10 mm deep at most, at 2 m/s."""
    if "source.prescribed_displacement" in fmu:
        fmu["source.prescribed_displacement"] = [-0.009, 2.0 * fmu.time - 1.0, 0.0]
        fmu["source.prescribed_velocity"] = [0.0, 2.0, 0.0]
        fmu.set_derivative("source.prescribed_displacement", [0.0, 2.0, 0.0])


def row(fmu):
    contacts = [name.removesuffix(".gap") for name in fmu.variables if name.endswith(".gap")]
    fields = ("active", "normal_force", "gap")
    counted = [fmu[f"{one}.onsets"] for one in contacts if f"{one}.onsets" in fmu]
    return (fmu.time, *([fmu[f"{one}.{field}"] for one in contacts] for field in fields), counted)


def everything(fmu):
    """Outputs at the end but those that are of the last step"""
    wanted = ("position", "velocity", "gap", "normal_force", "dissipated", "onsets", "last_duration")
    return {name: fmu[name] for name in fmu.variables if name.partition("[")[0].endswith(wanted)}


@pytest.mark.parametrize("name, steps", [(name, steps) for name, many in STEPS.items() for steps in many])
def test_every_onset_and_release_has_a_row_on_either_side(name, steps, sources):
    (time, active, force, gap, onsets), _, stop = rows_of(name, sources(name)[1], steps)
    assert np.all(np.diff(time) > 0.0)
    changes = np.any(active[1:] != active[:-1], axis=1)
    assert np.count_nonzero(changes) > 0
    assert np.max(np.diff(time)[changes]) < ROUNDINGS * np.spacing(stop)
    assert np.all(force[~active] == 0.0) and np.all(gap[~active] > -1e-12)
    # No onset is passed over: of each contact as many rows begin one as were counted.
    begins = np.count_nonzero(active[1:] & ~active[:-1], axis=0) + active[0]
    assert np.all(begins == onsets[-1])  # a force element counts none


@pytest.mark.parametrize("name, steps", [(name, many[-1]) for name, many in STEPS.items()])
def test_the_rows_change_nothing_of_the_run(name, steps, sources):
    _, found, stop = rows_of(name, sources(name)[1], steps)
    with ContactFmu(sources(name)[1]) as fmu:
        fmu.start(stop_time=stop)
        for time in np.linspace(0.0, stop, steps + 1):
            if time > 0.0:
                fmu.step(time - fmu.time)
            drive(fmu)
        plain = everything(fmu)
    assert [key for key in plain if not np.array_equal(found[key], plain[key])] == []


def test_a_driven_contact_is_found_though_nothing_counts_it():
    """It lasts while the ball's centre is less than both radii, 0.6 m, from the axis, all in one step."""
    (time, active, _, gap, _), _, _ = rows_of("ForceElement", fmu_file("ForceElement"), 1)
    half = np.sqrt(0.6**2 - 0.59**2)
    begin, end = np.flatnonzero(np.diff(active[:, 0].astype(int)))
    assert time[[begin, end]] == pytest.approx([0.5 - half / 2.0, 0.5 + half / 2.0], rel=1e-12)
    assert np.max(np.abs(gap[[begin, begin + 1, end, end + 1], 0])) < 1e-12


@pytest.mark.parametrize("name", ["BouncingBall", "BallInShell"])
def test_lines_of_a_result_show_no_force_before_a_touch(name, tmp_path):
    file = tmp_path / "run.csv"
    assert main(["run", name, "--csv", str(file)]) == 0
    for result in (Result.read(file), open_runs(name, [], None)[0].result):
        fine = np.linspace(result.time[0], result.time[-1], 200_001)
        gap = np.interp(fine, result.time, result.columns["contact.gap"])
        force = np.interp(fine, result.time, result.columns["contact.normal_force"])
        assert np.max(force[gap > 0.0], initial=0.0) < 1e-9 * np.max(force)
        assert len(touches(result)) == result.columns["contact.onsets"][-1]


def test_two_rows_at_one_time_are_played_and_drawn(shown, tmp_path):
    """As Model Exchange leaves them at an event, here at the very end"""
    result = open_runs("SphereSphere", [], 0.4)[0].result
    rows = [*range(len(result.time)), len(result.time) - 1]
    columns = {name: values[rows] for name, values in result.columns.items()}
    twice = Result(result.time[rows], columns, result.units, result.fmu, result.parameters)
    twice.write_csv(tmp_path / "twice.csv")
    assert main(["animate", str(tmp_path / "twice.csv"), "-o", str(tmp_path / "twice.html")]) == 0
    page = shown(tmp_path / "twice.html", width=900, height=700)
    page.run("contactAnimation.seek(0.4)")
    told = page.run("[...document.querySelectorAll('output')].map((one) => one.value)")
    assert "–" not in told and len(told) >= 4
    assert page.run("Number.isFinite(contactAnimation.project('source').y)")
