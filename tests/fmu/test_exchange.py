"""Model Exchange: fmpy's CVODE drives the FMUs, against references, energies and co-simulation."""

import numpy as np
import pytest

from contact_fmus.bench.problems import benchmarks
from contact_fmus.fmu.files import fmu_file
from support import exchange_runs
from support.fmi2.raw import SCENES

ENERGIES = ["energy.total", "energy.dissipated", "energy.external_work", "solver.events"]


def simulate(scene: str, start: dict, stop: float, names: list[str], kind: str = "ModelExchange"):
    return exchange_runs.simulate(fmu_file(scene), start, stop, names, kind)


def vector(name: str) -> list[str]:
    return [f"{name}[{k}]" for k in (1, 2, 3)]


def last(result, names: list[str]) -> np.ndarray:
    return np.array([result[name][-1] for name in names])


@pytest.mark.parametrize("name", ["P1", "P2", "P3", "P3b"])
def test_cvode_outside_reaches_the_references(name):
    problem = benchmarks()[name]
    result = simulate(problem.fmu, problem.start, problem.stop, [*vector("source.position"), *ENERGIES])
    assert problem.error(last(result, vector("source.position"))) < 1e-6
    assert np.ptp(result["energy.total"]) < 1e-6
    assert result["solver.events"][-1] >= 1


@pytest.mark.parametrize("scene", SCENES)
def test_every_scene_runs_to_its_end_as_in_co_simulation(scene):
    """Two integrators that share no code come to the same place."""
    names = ["contact.gap", "contact.normal_force"]
    outside, inside = (simulate(scene, {}, 0.45, names, kind) for kind in ("ModelExchange", "CoSimulation"))
    for name in names:
        size = np.max(np.abs(inside[name])) + 1e-3
        assert abs(outside[name][-1] - inside[name][-1]) < 1e-6 * size, name


def test_two_free_bodies_keep_momentum_and_energy():
    start = {
        "destination.motion": "free",
        "destination.mass": 2.5,
        "gravity": [0.0, 0.0, 0.0],
        "source.center": [0.1, 0.0, 1.1],
        "source.initial_velocity": [0.0, 0.0, -3.0],
        "contact.method": "penalty",
    }
    names = [*vector("source.velocity"), *vector("destination.velocity"), *ENERGIES]
    result = simulate("SphereSphere", start, 0.5, names)
    source, destination = (last(result, vector(f"{body}.velocity")) for body in ("source", "destination"))
    assert np.allclose(source + 2.5 * destination, [0.0, 0.0, -3.0], rtol=0.0, atol=1e-9)
    assert result["solver.events"][-1] == 2
    # CVODE's own errors in two hundred steps of 1e-11 each of 4.5 J
    assert np.ptp(result["energy.total"]) < 1e-7
    assert abs(0.5 * source @ source + 1.25 * destination @ destination - 4.5) < 1e-7  # nothing is lost


@pytest.mark.parametrize("dashpot", ["non_adhesive", "unclamped", "approach_only"])
def test_dissipation_closes_the_balance_with_every_dashpot_and_bodies_come_to_rest(dashpot):
    start = {
        "source.initial_velocity": [0.0, 0.0, -1.0],
        "source.center": [0.0, 0.0, 0.61],
        "contact.penalty_factor": 1e4,
        "contact.viscous_penalty_factor": 60.0,
        "contact.dashpot": dashpot,
    }
    result = simulate("SphereSphere", start, 1.5, [*ENERGIES, "contact.normal_force"])
    assert np.ptp(result["energy.total"]) < 1e-8
    assert result["energy.dissipated"][-1] > 0.5
    assert abs(result["contact.normal_force"][-1] - 9.81) < 1e-3


def test_the_end_of_a_cylinder_books_the_stored_energy():
    names = [*vector("source.position"), "energy.dissipated", *ENERGIES]
    outside, inside = (
        simulate("BallOffRoller", {}, 0.8, names, kind) for kind in ("ModelExchange", "CoSimulation")
    )
    assert np.ptp(outside["energy.total"]) < 1e-8
    for name in (*vector("source.position"), "energy.dissipated"):
        assert abs(outside[name][-1] - inside[name][-1]) < 1e-7, name
