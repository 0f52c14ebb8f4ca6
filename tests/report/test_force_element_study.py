"""The study of the FMU as a force element: its orders, stable steps and energies are those of theory.

Theory is written down here by hand; the eigenvalues that the report shows are held against it as well."""

import json
import math

import pytest

from contact_fmus.coupling import study
from contact_fmus.coupling.outer_integrators import EULER, RUNGE_KUTTA, SCHEMES, VERLET, FmuElement, run
from contact_fmus.coupling.study import DEPTH, GRAVITY, OMEGA, PROBLEMS, STIFFNESS, start_values
from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file

BY_NAME = {(scheme.integrator, scheme.coupling): scheme for scheme in SCHEMES}
every_scheme = pytest.mark.parametrize("scheme", SCHEMES, ids=lambda one: f"{one.integrator}, {one.coupling}")


@pytest.fixture(scope="module")
def fmu():
    with ContactFmu(fmu_file("SphereSphere")) as opened:
        yield opened


def lagging_dashpot(zeta):
    """-1 becomes an eigenvalue where (h w)^2 + 8 zeta h w = 4: Verlet that gives the dashpot v + h a."""
    return -4 * zeta + math.sqrt(16 * zeta**2 + 4)


# (integrator, coupling, zeta): the step in 1/omega up to which a lasting contact keeps quiet
STABLE = {
    (EULER, "at once", 0.0): 2.0, (EULER, "at once", 0.5): 2 * (math.sqrt(1 + 0.5**2) - 0.5),
    (EULER, "held", 0.0): 0.0,
    (EULER, "held", 0.5): 0.5,  # z (z - 1)^2 + 2 zeta h w (z - 1) z + ...: |z| = 1 at h w = zeta
    (EULER, "mean, predicted", 0.0): math.sqrt(2), (EULER, "mean, iterated", 0.0): math.inf,
    (VERLET, "at once", 0.0): 2.0, (VERLET, "at once", 0.5): lagging_dashpot(0.5), (VERLET, "held", 0.0): 0.0,
    (VERLET, "derivatives 1, 2", 0.0): 2.0, (VERLET, "mean, predicted", 0.0): 2.0,
    (VERLET, "mean, predicted", 0.5): lagging_dashpot(0.5), (VERLET, "mean, iterated", 0.0): math.inf,
    (RUNGE_KUTTA, "at once", 0.0): math.sqrt(8), (RUNGE_KUTTA, "held", 0.0): 0.0,
}  # fmt: skip


@every_scheme
def test_the_error_in_a_lasting_contact_falls_with_the_order_of_the_scheme(scheme, fmu):
    steps = [0.025, 0.0125]
    errors = [study.error_of(PROBLEMS["press"], scheme, fmu, step) for step in steps]
    assert study.order_between(steps, errors) == pytest.approx(scheme.order, abs=0.2)
    assert errors[-1] < 0.1


@pytest.mark.parametrize("integrator, coupling, zeta", STABLE)
def test_the_eigenvalues_give_the_stable_step_of_theory(integrator, coupling, zeta):
    found = study.stable_step_of_theory(BY_NAME[integrator, coupling], zeta)
    assert found == pytest.approx(STABLE[integrator, coupling, zeta], rel=2e-3)


@pytest.mark.parametrize(
    "integrator, coupling, zeta", [one for one, step in STABLE.items() if 0 < step < math.inf]
)
def test_the_stable_step_measured_on_the_fmu_is_that_of_theory(integrator, coupling, zeta, fmu):
    found = study.stable_step_measured(fmu, BY_NAME[integrator, coupling], zeta, 600)
    assert found == pytest.approx(STABLE[integrator, coupling, zeta], rel=0.01)


def test_a_force_that_comes_one_step_late_adds_energy_in_every_step(fmu):
    """x'' = -w^2 x with x of the step before: z^2 - 2 z + 1 + (h w)^2 = 0, so |z|^2 = 1 + (h w)^2."""
    step, tool, sizes = 0.1, study.Tool(-GRAVITY, STIFFNESS, 0.0), []
    for steps in (100, 400):
        element = FmuElement(fmu, start_values(0.0, "unclamped"))
        ball = run(BY_NAME[EULER, "held"], element, tool, study.Ball(-0.99 * DEPTH, 0.0), step / OMEGA, steps)
        sizes.append(math.hypot(ball.u + DEPTH, ball.v / OMEGA))
    assert (sizes[1] / sizes[0]) ** (1 / 300) == pytest.approx(math.sqrt(1 + step**2), abs=1e-3)


@pytest.mark.parametrize("step", [0.3, 1.0, 3.0])
def test_an_iterated_mean_force_keeps_the_energy_of_an_impact(step, fmu, monkeypatch):
    """Undamped: the work of the mean force along the step's straight line is the change of kinetic energy."""
    problem, repeats = PROBLEMS["bounce"], []
    take_back = FmuElement.take_back
    monkeypatch.setattr(FmuElement, "take_back", lambda self: (repeats.append(self), take_back(self)))
    speeds = {}
    for integrator in (VERLET, EULER):
        for trial in problem.trials(step / OMEGA):
            element = FmuElement(fmu, {**problem.values, "contact.method": "penalty"})
            scheme, tool = BY_NAME[integrator, "mean, iterated"], study.Tool(0.0, STIFFNESS, 0.0)
            ball = run(scheme, element, tool, trial.ball, trial.size, trial.steps)
            speeds.setdefault(integrator, []).append(ball.v)
            assert repeats and repeats[-1] is element
    assert speeds[VERLET] == pytest.approx([1.0] * study.PLACES, abs=1e-9)
    assert max(speeds[EULER]) < 0.8


@pytest.mark.parametrize("coupling", ["at once", "held", "derivatives 1, 2"])
def test_the_pinned_force_element_gives_the_same_motion(coupling):
    """A ball dropped on a cylinder"""
    values, ends = start_values(0.1, "unclamped") | {"contact.location": "outside"}, []
    for name in ("SphereCylinder", "ForceElement"):
        with ContactFmu(fmu_file(name)) as fmu:
            given = values | {"destination.axis": [0.0, 1.0, 0.0]}
            element = FmuElement(fmu, {key: value for key, value in given.items() if key in fmu})
            tool = study.Tool(-GRAVITY, STIFFNESS, given["contact.viscous_penalty_factor"])
            ends.append(run(BY_NAME[VERLET, coupling], element, tool, study.Ball(-1e-6, -1e-3), 1e-5, 300))
    # The two round the path at different places: some units in the last place of 0.6 m.
    assert abs(ends[0].u - ends[1].u) < 1e-14
    assert ends[0].u < -1e-6  # it has moved


def test_a_ball_that_is_lost_has_no_error(fmu, monkeypatch):
    monkeypatch.setattr(study, "LOST", 2e-5)
    errors = [study.error_of(PROBLEMS["press"], BY_NAME[VERLET, "held"], fmu, step) for step in (3.0, 0.1)]
    assert errors[0] is None and errors[1] > 0.0


def test_the_command_writes_data_figure_and_sections(tmp_path, monkeypatch, capsys):
    few = {"bounce": [1.0, 0.5], "press": [0.1, 0.05]}
    monkeypatch.setattr(study, "QUICK", few)
    schemes = [BY_NAME[VERLET, coupling] for coupling in ("at once", "held", "mean, predicted")]
    monkeypatch.setattr(study, "SCHEMES", schemes)
    study.main(["--output", str(tmp_path), "--quick"])
    data = json.loads((tmp_path / "force_element.json").read_text())
    for row in data["schemes"]:
        assert [len(row[name]) for name in few] == [2, 2]
    (section,) = data["sections"]
    assert set(section) == {"title", "paragraphs", "tables", "figures"}
    for table in section["tables"]:
        assert {len(row) for row in table["rows"]} == {len(table["header"])}
        assert len(table["rows"]) == len(schemes)
    for figure in section["figures"]:
        assert (tmp_path / f"{figure['name']}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (tmp_path / f"{figure['name']}.svg").read_text()
    assert "velocity Verlet" in capsys.readouterr().out
