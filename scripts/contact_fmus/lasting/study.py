"""Lasting stiff contact by steps of one size: Radau IIA against the FMU's exponential collocation.

    python -m contact_fmus lasting --output DIR [--quick]

writes lasting.json, .svg and .png into DIR and prints the tables of docs/lasting_contact.md. The problem is
P3, a ball that swings to and fro along the wall of a hollow cylinder for 2 s: damped to a tenth of the
critical damping, and undamped. build/lasting_contact (scripts/tools/lasting_contact) computes it with both
methods in C; the references are those of the stiffness sweep.
"""

from __future__ import annotations

import argparse
import functools
import json
import math
import os
import subprocess
from dataclasses import asdict
from pathlib import Path

from contact_fmus.fmu.files import repository

from .page import draw, print_tables
from .point import Method, Point
from .radau import coefficients

MASS, GRAVITY, END = 0.1, 9.81, 2.0
DAMPING = 0.1  # of the critical one
PENALTIES = {DAMPING: (1e5, 1e7, 1e9, 1e11, 1e15), 0.0: (1e5, 1e7, 1e9, 1e11)}
COUNTS = (5, 10, 20, 40, 100, 200, 400)  # steps of 0.4 s to 0.005 s
STAGES = (3, 5, 8, 12)
REFERENCES = Path(__file__).parents[1] / "bench" / "stiff_references.json"


EXPONENTIAL = Method("exponential")
METHODS = [Method(program, stages) for program in ("space", "plane") for stages in STAGES] + [EXPONENTIAL]


def amplitude(penalty: float) -> float:
    """Of the undamped oscillation: let go where it just touches, while the spring is to carry m g / 2 [m]"""
    return 0.5 * MASS * GRAVITY / penalty


@functools.cache
def reference(damping: float, penalty: float) -> tuple[float, float]:
    for row in json.loads(REFERENCES.read_text(encoding="utf-8")):
        if (row["shape"], row["damping"], row["penalty_factor"]) == ("cylinder", damping, penalty):
            return row["position"][0], row["position"][2]
    raise KeyError((damping, penalty))


def program() -> Path:
    """build/lasting_contact, or in the build folder that the environment variable CONTACT_BUILD names"""
    return Path(os.environ.get("CONTACT_BUILD") or repository() / "build") / "lasting_contact"


_coefficients = functools.cache(coefficients)


def measure(method: Method, damping: float, penalty: float, count: int, runs: int = 1) -> Point:
    viscous = 2.0 * damping * math.sqrt(penalty * MASS)
    arguments = [method.program, repr(penalty), repr(viscous), repr(END), str(count), str(runs)]
    given = _coefficients(method.stages) if method.stages else ""
    ran = subprocess.run(
        [str(program()), *arguments], input=given, capture_output=True, text=True, check=True, timeout=3600
    )
    said = json.loads(ran.stdout)
    point = {"method": method.name, "damping": damping, "penalty": penalty, "step": END / count}
    if "failed" in said:
        return Point(**point)
    error = math.dist(said["position"], reference(damping, penalty))
    kept = ("iterations", "evaluations", "solves", "seconds")
    return Point(**point, error=error, **{name: said[name] for name in kept})


def in_turns(damping: float, penalty: float, count: int, runs: int, rounds: int) -> list[Point]:
    """All methods one after the other, several times, and the least time of each"""
    taken = [[measure(method, damping, penalty, count, runs) for method in METHODS] for _ in range(rounds)]
    return [min(turns, key=lambda point: point.seconds) for turns in zip(*taken, strict=True)]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="contact-fmus lasting", description="Radau IIA against exponential collocation"
    )
    parser.add_argument("--output", type=Path, required=True, help="folder of the results")
    parser.add_argument("--quick", action="store_true", help="each once, to see that it works")
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    runs, rounds = (1, 1) if options.quick else (10, 4)
    points = [
        point
        for damping, penalties in PENALTIES.items()
        for penalty in penalties
        for count in COUNTS
        for point in in_turns(damping, penalty, count, runs, rounds)
    ]
    text = json.dumps([asdict(point) for point in points], indent=1)
    (options.output / "lasting.json").write_text(text + "\n", encoding="utf-8")
    draw(points, [amplitude(penalty) for penalty in PENALTIES[0.0]], options.output)
    print_tables(points)
    return 0
