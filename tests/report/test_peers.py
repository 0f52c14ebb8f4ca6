"""The peers of the report: each is given the FMU's problem, comes near the reference, and says why it cannot.

scipy is always there; of the other peers those installed are run, and the rest must say that they are not."""

import importlib.util
import itertools
import json
import os
import time
from contextlib import closing
from types import SimpleNamespace

import pytest

from contact_fmus.bench.problems import CODES, ISLANDS, METHODS, TURNING, Setting, benchmarks, stored_problems
from contact_fmus.fmu.host import run_host
from contact_fmus.peers import command, energy, problems
from contact_fmus.peers.command import main
from contact_fmus.peers.problems import Case, Run
from contact_fmus.report.measure import PEER, SAME, SIMILAR, read_rows
from support.programs import PATIENCE
from support.scenes.benchmarks import BENCHMARKS

CASE = Case("made up", "step size in s", 1.0, SAME)
PLAN = command.Plan(3, 0.1, 1.0)


@pytest.fixture(scope="module")
def scipy_rows(tmp_path_factory):
    folder = tmp_path_factory.mktemp("peers")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(command, "QUICK", command.QUICK._replace(patience=PATIENCE))
        assert main(["--output", str(folder), "--quick", "--only", "scipy"]) == 0
    return read_rows(folder / "peers.csv")


def test_a_peer_is_given_the_numbers_of_the_fmu():
    for name, benchmark in BENCHMARKS.items():
        problem, start = problems.problem_of(name), benchmark.configuration
        assert problem.inside == (start.get("contact.location") == "inside")
        assert problem.stiffness == start["contact.penalty_factor"]
        assert problem.damping == start.get("contact.viscous_penalty_factor", 0.0)
        assert (problem.radius, problem.mass) == (start["source.radius"], start["source.mass"])
        assert problem.wall_radius == start["destination.radius"]
        assert problem.position == pytest.approx(start["source.center"], abs=1e-15)
        assert list(problem.velocity) == start.get("source.initial_velocity", [0.0, 0.0, 0.0])
        assert problem.end == benchmark.end
        assert problem.touching == (name == "P3")


@pytest.mark.parametrize("name, onsets", [("P1", 8), ("P2", 2), ("P3", 1), ("P3b", 63)])
def test_scipy_with_a_largest_step_reaches_the_reference(scipy_rows, name, onsets):
    rows = [row for row in scipy_rows if row.problem == name and not row.setting.endswith("no max_step")]
    finest = min(rows, key=lambda row: row.parameter)
    assert finest.error_m < 2e-7
    assert finest.onsets == onsets
    assert 0.0 < finest.time_min_s <= finest.time_s
    assert {(row.group, row.solver, row.law) for row in rows} == {(PEER, "scipy DOP853", SAME)}


@pytest.mark.parametrize("name", ["P1", "P2"])
def test_scipy_without_a_largest_step_misses_impacts(scipy_rows, name):
    rows = [row for row in scipy_rows if row.problem == name and row.setting.endswith("no max_step")]
    assert rows
    assert all(row.onsets == 0 and row.error_m > 1.0 for row in rows)


# peer, problem, integrator, a parameter fine enough, the error it then has at most
FINE = [("exudyn", "P1", "DOPRI5", 1e-10, 1e-6), ("exudyn", "P2", "DOPRI5", 1e-10, 1e-6)]
FINE += [("exudyn", "P3", "DOPRI5", 1e-6, 1e-8), ("exudyn", "P3b", "DOPRI5", 1e-9, 1e-6)]
FINE += [("exudyn", "cradle", "RK44", 3e-5, 1e-7), ("exudyn", "cradle Hertz", "DOPRI5", 1e-8, 1e-8)]
FINE += [("mujoco", "cradle", "Euler", 1e-5, 1e-5), ("mujoco", "P1", "Euler", 3e-5, 1e-3)]
FINE += [("lammps", "P1", "velocity Verlet", 1e-5, 1e-3), ("lammps", "P2", "velocity Verlet", 1e-5, 1e-3)]
FINE += [("lammps", "P3", "velocity Verlet", 1e-5, 1e-8), ("lammps", "P3b", "velocity Verlet", 1e-5, 1e-3)]
FINE += [("drake", "P1", "runge_kutta3", 1e-7, 1e-5)]


@pytest.mark.parametrize("peer, name, integrator, parameter, bound", FINE)
def test_a_peer_nears_the_reference_or_says_it_is_not_installed(peer, name, integrator, parameter, bound):
    about = command.PEERS[peer]
    if importlib.util.find_spec(about["import"]) is None:
        (row,) = command.run([name], quick=True, names=[peer])
        assert not row.measured
        assert row.note == f"not installed: {' and '.join(about['packages'])}"
        return
    problem = problems.problem_of(name)
    cases = {(one.integrator, one.parameter): one for one in command.cases(about, name, quick=False)}
    with closing(command.Worker(f"contact_fmus.peers.{peer}_peer")) as process:
        measured, late = process.ask(problem, cases[integrator, parameter], command.QUICK)
    assert (measured.error, late) == ("", False)
    known = (benchmarks() | stored_problems(ISLANDS))[name]
    assert known.error(measured.state[: len(known.position)]) < bound


# problem, tolerance, the error that each of the codes then has at most: some ten times what they have
ON_MODEL_EXCHANGE = [("P1", 1e-10, 3e-8), ("P2", 1e-10, 5e-9), ("F1", 1e-10, 1e-8), ("F4", 1e-8, 1e-7)]


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("name, tolerance, bound", ON_MODEL_EXCHANGE)
def test_a_code_comes_near_the_reference_or_says_that_it_is_not_installed(code, name, tolerance, bound):
    problem = (benchmarks() | stored_problems(TURNING))[name]
    (result,) = run_host([Setting(problem, code, tolerance, 1).case()], keep_going=True)
    if result.error:
        assert result.error.startswith("not installed: ")
        return
    assert problem.error(result.outputs["source.position"]) < bound
    assert result.outputs["contact.onsets"] == {"P1": 8, "P2": 2, "F1": 4, "F4": 1}[name]


@pytest.mark.parametrize("peer", ["mujoco", "drake"])
def test_a_peer_without_a_hollow_cylinder_says_so(peer):
    for name in ("P3", "P3b"):
        rows = list(command.run_problem(command.PEERS[peer], None, problems.problem_of(name), quick=True))
        assert [row.measured for row in rows] == [False]
        assert rows[0].note.startswith("cannot be expressed: no hollow cylinder")


def test_a_law_is_the_same_or_similar_in_every_case():
    laws = {
        name: {case.law for case in command.cases(peer, "P2", quick=False)}
        for name, peer in command.PEERS.items()
    }
    same, similar = {SAME}, {SIMILAR}
    assert laws == {"scipy": same, "exudyn": same, "mujoco": similar, "lammps": same, "drake": similar}


def peer_that(advance, position=(0.0, 0.0, 0.0)):
    run = Run(advance, lambda: [*position, 0.0, 0.0, 0.0])
    return SimpleNamespace(prepare=lambda _problem, _case: run)


def test_what_a_peer_raises_is_a_note():
    def advance():
        raise RuntimeError("first line\nsecond line")

    measured = command.measure(peer_that(advance), problems.problem_of("P1"), CASE, PLAN)
    assert measured.error == "RuntimeError: first line second line"


def test_a_position_that_is_no_number_is_a_note():
    module, problem = peer_that(lambda: None, (0.0, float("nan"), 0.0)), problems.problem_of("P1")
    row = command.measured_row(("P1", PEER, "made up"), CASE, command.measure(module, problem, CASE, PLAN))
    assert (row.measured, row.note) == (False, "the position at the end is not finite")


def test_repeats_end_when_it_is_enough(monkeypatch):
    shown = itertools.count()  # each look at the clock is a second after the one before
    monkeypatch.setattr(command.time, "perf_counter", lambda: next(shown))
    problem, peer = problems.problem_of("P1"), peer_that(lambda: None)
    times = [command.measure(peer, problem, CASE, PLAN._replace(enough=s)).times for s in (0.5, 2.0, 9.0)]
    assert times == [[1], [1, 1], [1, 1, 1]]


# This file as a peer's module, in a process of its own: it sleeps or dies.
def prepare(problem, _case):
    return Run(lambda: time.sleep(60) if problem.name == "P1" else os._exit(7), lambda: [0.0] * 6)


RUNS = {"integrator": "made up", "settings": ["step size in s"], "quick": [1.0, 0.5]}


def trouble(name, start, monkeypatch):
    monkeypatch.setattr(command, "START", start)
    monkeypatch.setattr(command, "QUICK", PLAN)
    peer = {"name": "trouble", "runs": [RUNS]}
    with closing(command.Worker(__name__)) as process:
        return [row.note for row in command.run_problem(peer, process, problems.problem_of(name), quick=True)]


def test_a_run_that_takes_too_long_is_ended_and_finer_ones_are_left_out(monkeypatch):
    notes = trouble("P1", 0.5, monkeypatch)
    assert notes == ["not done after 1 s", "left out: a coarser run already took too long"]


def test_a_process_that_dies_is_a_note_and_the_next_case_has_another(monkeypatch):
    assert trouble("P2", PATIENCE, monkeypatch) == ["its process ended with status 7"] * 2


def test_the_energy_of_a_fall_and_of_its_penetration_stays():
    """m g h becomes m v^2/2 at the touch, and p_n d^2/2 - m g d at the deepest point."""
    ball = problems.problem_of("P1")
    fall = ball.position[2] - ball.touching_distance
    touch = [0.0, 0.0, ball.touching_distance, 0.0, 0.0, -((2 * ball.gravity * fall) ** 0.5)]
    weight = ball.mass * ball.gravity
    deep = (weight + (weight**2 + 2 * ball.stiffness * weight * fall) ** 0.5) / ball.stiffness
    deepest = [0.0, 0.0, ball.touching_distance - deep, 0.0, 0.0, 0.0]
    higher = [*ball.position[:2], ball.position[2] + 0.01 * fall, *ball.velocity]
    found = [energy.change(ball, state) for state in (touch, deepest, higher)]
    assert found == pytest.approx([0.0, 0.0, 0.01], abs=1e-13)


def test_the_energy_is_told_of_every_solver_and_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(energy, "TIMES", [1.0, 5.0, 10.0])
    assert energy.main(["--quick", "--output", str(tmp_path)]) == 0
    (section,) = json.loads((tmp_path / "energy.json").read_text(encoding="utf-8"))["sections"]
    rows = section["tables"][0]["rows"]
    assert {row[0] for row in rows} == {*METHODS, *CODES.values()}
    for row in rows:
        assert len(row) == len(section["tables"][0]["header"])
        at_most = 1e-12 if row[0] == "event_driven" else 1e-4
        assert row[4].startswith("not installed: ") or all(float(cell) <= at_most for cell in row[5:])
    assert (tmp_path / "energy.png").read_bytes().startswith(b"\x89PNG")
