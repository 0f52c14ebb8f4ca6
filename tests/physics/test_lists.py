"""Bodies and contacts are lists: three balls in a row, two contacts on the middle one.

The reference is scipy's DOP853 at 1e-13, restarted wherever a contact begins or ends. The scene's FMU is
built for the test.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from checks import check_close
from contact_scenarios.fmu import ContactFmu
from scipy.integrate import solve_ivp

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "tests" / "physics" / "scenes" / "ThreeBalls.toml"
BALLS = ("left", "middle", "right")
REACH, STIFFNESS, END = 0.2, 1e6, 0.5


@pytest.fixture(scope="module")
def three_balls(tmp_path_factory):
    folder = tmp_path_factory.mktemp("three_balls")
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    options = [f"-DCONTACT_EXTRA_SCENES={SCENE}", f"-DPython3_EXECUTABLE={sys.executable}"]
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
    for command in ([*configure, *options], ["cmake", "--build", str(folder), "--target", "ThreeBalls_fmu"]):
        made = subprocess.run(command, capture_output=True, text=True, env=environment)
        assert made.returncode == 0, made.stdout + made.stderr
    return folder / "fmus" / "ThreeBalls.fmu"


def gaps(state):
    places = state[:9].reshape(3, 3)
    return np.linalg.norm(np.diff(places, axis=0), axis=1) - REACH


def rates(state, touching, masses):
    places, velocities = state[:9].reshape(3, 3), state[9:]
    forces = np.zeros((3, 3))
    for k in range(2):
        if touching[k]:
            apart = places[k + 1] - places[k]
            distance = np.linalg.norm(apart)
            push = -STIFFNESS * (distance - REACH) * apart / distance
            forces[k] -= push
            forces[k + 1] += push
    return np.concatenate([velocities, (forces / masses[:, None]).ravel()])


def reference(places, velocities, masses):
    time, state, touching = 0.0, np.concatenate([np.ravel(places), np.ravel(velocities)]), [False, False]
    while time < END:

        def event(k, until=tuple(touching)):
            def gap(_, y):
                return gaps(y)[k]

            gap.terminal, gap.direction = True, 1.0 if until[k] else -1.0
            return gap

        run = solve_ivp(
            lambda _, y, now=tuple(touching): rates(y, now, masses),
            (time, END),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
            max_step=2e-3,
            events=[event(0), event(1)],
        )
        time, state = run.t[-1], run.y[:, -1]
        for k in range(2):
            touching[k] ^= bool(len(run.t_events[k]))
    return state


CASES = {
    "almost touching": ([[-0.3, 0, 0], [0, 0, 0], [0.2001, 0, 0]], [1.0, 0, 0], [1.0, 1.0, 1.0]),
    "oblique": ([[-0.3, 0.05, 0], [0, 0, 0], [0.2002, 0.01, 0.02]], [2.0, 0, 0.1], [1.0, 0.5, 3.0]),
    "far apart": ([[-0.3, 0, 0], [0, 0, 0], [0.4, 0.03, 0]], [3.0, 0, 0], [2.0, 1.0, 0.1]),
}


@pytest.mark.parametrize("steps", [1, 100])
@pytest.mark.parametrize("method", ["cvode_bdf", "cvode_adams"])
@pytest.mark.parametrize("case", CASES)
def test_a_ball_between_two_others_moves_as_in_the_reference(three_balls, case, method, steps):
    places, velocity, masses = CASES[case]
    expected = reference(places, [velocity, [0, 0, 0], [0, 0, 0]], np.array(masses))
    values = {"solver.method": method, "left.initial_velocity": velocity, "gravity": [0, 0, 0]}
    for ball, place, mass in zip(BALLS, places, masses, strict=True):
        values |= {f"{ball}.center": place, f"{ball}.mass": mass}
    with ContactFmu(three_balls) as fmu:
        fmu.start(values, tolerance=1e-10)
        for _ in range(steps):
            fmu.step(END / steps)
        momentum = sum(mass * fmu[f"{ball}.velocity"] for ball, mass in zip(BALLS, masses, strict=True))
        check_close("momentum", momentum, masses[0] * np.array(velocity), 1e-12)
        for k, ball in enumerate(BALLS):
            check_close(f"{ball}.position", fmu[f"{ball}.position"], expected[3 * k : 3 * k + 3], 1e-8)
