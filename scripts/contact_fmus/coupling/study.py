"""Error against communication step of a contact FMU used as a force element, and the stable step.

    python -m contact_fmus force-element --output DIR [--quick]

writes force_element.json, .svg and .png into DIR and prints the tables. outer_integrators.py says what the
integrators and couplings are, problems.py what is computed. The "sections" of the JSON file are the
report page's (rows.py).
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file

from .driven_contact import DrivenContact
from .outer_integrators import SCHEMES, Scheme, run
from .page import draw, print_tables, sections
from .problems import CoupledProblem, benchmark, bounce, press
from .stable_steps import stable_step_measured, stable_step_of_theory

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
        element.close()
        if math.isinf(worst):
            break
    calls = (steps + repeats) / max(steps, 1)
    return {"step": step, "error": worst if math.isfinite(worst) else None, "steps_per_step": calls}


def order_between(points: list[dict[str, Any]]) -> float | None:
    """Of convergence: the slope of the last two errors that are there"""
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
                curves.append(
                    {"integrator": scheme.integrator, "coupling": scheme.coupling, "points": points}
                )
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
    parser = argparse.ArgumentParser(prog="contact-fmus force-element", description=__doc__)
    parser.add_argument("--output", type=Path, required=True, help="folder of JSON and figure")
    parser.add_argument("--quick", action="store_true", help="few steps, to see that it works")
    options = parser.parse_args(arguments)
    data = study(options.quick, say=print)
    data["sections"] = sections(data)
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "force_element.json").write_text(json.dumps(data, indent=1) + "\n")
    draw(data, options.output)
    print_tables(data)
    return 0
