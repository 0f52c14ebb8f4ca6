"""First and second derivatives of outputs with respect to time: a closed form, and differences of outputs.

What is compared with differences is the motion as it goes on from the communication point; where all
bodies are prescribed their displacements are given the derivatives that their velocities promise."""

from ctypes import c_double, c_int, c_uint

import numpy as np
import pytest

from support.fmi2 import raw
from support.fmi2.jacobian import jacobian
from support.fmi2.raw import DISCARD, OK, array
from support.fmi2.runs import RUNS, SIZES, begin, go_on, time_after

SUMMED_UP = (".mean_force", ".mean_source_torque", ".mean_destination_torque", ".peak_force")
SUMMED_UP += (".peak_penetration",)
STEP = 1e-4
# Differences of values whose rounding and integration errors are some 1e-14 of their size.
NOISE = 1e-14 / STEP
RELATIVE = 1e-6


def provided(fmu: raw.Fmu) -> list[raw.Variable]:
    return [v for v in fmu.select("output", kind="Real") if not any(part in v.name for part in SUMMED_UP)]


def keep_promises(instance: raw.Instance) -> None:
    """Where both bodies are prescribed: displacements with the derivatives that the velocities promise"""
    names = [f"{body}.motion" for body in ("source", "destination")]
    given = [instance.get(name) for name in names if name in instance.fmu.variables]
    if given != [2, 2] and not instance.fmu.name.endswith("ForceElement"):
        return
    acceleration = np.array([0.7, -2.0, 1.1])
    foot = instance.fmu.name == "FootForceElement"
    for body, sign in ({"foot": 0.1} if foot else {"source": 1.0, "destination": -0.5}).items():
        given = f"{body}.prescribed"
        velocity = instance.get(f"{given}_velocity")
        for row in ("displacement", "velocity"):  # from here, wherever earlier derivatives have led
            instance.set({f"{given}_{row}": instance.get(f"{given}_{row}")})
        instance.feed(f"{given}_displacement", 1, velocity)
        instance.feed(f"{given}_displacement", 2, sign * acceleration)
        instance.feed(f"{given}_velocity", 1, sign * acceleration)


def follow(instance: raw.Instance, time: float, variables):
    """Values and both derivatives at five points, a short step apart; None where the regime changes"""
    rows = []
    kinds = set()
    for k in range(5):
        rows.append([instance.reals(variables), *(instance.output_derivatives(variables, n) for n in (1, 2))])
        names = (name for name in instance.fmu.variables if name.endswith((".active", "solver.events")))
        kinds.add(tuple(map(instance.get, names)))
        instance.ok("DoStep", time + k * STEP, STEP, 1)
    return np.array(rows) if len(kinds) == 1 else None


@pytest.mark.parametrize("name", RUNS)
def test_derivatives_are_those_of_the_motion_that_follows(name):
    run = RUNS[name]._replace(tolerance=1e-13)
    compared = 0
    with begin(run) as instance:
        variables = provided(instance.fmu)
        go_on(instance, run, 0, run.saved_at)
        for index in range(run.saved_at, run.saved_at + 4):
            time = time_after(index)
            instance.set(run.inputs(time))
            keep_promises(instance)
            blob = instance.save()
            rows = follow(instance, time, variables)
            instance.restore(blob)
            go_on(instance, run, index, index + 1)
            if rows is None:
                continue
            compared += 1
            for order in (1, 2):
                a, b, _, d, e = rows[:, order - 1]
                quotient = (a - 8 * b + 8 * d - e) / (12 * STEP)
                size = np.max(np.abs(rows[:, order - 1]), axis=0)
                # energy.total is a sum of energies, each of them with its own rounding
                terms = [size[k] if v.name.startswith("energy.") else 0.0 for k, v in enumerate(variables)]
                of_sum = [sum(terms) if v.name == "energy.total" else 0.0 for v in variables]
                rounding = 4 * np.finfo(float).eps / STEP * np.array(of_sum)
                allowed = RELATIVE * np.abs(quotient) + 100 * NOISE * size + rounding + 1e-7
                wrong = [
                    f"d^{order} {variables[k].name}: {rows[2, order, k]}, differences {quotient[k]}"
                    for k in np.flatnonzero(~(np.abs(rows[2, order] - quotient) <= allowed))
                ]
                assert wrong == []
    assert compared >= 2


def test_a_head_on_contact_has_the_derivatives_of_its_oscillator(dashpot):
    """g'' = F/m - 9.81, F = -(k g + c g'), so F' = -(k g' + c g'') and F'' = -(k g'' + c F'/m)"""
    mass, k, c = 1.5, 2e4, 30.0
    fmu = raw.load("SphereSphere")
    seen = set()
    with raw.Instance(fmu) as instance:
        given = instance.output_derivatives
        instance.initialize({
            "source.mass": mass, "source.center": [0.0, 0.0, 0.62], "contact.penalty_factor": k,
            "contact.viscous_penalty_factor": c, "contact.dashpot": dashpot,
        })  # fmt: skip
        names = ("contact.gap", "contact.gap_rate", "contact.normal_force", "contact.source_force[3]")
        names += ("energy.total",)
        variables = [fmu.variables[name] for name in names]
        for index in range(60):
            instance.ok("DoStep", index * 2**-9, 2**-9, 1)
            gap, rate, force = (instance.get(name) for name in names[:3])
            damping = c if dashpot != "approach_only" or rate < 0.0 else 0.0
            transmits = instance.get("contact.active") and (dashpot != "non_adhesive" or force > 0.0)
            seen.add((bool(instance.get("contact.active")), bool(transmits), damping))
            stiffness, damping = (k, damping) if transmits else (0.0, 0.0)
            bend = force / mass - 9.81
            first = -(stiffness * rate + damping * bend)
            second = -(stiffness * bend + damping * first / mass)
            expected = [(rate, bend), (bend, first / mass), (first, second), (first, second), (0.0, 0.0)]
            for order in (1, 2):
                wanted = [row[order - 1] for row in expected]
                assert given(variables, order) == pytest.approx(wanted, rel=1e-11, abs=1e-9)
            assert force == pytest.approx(-(stiffness * gap + damping * rate), rel=1e-12, abs=1e-9)
    assert {(True, True, c), (False, False, c)} <= seen


def test_a_duration_grows_with_the_time_while_bodies_touch():
    run = RUNS["sphere in contact"]
    with begin(run) as instance:
        variables = [instance.fmu.variables[f"contact.last_{name}"] for name in ("duration", "onset_time")]
        for index in range(run.steps):
            go_on(instance, run, index, index + 1)
            touching = float(instance.get("contact.active"))
            assert list(instance.output_derivatives(variables, 1)) == [touching, 0.0]
            assert list(instance.output_derivatives(variables, 2)) == [0.0, 0.0]
        assert instance.get("contact.onsets") >= 1


def test_what_sums_up_the_last_step_has_no_derivatives_and_the_rest_has(every_fmu):
    with raw.Instance(every_fmu) as instance:
        instance.initialize()
        for variable in every_fmu.select("output", kind="Real"):
            for order in (1, 2):
                reference, orders = array(c_uint, [variable.reference]), array(c_int, [order])
                call = ("GetRealOutputDerivatives", reference, 1, orders, array(c_double, [0.0]))
                if any(part in variable.name for part in SUMMED_UP):
                    instance.expect(DISCARD, variable.name, "sums up", "not provided")(instance.call(*call))
                else:
                    assert instance.call(*call) == OK, variable.name


def test_asking_changes_nothing(fmu):
    """Whether derivatives with respect to time are asked for or directional ones"""
    with raw.Instance(fmu) as asked, raw.Instance(fmu) as plain:
        for instance in (asked, plain):
            instance.initialize()
        time = 0.0
        for size in SIZES * 3:
            asked.output_derivatives(provided(fmu), 2)
            jacobian(asked, fmu.select("output", kind="Real"), fmu.select("input", kind="Real"))
            assert asked.run([size], start=time) == plain.run([size], start=time)
            time += size
