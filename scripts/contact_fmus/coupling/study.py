"""The command force-element: error against communication step of a contact FMU used as a force element, and the
stable step. It writes force_element.json, .svg and .png and prints the tables. outer_integrators.py has the
integrators and couplings, problems.py the problems, page.py the report's sections."""

from __future__ import annotations

import json
import math
import time
from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from contact_fmus.options import parse

from .driven_contact import DrivenContact
from .outer_integrators import SCHEMES, Ball, Outside, Scheme, run
from .page import draw, print_tables, sections
from .problems import GRAVITY, WALL, CoupledProblem, benchmark, bounce, press

# The largest communication step that keeps a lasting contact quiet: by theory and measured on the FMU.
#
# Theory: with F = -k u - c v a step of a scheme is a linear map of (u, v, last F), found column by column
# from a linear stand-in of the FMU; it keeps quiet while no eigenvalue is outside the unit circle. Measured:
# a ball pressed on a wall is pushed a little; the step is bisected between growing and not growing.

LEAST, MOST = 1e-2, 30.0  # in h omega; below: none, above: any
PRESS = WALL | {"contact.dashpot": "unclamped"}


class LinearElement:
    """F = -k u - c v with the calls of DrivenContact"""

    def __init__(self, stiffness: float, damping: float):
        self.stiffness, self.damping = stiffness, damping

    def force_at(self, displacement, velocity):
        return -self.stiffness * displacement - self.damping * velocity

    def force_after(self, size, displacement, velocity, rate=0.0, curvature=0.0, acceleration=0.0):
        end = displacement + rate * size + 0.5 * curvature * size**2
        return self.force_at(end, velocity + acceleration * size)

    def mean_force(self, size, displacement, velocity, rate, curvature, acceleration):
        mean = displacement + rate * size / 2.0 + curvature * size**2 / 6.0
        return self.force_at(mean, velocity + acceleration * size / 2.0)

    def go_on(self, size):
        pass

    remember = take_back = lambda self: None


def spectral_radius(scheme: Scheme, step: float, damping_ratio: float) -> float:
    """The spectral radius of one step for m = k = 1, so that the step is h omega"""
    damping = 2.0 * damping_ratio
    outside = Outside(1.0, np.zeros(1), 1.0, damping)
    element = LinearElement(1.0, damping)
    columns = []
    for unit in np.eye(3):
        ball = scheme.step(element, outside, Ball(*(unit[k : k + 1] for k in range(3))), step)
        columns.append(np.concatenate(ball))
    return float(np.max(np.abs(np.linalg.eigvals(np.array(columns).T))))


def bisected(quiet) -> float:
    """The step in h omega where quiet(step) ends: 0 for none, infinite for any"""
    steps = np.geomspace(LEAST, MOST, 25)
    if not quiet(steps[0]):
        return 0.0
    loud = next((k for k, step in enumerate(steps) if not quiet(step)), None)
    if loud is None:
        return math.inf
    low, high = steps[loud - 1], steps[loud]
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if quiet(middle) else (low, middle)
    return float(low)


def stable_step_of_theory(scheme: Scheme, damping_ratio: float) -> float:
    return bisected(lambda step: spectral_radius(scheme, step, damping_ratio) <= 1.0 + 1e-9)


def stable_step_measured(scheme: Scheme, damping_ratio: float, steps: int) -> float:
    stiffness = PRESS["contact.penalty_factor"]
    omega = math.sqrt(stiffness)
    damping = 2.0 * damping_ratio * omega
    outside = Outside(1.0, GRAVITY, stiffness, damping)
    depth = 9.81 / stiffness
    push = 0.01 * depth

    with ContactFmu(fmu_file("SphereSphere")) as fmu:

        def quiet(step: float) -> bool:
            element = DrivenContact(fmu, {**PRESS, "contact.viscous_penalty_factor": damping})
            largest = [0.0]

            def noted(ball: Ball) -> bool:
                size = math.hypot(ball.displacement[2] + depth, ball.velocity[2] / omega)
                largest[-1] = max(largest[-1], size)
                return size > 30.0 * push

            ball = Ball(np.array([0.0, 0.0, push - depth]), np.zeros(3), np.zeros(3))
            ball = run(scheme, element, outside, ball, step / omega, steps // 2, noted)
            largest.append(0.0)
            run(scheme, element, outside, ball, step / omega, steps // 2, noted)
            return largest[1] <= 1.02 * largest[0] and largest[1] < 20.0 * push

        return bisected(quiet)


# Communication steps in h omega, in s for P1 and P3.
FULL = {
    "press": [0.4, 0.2, 0.1, 0.05, 0.025, 0.0125],
    "bounce": [math.pi / count for count in (1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 256)],
    "P1": [5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4],
    "P3": [1e-3, 4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5],
}
QUICK = {
    "press": [0.1, 0.05, 0.025, 0.0125],
    "bounce": [math.pi / count for count in (2, 4, 8, 16)],
    "P1": [2e-3],
    "P3": [4e-4],
}
OWN = {"press": press, "bounce": bounce}
DAMPING_RATIOS = [0.0, 0.025, 0.5]  # 0.025 is P3's
WANTED = 0.01  # of the speed after an impact


def error_of(problem: CoupledProblem, scheme: Scheme, fmu: ContactFmu, step: float) -> dict[str, Any]:
    """The worst error of the problem's trials; None where the ball has left the scene"""

    def gone(ball) -> bool:
        return not np.max(np.abs(ball.displacement)) < 1e3 * problem.length

    worst, repeats, steps = 0.0, 0, 0
    for trial in problem.trials(step):
        element = DrivenContact(fmu, problem.values)
        ball = run(scheme, element, problem.outside, trial.ball, trial.size, trial.steps, gone)
        worst = math.inf if gone(ball) else max(worst, trial.error(ball))
        repeats, steps = repeats + element.taken_back, steps + element.steps - element.taken_back
        if math.isinf(worst):
            break
    calls = (steps + repeats) / max(steps, 1)
    return {"step": step, "error": worst if math.isfinite(worst) else None, "steps_per_step": calls}


def order_between(points: list[dict[str, Any]]) -> float | None:
    """The order of convergence is the slope of the last two errors that are there."""
    usable = [point for point in points if point["error"]]
    if len(usable) < 2:
        return None
    first, last = usable[-2:]
    return math.log(first["error"] / last["error"]) / math.log(first["step"] / last["step"])


def steps_wanted(points: list[dict[str, Any]], omega: float, error: float) -> float | None:
    """Communication steps in an undamped contact (pi/omega) from which on the error stays below"""
    found = None
    for point in sorted(points, key=lambda point: point["step"]):
        if point["error"] is None or point["error"] > error:
            break
        found = math.pi / omega / point["step"]
    return found


def study(quick: bool = False, say=lambda text: None) -> dict[str, Any]:
    """Everything measured: {"problems": [...], "stable": [...], ...}, ready for JSON"""
    began = time.perf_counter()
    problems = []
    for name, sizes in (QUICK if quick else FULL).items():
        problem = OWN[name]() if name in OWN else benchmark(name)
        steps = [size / problem.omega if name in OWN else size for size in sizes]
        curves = []
        with ContactFmu(fmu_file(problem.fmu)) as fmu:
            for scheme in SCHEMES:
                points = [error_of(problem, scheme, fmu, step) for step in steps]
                curves.append({"integrator": scheme.integrator, "coupling": scheme.coupling, "points": points})
                curves[-1]["order"] = order_between(points)
                if name == "bounce":
                    curves[-1]["steps_wanted"] = steps_wanted(points, problem.omega, WANTED)
        about = {"what": problem.what, "unit": problem.unit, "omega": problem.omega, "title": problem.title}
        problems.append({"name": name, **about, "curves": curves})
        say(f"{name}: {time.perf_counter() - began:.0f} s")
    stable = [_stable(scheme, 400 if quick else 1000, quick) for scheme in SCHEMES]
    say(f"stable steps: {time.perf_counter() - began:.0f} s")
    return {"quick": quick, "damping_ratios": DAMPING_RATIOS, "problems": problems, "stable": stable}


def _stable(scheme: Scheme, steps: int, quick: bool) -> dict[str, Any]:
    """Stable steps in h omega; infinite ones are "any" in JSON"""
    ratios = DAMPING_RATIOS[:1] if quick else DAMPING_RATIOS
    theory = [stable_step_of_theory(scheme, ratio) for ratio in DAMPING_RATIOS]
    measured = [stable_step_measured(scheme, ratio, steps) for ratio in ratios]
    measured += [None] * (len(theory) - len(measured))
    values = {"theory": [_plain(one) for one in theory], "measured": [_plain(one) for one in measured]}
    return {"integrator": scheme.integrator, "coupling": scheme.coupling, **values}


def _plain(value: float | None) -> float | str | None:
    return "any" if value is not None and math.isinf(value) else value


def main(arguments: list[str] | None = None) -> int:
    options = parse("force-element", arguments)
    data = study(options.quick, say=print)
    data["sections"] = sections(data)
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "force_element.json").write_text(json.dumps(data, indent=1) + "\n")
    draw(data, options.output)
    print_tables(data)
    return 0
