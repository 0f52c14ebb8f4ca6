"""Model Exchange: fmpy's CVODE drives the FMUs, against references, energies and co-simulation."""

import numpy as np
import pytest

from contact_fmus.fmu.files import fmu_file
from support import exchange_runs

ENERGIES = ["energy.total", "energy.dissipated", "energy.external_work", "solver.events"]


def simulate(scene: str, start: dict, stop: float, names: list[str], kind: str = "ModelExchange"):
    return exchange_runs.simulate(fmu_file(scene), start, stop, names, kind)


def vector(name: str) -> list[str]:
    return [f"{name}[{k}]" for k in (1, 2, 3)]


def last(result, names: list[str]) -> np.ndarray:
    return np.array([result[name][-1] for name in names])


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
