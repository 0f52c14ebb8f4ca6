#!/usr/bin/env python3
"""Runs tube.ssp in fmpy and by the master in master.py, against a reference, and prints a page of figures.

python examples/ssp/run_ssp.py [SSP] [PAGE]      default tube.ssp; PAGE: writes docs/ssp.md or another file

Make the .ssp first: python examples/ssp/make_ssp.py
"""

import sys
from pathlib import Path

import make_ssp as tube
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv
from master import Ways, run
from scipy.integrate import solve_ivp

FOLDER = Path(__file__).resolve().parent  # page.md there is the page without its figures
END = 0.5  # s: three bounces
SIZES = (4e-3, 2e-3, 1e-3, 5e-4)  # s; a contact lasts 9 ms
WAYS = {
    "values": Ways(),
    "and derivatives": Ways(derivatives=True),
    "and variable steps": Ways(derivatives=True, variable=True),
    "and repeated steps": Ways(derivatives=True, variable=True, repeat=True),
    "with directional derivatives": Ways(derivatives=True, variable=True, repeat=True, slope=True),
}


def reference(end=END):
    """Height of the ball and displacement of the carriage by scipy's DOP853, from touch to touch"""

    def gap(y):
        return tube.CLEARANCE - (y[2] - y[0])

    def rates(_, y):
        force = -tube.STIFFNESS * gap(y) - tube.DAMPING * (y[1] - y[3]) if touching else 0.0
        lift = tube.MASS * tube.GRAVITY - tube.SPRING * (tube.RAISED + y[2])
        return [y[1], force / tube.BALL - tube.GRAVITY, y[3], (lift - force) / tube.MASS - tube.GRAVITY]

    def event(_, y):
        return gap(y)

    event.terminal = True
    time, y, touching = 0.0, [tube.HEIGHT, 0.0, 0.0, 0.0], False
    while time < end:
        event.direction = 1 if touching else -1
        piece = solve_ivp(rates, (time, end), y, "DOP853", events=event, rtol=1e-13, atol=1e-15)
        time, y, touching = piece.t[-1], piece.y[:, -1], not touching
    return y[0], y[2]


def by_fmpy(ssp, size, end=END):
    """fmpy's importer of SSP: what the FMUs gave after one step is what they are given in the next"""
    found = simulate_ssp(
        ssp, stop_time=end - size / 2, step_size=size, parameter_set=read_ssv(ssp, "resources/start.ssv")
    )
    return found["Tube.source.position[3]"][-1], found["Carriage.source.displacement[3]"][-1]


def distance(found, expected):
    return max(abs(a - b) for a, b in zip(found[:2], expected, strict=True))


def rows(ssp, sizes=SIZES):
    """For each step size: the errors [m] of fmpy's run and of each way, and how these went"""
    expected = reference()
    for size in sizes:
        results = {name: run(ssp, ways, size, END) for name, ways in WAYS.items()}
        errors = {"fmpy": distance(by_fmpy(ssp, size), expected)}
        errors |= {name: distance(result, expected) for name, result in results.items()}
        yield size, errors, results


def table(heads, lines):
    text = [f"| {' | '.join(one)} |" for one in [heads, ["---:"] * len(heads), *lines]]
    return "\n".join(text) + "\n"


def page(ssp):
    errors, mismatch = [], []
    for size, found, results in rows(ssp):
        errors.append([f"{1e3 * size:g}", *(f"{1e3 * error:.2g}" for error in found.values())])
        chosen = list(WAYS)[2:]
        mismatch.append([f"{1e3 * size:g}", *(f"{results[name].mismatch:.2g}" for name in chosen)])
        mismatch[-1] += [str(results[name].taken_back) for name in chosen]
    names = ["variable steps", "repeated", "with directional derivatives"]
    heads = ["step, ms", *names, *(f"taken back: {name}" for name in names)]
    return (
        (FOLDER / "page.md")
        .read_text(encoding="utf-8")
        .format(errors=table(["step, ms", "fmpy", *WAYS], errors), mismatch=table(heads, mismatch))
    )


def main(ssp="tube.ssp", file=None):
    text = page(ssp)
    print(text)
    if file:
        Path(file).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
