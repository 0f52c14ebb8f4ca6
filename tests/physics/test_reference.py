"""The references themselves: the Taylor integrator against published numbers, against more digits, and
against a second method.
"""

from decimal import Decimal

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.checks import check_close
from support.reference.integrator import Reference
from support.reference.law import REAL, Motion, ReferenceContact, complete, start_motion, vector
from support.scenes.benchmarks import BENCHMARKS
from support.scenes.random_scenes import SCENES, random_scene


def final_motion(reference):
    rows = [*reference.position.values(), *reference.velocity.values()]
    return np.array([[float(x) for x in row] for row in rows])


@pytest.mark.parametrize("name", BENCHMARKS)
def test_taylor_series_reproduce_the_peers_references(name):
    problem = BENCHMARKS[name]
    reference = Reference(problem.configuration, problem.shape).run(problem.end)
    check_close(f"{name} position", reference.position["source"], problem.position, 1e-12)


@pytest.mark.parametrize("shape, kind, seed", SCENES[::2])
def test_forty_digits_and_a_higher_order_change_nothing(shape, kind, seed):
    configuration, end = random_scene(shape, kind, seed)
    quick = Reference(configuration, shape).run(end)
    exact = Reference(configuration, shape, number=Decimal, order=30).run(end)
    check_close("position and velocity", final_motion(quick), final_motion(exact), 1e-11)
    check_close("dissipated work", quick.dissipated, float(exact.dissipated), 1e-9)
    check_close("external work", quick.external_work, float(exact.external_work), 1e-9)
    assert quick.onsets == exact.onsets


def acceleration(contact, values, time, state):
    """Right-hand side of the source alone, with the force of reference/law.py."""
    x, v = state[:3], state[3:]
    zero = vector([0, 0, 0])
    force = contact.evaluate(Motion(vector(x), vector(v), zero, zero))["contact.source_force"][0]
    return np.concatenate([v, np.float64(force / REAL(values["source.mass"])) + values["gravity"]])


@pytest.mark.parametrize(
    "shape, kind, seed", [scene for scene in SCENES if scene[1] in ("outside", "inside")]
)
def test_a_runge_kutta_method_without_events_finds_the_same_motion(shape, kind, seed):
    """Small steps instead of events: only the law of reference/law.py is shared, and the agreement is that
    of the kinks.
    """
    configuration, _ = random_scene(shape, kind, seed)
    values = complete(configuration)
    contact = ReferenceContact(configuration, shape)
    start = start_motion(values)
    state = np.float64(np.concatenate([start.source_displacement, start.source_velocity]))
    end = 0.12
    solution = solve_ivp(
        lambda t, y: acceleration(contact, values, t, y),
        (0, end),
        state,
        "DOP853",
        rtol=1e-10,
        atol=1e-12,
        max_step=1e-3,
    )
    reference = Reference(configuration, shape).run(end)
    assert reference.onsets > 0
    position = np.add(values["source.center"], solution.y[:3, -1])
    check_close("position", position, reference.position["source"], 2e-7)
    check_close("velocity", solution.y[3:, -1], reference.velocity["source"], 2e-5)


@pytest.mark.parametrize("shape, kind, seed", SCENES)
def test_the_energy_of_the_reference_balances(shape, kind, seed):
    """Kinetic + potential + stored + dissipated - external work of the quadratures stays what it was."""
    configuration, end = random_scene(shape, kind, seed)
    values = complete({k: v for k, v in configuration.items() if not k.endswith(".derivatives")})

    def total(reference):
        energy = float(reference.stored_energy() + reference.dissipated - reference.external_work)
        for body in ("source", "destination"):
            if values[f"{body}.motion"] == "free":
                mass = values[f"{body}.mass"]
                energy += mass * (np.dot(reference.velocity[body], reference.velocity[body]) / 2)
                energy -= mass * np.dot(values["gravity"], reference.position[body])
        return energy

    before = total(Reference(configuration, shape))
    check_close(
        "total energy", total(Reference(configuration, shape).run(end)), before, 1e-10 * max(1, abs(before))
    )
