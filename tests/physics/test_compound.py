"""Compound bodies: forces, torques and their derivatives of a prescribed foot against formulas that stand apart from the
FMU (support/reference/compound.py)."""

import numpy as np
import pytest

from support.checks import check_close, start
from support.reference.compound import Foot, matrix

PARTS = {
    "left_heel": (0.02, (-0.09, 0.03, -0.03)),
    "right_heel": (0.02, (-0.09, -0.03, -0.03)),
    "left_ball": (0.015, (0.1, 0.04, -0.035)),
    "right_ball": (0.015, (0.1, -0.04, -0.035)),
}
COUNT = 40
VALUES, DERIVATIVES = 1e-12, 1e-9
SUMS = ("foot.contact_force", "foot.contact_torque")
KNOWNS = {
    "foot.prescribed_displacement": "x",
    "foot.prescribed_velocity": "v",
    "foot.prescribed_orientation": "q",
    "foot.prescribed_angular_velocity": "omega",
}


def random_case(rng):
    foot = Foot(PARTS.values(), 1e6, rng.choice([0.0, 100.0, 3000.0]), rng.uniform(0.0, 1.0), 10 ** rng.uniform(-4, 0))
    motion = {
        "x": np.array([rng.normal(), rng.normal(), 0.05]),
        "v": rng.normal(size=3) * [1.0, 1.0, 0.1],
        "q": np.array([1.0, *rng.normal(size=3) * 0.02]) * rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-3, 3),
        "omega": rng.normal(size=3),
    }
    lowest = min(foot.gap(k, motion["x"], matrix(motion["q"])) for k in range(len(PARTS)))
    motion["x"][2] -= lowest + rng.uniform(1e-4, 3e-3)  # the lowest part is so deep
    return foot, motion


def begun(fmu, foot, motion):
    values = {"foot.center": [0.0, 0.0, 0.0]}
    for name in PARTS:
        values |= {
            f"{name}.friction": "regularized",
            f"{name}.slip_velocity_control": "user_defined",
            f"{name}.characteristic_slip_velocity": foot.v_0,
            f"{name}.friction_coefficient": foot.mu,
            f"{name}.viscous_penalty_factor": foot.p_nv,
        }
    start(fmu, values)
    for name, field in KNOWNS.items():
        fmu[name] = motion[field]
    return fmu


def expected(foot, motion):
    found = {}
    ends = (motion["x"], motion["v"], motion["q"], motion["omega"])
    for k, name in enumerate(PARTS):
        gap, force, torque = foot.contact(k, *ends)
        found |= {f"{name}.gap": np.array([gap]), f"{name}.source_force": force, f"{name}.source_torque": torque}
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
                    check_close(f"{name} by {known}[{k + 1}]", scale * given[name][:, k], exact, DERIVATIVES * size)


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
    """The mean force of a step is an integral: that of one step is that of a thousand"""
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
    with pytest.raises(Exception, match=r"foot.prescribed_orientation\[1..4\] = 0, 0, 0, 0 is no rotation"):
        fmu.step(1e-3)
