"""The study of the FMU as a force element: its orders, stable steps and energies are those of theory.

Theory is written down here by hand; the eigenvalues that the report shows are held against it as well.
"""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from contact_fmus.coupling import problems as force_problems
from contact_fmus.coupling import study
from contact_fmus.coupling.driven_contact import DrivenContact
from contact_fmus.coupling.outer_integrators import (
    EULER,
    RUNGE_KUTTA,
    SCHEMES,
    VERLET,
    Ball,
    Outside,
    run,
)
from contact_fmus.coupling.study import PRESS, stable_step_measured, stable_step_of_theory
from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file

BY_NAME = {(scheme.integrator, scheme.coupling): scheme for scheme in SCHEMES}
every_scheme = pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)


def lagging_dashpot(zeta):
    """-1 becomes an eigenvalue where (h w)^2 + 8 zeta h w = 4: Verlet that gives the dashpot v + h a."""
    return -4 * zeta + math.sqrt(16 * zeta**2 + 4)


# (integrator, coupling, zeta): the step in 1/omega up to which a lasting contact keeps quiet
STABLE = {
    (EULER, "at once", 0.0): 2.0,
    (EULER, "at once", 0.5): 2 * (math.sqrt(1 + 0.5**2) - 0.5),
    (EULER, "held", 0.0): 0.0,
    (EULER, "held", 0.5): 0.5,  # z (z - 1)^2 + 2 zeta h w (z - 1) z + ...: |z| = 1 at h w = zeta
    (EULER, "mean, predicted", 0.0): math.sqrt(2),
    (EULER, "mean, iterated", 0.0): math.inf,
    (VERLET, "at once", 0.0): 2.0,
    (VERLET, "at once", 0.5): lagging_dashpot(0.5),
    (VERLET, "held", 0.0): 0.0,
    (VERLET, "derivatives 1, 2", 0.0): 2.0,
    (VERLET, "mean, predicted", 0.0): 2.0,
    (VERLET, "mean, predicted", 0.5): lagging_dashpot(0.5),
    (VERLET, "mean, iterated", 0.0): math.inf,
    (RUNGE_KUTTA, "at once", 0.0): math.sqrt(8),
    (RUNGE_KUTTA, "held", 0.0): 0.0,
}


@every_scheme
def test_the_error_in_a_lasting_contact_falls_with_the_order_of_the_scheme(scheme):
    problem = force_problems.press()
    with ContactFmu(fmu_file(problem.fmu)) as fmu:
        points = [study.error_of(problem, scheme, fmu, step / problem.omega) for step in (0.025, 0.0125)]
    assert study.order_between(points) == pytest.approx(scheme.order, abs=0.2)
    assert points[-1]["error"] < 0.1


@pytest.mark.parametrize("integrator, coupling, zeta", STABLE)
def test_the_eigenvalues_give_the_stable_step_of_theory(integrator, coupling, zeta):
    found = stable_step_of_theory(BY_NAME[integrator, coupling], zeta)
    assert found == pytest.approx(STABLE[integrator, coupling, zeta], rel=2e-3)


@pytest.mark.parametrize(
    "integrator, coupling, zeta",
    [key for key, step in STABLE.items() if 0.0 < step < math.inf],
)
def test_the_stable_step_measured_on_the_fmu_is_that_of_theory(integrator, coupling, zeta):
    found = stable_step_measured(BY_NAME[integrator, coupling], zeta, 600)
    assert found == pytest.approx(STABLE[integrator, coupling, zeta], rel=0.01)


def pressed(scheme, step, steps):
    """Amplitude after undamped steps of h omega = step over that at the start"""
    stiffness = PRESS["contact.penalty_factor"]
    omega, depth = math.sqrt(stiffness), 9.81 / stiffness
    push = 0.01 * depth
    outside = Outside(1.0, force_problems.GRAVITY, stiffness, 0.0)
    with ContactFmu(fmu_file("SphereSphere")) as fmu:
        element = DrivenContact(fmu, {**PRESS, "contact.viscous_penalty_factor": 0.0})
        start = Ball(np.array([0.0, 0.0, push - depth]), np.zeros(3), np.zeros(3))
        ball = run(scheme, element, outside, start, step / omega, steps)
    return math.hypot(ball.displacement[2] + depth, ball.velocity[2] / omega) / push


def test_a_force_that_comes_one_step_late_adds_energy_in_every_step():
    """x'' = -w^2 x with x of the step before: z^2 - 2 z + 1 + (h w)^2 = 0, so |z|^2 = 1 + (h w)^2."""
    scheme, step = BY_NAME[EULER, "held"], 0.1
    growth = (pressed(scheme, step, 400) / pressed(scheme, step, 100)) ** (1 / 300)
    assert growth == pytest.approx(math.sqrt(1 + step**2), abs=1e-3)


@pytest.mark.parametrize("step", [0.3, 1.0, 3.0])
def test_an_iterated_mean_force_keeps_the_energy_of_an_impact(step):
    """Undamped: the work of the mean force along the step's straight line is the change of kinetic energy."""
    problem = force_problems.bounce()
    values = {**problem.values, "contact.method": "penalty"}
    outside = replace(problem.outside, damping=0.0)
    speeds = {}
    with ContactFmu(fmu_file(problem.fmu)) as fmu:
        for integrator in (VERLET, EULER):
            for trial in problem.trials(step / problem.omega):
                element = DrivenContact(fmu, values)
                scheme = BY_NAME[integrator, "mean, iterated"]
                ball = run(scheme, element, outside, trial.ball, trial.size, trial.steps)
                speeds.setdefault(integrator, []).append(ball.velocity[2])
                assert element.taken_back > 0
    assert speeds[VERLET] == pytest.approx([1.0] * force_problems.PLACES, abs=1e-9)
    assert max(speeds[EULER]) < 0.8


@pytest.mark.parametrize("coupling", ["at once", "held", "derivatives 1, 2"])
def test_the_pinned_force_element_gives_the_same_motion(coupling):
    problem = force_problems.benchmark("P3")
    ends = []
    for name in ("SphereCylinder", "ForceElement"):
        with ContactFmu(fmu_file(name)) as fmu:
            values = {key: value for key, value in problem.values.items() if key in fmu}
            element = DrivenContact(fmu, values)
            start = next(iter(problem.trials(1e-5))).ball
            ends.append(run(BY_NAME[VERLET, coupling], element, problem.outside, start, 1e-5, 300))
    # The two round the path at different places: some units in the last place of 0.5 m.
    assert np.max(np.abs(ends[0].displacement - ends[1].displacement)) < 1e-14
    assert ends[0].displacement[2] < -1e-6  # it has moved


def test_a_ball_that_is_lost_has_no_error():
    problem = force_problems.benchmark("P3")
    with ContactFmu(fmu_file(problem.fmu)) as fmu:
        point = study.error_of(problem, BY_NAME[VERLET, "held"], fmu, 1e-3)
    assert point["error"] is None


def test_the_command_writes_data_figure_and_sections(tmp_path, monkeypatch, capsys):
    few = {"press": [0.1, 0.05], "bounce": [1.0, 0.5], "P1": [5e-3], "P3": [2e-3]}
    monkeypatch.setattr(study, "QUICK", few)
    schemes = [BY_NAME[VERLET, coupling] for coupling in ("at once", "held", "mean, predicted")]
    monkeypatch.setattr(study, "SCHEMES", schemes)
    study.main(["--output", str(tmp_path), "--quick"])
    data = json.loads((tmp_path / "force_element.json").read_text())
    assert [problem["name"] for problem in data["problems"]] == list(few)
    (section,) = data["sections"]
    assert set(section) == {"title", "paragraphs", "tables", "figures"}
    for table in section["tables"]:
        assert {len(row) for row in table["rows"]} == {len(table["header"])}
        assert len(table["rows"]) == len(schemes)
    for figure in section["figures"]:
        assert (tmp_path / f"{figure['name']}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (tmp_path / f"{figure['name']}.svg").read_text()
    assert "velocity Verlet" in capsys.readouterr().out
