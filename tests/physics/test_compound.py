"""Compound bodies against formulas that stand apart from the FMU (support/reference/compound.py): forces,
torques and their derivatives of a foot that is prescribed, and the motion of free bodies."""

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.checks import check_close, run, start
from support.reference.compound import Foot, FreeBody, Pin, matrix

PARTS = {"left_heel": (0.02, (-0.09, 0.03, -0.03)), "right_heel": (0.02, (-0.09, -0.03, -0.03))}
PARTS |= {"left_ball": (0.015, (0.1, 0.04, -0.035)), "right_ball": (0.015, (0.1, -0.04, -0.035))}
COUNT = 40
VALUES, DERIVATIVES = 1e-12, 1e-9
SUMS = ("foot.contact_force", "foot.contact_torque")
KNOWNS = {"foot.prescribed_displacement": "x", "foot.prescribed_velocity": "v"}
KNOWNS |= {"foot.prescribed_orientation": "q", "foot.prescribed_angular_velocity": "omega"}


def random_case(rng):
    damping = rng.choice([0.0, 100.0, 3000.0])
    foot = Foot(PARTS.values(), 1e6, damping, rng.uniform(0.0, 1.0), 10 ** rng.uniform(-4, 0))
    motion = {
        "x": np.array([rng.normal(), rng.normal(), 0.05]), "v": rng.normal(size=3) * [1.0, 1.0, 0.1],
        "q": np.array([1.0, *rng.normal(size=3) * 0.02]) * rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-3,
            3),
        "omega": rng.normal(size=3),
    }  # fmt: skip
    lowest = min(foot.gap(k, motion["x"], matrix(motion["q"])) for k in range(len(PARTS)))
    motion["x"][2] -= lowest + rng.uniform(1e-4, 3e-3)  # the lowest part is so deep
    return foot, motion


def begun(fmu, foot, motion):
    values = {"foot.center": [0.0, 0.0, 0.0]}
    for name in PARTS:
        values |= {f"{name}.friction": "regularized", f"{name}.slip_velocity_control": "user_defined"}
        values |= {f"{name}.characteristic_slip_velocity": foot.v_0, f"{name}.friction_coefficient": foot.mu}
        values |= {f"{name}.viscous_penalty_factor": foot.p_nv}
    start(fmu, values)
    for name, field in KNOWNS.items():
        fmu[name] = motion[field]
    return fmu


def expected(foot, motion):
    found = {}
    ends = (motion["x"], motion["v"], motion["q"], motion["omega"])
    for k, name in enumerate(PARTS):
        gap, force, torque = foot.contact(k, *ends)
        found |= {f"{name}.gap": np.array([gap]), f"{name}.source_force": force}
        found |= {f"{name}.source_torque": torque}
    return found | dict(zip(SUMS, foot.total(*ends), strict=True))


def test_forces_and_torques_of_a_foot_are_those_of_the_formulas(opened):
    rng = np.random.default_rng(1)
    together = 0
    for _ in range(COUNT):
        foot, motion = random_case(rng)
        fmu = begun(opened("FootForceElement"), foot, motion)
        for name, wanted in expected(foot, motion).items():
            # gaps are differences of coordinates of a metre; torques have arms of a tenth of it
            size = np.linalg.norm(wanted) + (1.0 if "gap" in name else 1e6 * 2e-15 / VALUES)
            check_close(name, np.atleast_1d(fmu[name]), wanted, VALUES * size)
        together += sum(fmu[f"{name}.active"] for name in PARTS) > 1
    assert together > COUNT / 4


def test_directional_derivatives_are_complex_steps_of_the_formulas(opened):
    rng = np.random.default_rng(2)
    step = 1e-30
    for _ in range(COUNT // 2):
        foot, motion = random_case(rng)
        fmu = begun(opened("FootForceElement"), foot, motion)
        names = expected(foot, motion)
        for known, field in KNOWNS.items():
            given = {name: np.atleast_2d(fmu.jacobian(name, known)) for name in names}
            scale = np.linalg.norm(motion["q"]) if field == "q" else 1.0
            for k in range(len(motion[field])):
                moved = {name: value.astype(complex) for name, value in motion.items()}
                moved[field][k] += 1j * step * scale
                for name, wanted in expected(foot, moved).items():
                    exact = wanted.imag / step
                    size = np.linalg.norm(exact) + np.linalg.norm(wanted.real) + 10.0
                    found = scale * given[name][:, k]
                    check_close(f"{name} by {known}[{k + 1}]", found, exact, DERIVATIVES * size)


@pytest.mark.parametrize("omega", [(0.3, -0.2, 5.0), (0.0, 0.0, 0.0)])
def test_between_communication_points_the_foot_turns_with_its_angular_velocity(opened, omega):
    fmu = opened("FootForceElement")
    start(fmu, {})
    fmu["foot.prescribed_orientation"] = [2.0, 0.0, 0.0, 0.2]
    fmu["foot.prescribed_angular_velocity"] = omega
    before, length = matrix(np.array(fmu["foot.orientation"])), 0.1
    fmu.step(length)
    angle = length * np.linalg.norm(omega)
    half = np.sin(angle / 2) * np.array(omega) / (np.linalg.norm(omega) or 1.0)
    turned = matrix(np.array([np.cos(angle / 2), *half])) @ before
    check_close("orientation", matrix(np.array(fmu["foot.orientation"])).ravel(), turned.ravel(), 1e-14)


def test_sums_over_a_step_are_those_of_finer_steps(opened):
    """The mean force of a step is an integral: one step and a thousand steps agree."""
    fmu = opened("FootForceElement")
    means = []
    for steps in (1, 1000):
        start(fmu, {"foot.center": [0.0, 0.0, 0.0497]})
        fmu["foot.prescribed_angular_velocity"] = [0.02, 0.3, 0.1]
        total = np.zeros(3)
        for _ in range(steps):
            fmu.step(0.05 / steps)
            total += np.array(fmu["left_ball.mean_force"]) / steps
        means.append(total)
    assert np.linalg.norm(means[0]) > 1.0
    check_close("mean force", means[0], means[1], 1e-9 * np.linalg.norm(means[1]))


def test_an_orientation_of_zero_is_refused(opened):
    fmu = opened("FootForceElement")
    start(fmu, {})
    fmu["foot.prescribed_orientation"] = [0.0, 0.0, 0.0, 0.0]
    with pytest.raises(Exception, match=r"foot.prescribed_orientation is zero, which has no direction"):
        fmu.step(1e-3)


TRIPOD = {"front": (0.05, (0.3, 0.0, -0.2)), "left": (0.05, (-0.2, 0.25, -0.2))}
TRIPOD |= {"right": (0.05, (-0.2, -0.15, -0.2))}
PIN = {"lower": (0.01, (0.0, 0.0, -0.03)), "upper": (0.01, (0.0, 0.0, 0.03))}
MASS, INERTIA = 3.0, np.array([0.05, 0.07, 0.09])


def laws(parts, p_n, p_nv, mu, v_0):
    values = {}
    for name in parts:
        values |= {f"{name}.penalty_factor": p_n, f"{name}.viscous_penalty_factor": p_nv}
        values |= {f"{name}.friction_coefficient": mu, f"{name}.slip_velocity_control": "user_defined"}
        values |= {f"{name}.characteristic_slip_velocity": v_0}
    return values


def state(fmu, body):
    fields = ("position", "velocity", "orientation", "angular_velocity")
    return np.concatenate([fmu[f"{body}.{field}"] for field in fields])


def tripod(p_nv, mu):
    """Returns the start of a tumbling tripod as parameters, and its reference with this start."""
    y = np.array([0.0, 0.0, 0.28, 1.0, 0.2, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, -0.3, 2.0])
    values = laws(TRIPOD, 1e5, p_nv, mu, 0.01) | {"tripod.center": y[:3], "tripod.initial_velocity": y[3:6]}
    values |= {"tripod.initial_angular_velocity": y[10:]}
    return values, FreeBody(Foot(TRIPOD.values(), 1e5, p_nv, mu, 0.01), MASS, INERTIA), y


@functools.cache
def tripod_after(p_nv, mu, end):
    _, reference, y = tripod(p_nv, mu)
    return reference.run(y, end)


@functools.cache
def pin_after(end):
    """Returns the pin's state after `end`. No part starts on the axis, where no normal is defined."""
    inertia = np.array([9e-5, 9e-5, 7.5e-6])
    pin = FreeBody(Pin(0.0102, PIN.values(), 1e6, 20.0), 0.15, inertia, (0.0, 0.0, 0.0))
    return pin.run([1e-6, 0.0, 0.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 3.0], end)


@pytest.mark.parametrize(("p_nv", "mu"), [(0.0, 0.3), (50.0, 0.3), (50.0, 0.0)])
def test_a_tripod_falls_slides_and_tumbles_as_six_degrees_of_freedom_do(opened, method, p_nv, mu):
    values, _, _ = tripod(p_nv, mu)
    fmu = run(opened("Tripod"), values, 0.3, tolerance=3e-13, method=method)  # 1e-12 leaves CVODE 1e-9
    assert all(fmu[f"{name}.onsets"] > 0 for name in TRIPOD)
    check_close("state", state(fmu, "tripod"), tripod_after(p_nv, mu, 0.3), 1e-9)


def test_energy_and_its_parts_last(opened, method):
    values, reference, y = tripod(0.0, 0.0)
    fmu = opened("Tripod")
    at = []
    run(fmu, values, 0.3, 30, 1e-11, method, each=lambda fmu: at.append(fmu["energy.total"]))
    check_close("energy", at, [at[0]] * len(at), 1e-8 * abs(at[0]))
    check_close("energy of the reference", at[0], reference.energy(y), 1e-12 * abs(at[0]))
    rotation = matrix(np.array(fmu["tripod.orientation"]))
    turning = 0.5 * INERTIA @ (rotation.T @ fmu["tripod.angular_velocity"]) ** 2
    check_close("rotational energy", fmu["energy.rotational"], turning, 1e-13 * turning)


@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), (0.02, -0.01, 0.03)])
def test_a_free_body_with_three_moments_of_inertia_turns_by_eulers_equations(opened, torque):
    values = {"gravity": [0.0, 0.0, 0.0], "tripod.center": [0.0, 0.0, 5.0]}
    values |= {"tripod.initial_velocity": [0.0, 0.0, 0.0]}
    values |= {"tripod.initial_angular_velocity": [0.01, 3.0, 0.02], "tripod.external_torque": torque}
    free = FreeBody(Foot(TRIPOD.values(), 0.0), MASS, INERTIA, (0.0, 0.0, 0.0))

    def rates(t, y):
        rotation = matrix(y[6:10])
        more = np.zeros(13)
        more[10:] = rotation @ ((rotation.T @ np.array(torque)) / INERTIA)
        return free.rates(t, y) + more

    y = np.array([0, 0, 5.0, 0, 0, 0, 1, 0, 0, 0, *values["tripod.initial_angular_velocity"]])
    wanted = solve_ivp(rates, (0.0, 20.0), y, method="DOP853", rtol=1e-13, atol=1e-15, max_step=0.02).y[:, -1]
    wanted[6:10] /= np.linalg.norm(wanted[6:10])
    found = [state(run(opened("Tripod"), values, 20.0, steps=steps), "tripod") for steps in (1, 997)]
    # It turns over about its middle axis: rounding grows by exp(0.9 t).
    check_close("state", found[0], wanted, 1e-9)
    check_close("communication points", found[1], found[0], 1e-9)


def test_a_tripod_comes_to_rest_with_the_forces_of_statics(opened):
    fmu = run(opened("Tripod"), laws(TRIPOD, 1e6, 400.0, 0.3, 1e-3), 3.0, steps=30)
    assert fmu["tripod.position"][0] > 0.1  # it has slid so far
    check_close("velocity", fmu["tripod.velocity"], np.zeros(3), 1e-12)
    check_close("angular velocity", fmu["tripod.angular_velocity"], np.zeros(3), 1e-12)
    arms = [np.array(fmu[f"{name}.source_point"]) - fmu["tripod.position"] for name in TRIPOD]
    moments = np.array([[1.0, arm[0], arm[1]] for arm in arms]).T
    wanted = np.linalg.solve(moments, [MASS * 9.81, 0.0, 0.0])
    check_close("forces", [fmu[f"{name}.normal_force"] for name in TRIPOD], wanted, 1e-10)
    check_close("sum of forces", fmu["tripod.contact_force"], [0.0, 0.0, MASS * 9.81], 1e-10)
    check_close("sum of torques", fmu["tripod.contact_torque"], np.zeros(3), 1e-10)


def test_the_order_of_parts_and_contacts_changes_nothing(opened, opened_several):
    values, _, _ = tripod(50.0, 0.3)
    fmus = opened("Tripod"), opened_several("TripodReversed")
    ends = [state(run(fmu, values, 0.3), "tripod") for fmu in fmus]
    check_close("state", ends[1], ends[0], 1e-11)


def test_a_pin_rattles_in_a_hole_as_six_degrees_of_freedom_do(opened, method):
    values = {"hole.radius": 0.0102} | {f"{end}.friction": "none" for end in PIN}
    values["pin.initial_displacement"] = [1e-6, 0.0, 0.0]
    end = 0.02
    fmu = run(opened("PinInHole"), values, end, tolerance=1e-12, method=method)
    assert all(fmu[f"{name}.onsets"] > 1 for name in PIN)
    check_close("state", state(fmu, "pin"), pin_after(end), 1e-9)


BARS = {"one": np.array([0.01, 0.03, 0.035]), "two": np.array([0.008, 0.02, 0.025]), "ball": None}


def momenta(fmu, masses):
    """Returns momentum and angular momentum about the origin."""
    sums = np.zeros(6)
    for body, inertia in BARS.items():
        y = state(fmu, body)
        moments = np.full(3, 0.4 * masses[body] * 0.01) if inertia is None else inertia
        rotation = matrix(y[6:10])
        spin = rotation @ (moments * (rotation.T @ y[10:]))
        sums += np.concatenate([masses[body] * y[3:6], masses[body] * np.cross(y[:3], y[3:6]) + spin])
    return sums


@pytest.mark.parametrize("friction", ["none", "regularized", "elastic"])
def test_momenta_and_energy_of_bodies_that_meet_by_their_parts_last(opened_several, friction):
    """Parts of compounds and a ball are sources and destinations of each other."""
    rng = np.random.default_rng(5)
    touched, fmu = 0, opened_several("TwoBars")
    pairs = ("aa", "ab", "ba", "bb", "ball_a", "ball_b")
    for _ in range(6):
        masses = {body: rng.uniform(0.5, 2.0) for body in BARS}
        values = {f"{p}.friction": friction for p in pairs} | {f"{p}.penalty_factor": 1e5 for p in pairs}
        for body, speed in (("one", 1.0), ("two", -1.0), ("ball", 2.0)):
            values |= {f"{body}.motion": "free", f"{body}.rotation": "free", f"{body}.mass": masses[body]}
            values |= {f"{body}.initial_velocity": [0.0, 0.0, speed]}
            values |= {f"{body}.initial_angular_velocity": rng.normal(size=3) * 2.0}
        values |= {f"{body}.initial_orientation": rng.normal(size=4) for body in ("one", "two")}
        start(fmu, values, 1e-9)
        before, energy = momenta(fmu, masses), fmu["energy.total"]
        for _ in range(20):
            fmu.step(0.1)
        check_close("momenta", momenta(fmu, masses), before, 1e-11)
        check_close("energy", fmu["energy.total"], energy, 1e-9)
        touched += sum(fmu[f"{pair}.onsets"] for pair in pairs)
    assert touched > 4


def test_hinged_bars_that_torques_press_together_take_few_evaluations(opened_several):
    """No centre moves: the rounding of gaps and spins counts by the moments of inertia alone."""
    fmu, pairs = opened_several("TwoBars"), ("aa", "ab", "ba", "bb", "ball_a", "ball_b")
    values = {f"{p}.penalty_factor": 1e8 for p in pairs} | {f"{p}.viscous_penalty_factor": 1e4 for p in pairs}
    for body, torque in (("one", -1.0), ("two", 1.0)):
        values |= {f"{body}.motion": "fixed", f"{body}.rotation": "free"}
        values |= {f"{body}.external_torque": [0, torque, 0], f"{body}.principal_inertia": [0.1, 0.1, 0.1]}
    run(fmu, values | {"two.center": [0.05, 0.0, 0.2199]}, 0.5, 1, 1e-10, "event_driven")
    assert fmu["solver.force_evaluations"] < 2_000


def test_moments_of_inertia_that_no_body_has_are_refused(opened):
    with pytest.raises(Exception, match=r"tripod.principal_inertia = .* contradicts itself"):
        start(opened("Tripod"), {"tripod.principal_inertia": [1.0, 0.1, 0.2]})


def test_moments_of_inertia_that_nothing_reads_are_warned_of(opened_several):
    fmu = opened_several("TwoBars")
    fmu.messages.clear()
    fmu.start({"one.rotation": "none", "one.principal_inertia": [0.1, 0.1, 0.1]})
    assert any("one.principal_inertia[1] = 0.1 was set and is not in force" in m.text for m in fmu.messages)
