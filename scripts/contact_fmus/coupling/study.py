"""The command force-element: error against communication step of a contact FMU used as a force element, and the
stable step. It writes force_element.json, .svg and .png and prints the table. outer_integrators.py has the
integrators and couplings.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from contact_fmus.options import parse
from contact_fmus.pages import Table, read_words, show, stopwatch, write_json
from contact_fmus.report.figures import STYLE, legend, panels, save
from contact_fmus.scenarios import closed_forms

from .outer_integrators import SCHEMES, Ball, FmuElement, LinearElement, Scheme, Tool, run

GRAVITY, STIFFNESS = 9.81, 1e6  # m/s^2, N/m; the ball has 1 kg
OMEGA, DEPTH = math.sqrt(STIFFNESS), GRAVITY / STIFFNESS  # rad/s, m: of a ball that lies on the wall
WALL = {
    "source.radius": 0.1,
    "source.center": [0.0, 0.0, 0.6],  # touching
    "destination.radius": 0.5,
    "contact.method": "penalty_dynamic",
    "contact.penalty_factor": STIFFNESS,
}
LOST = 10.0  # m from the start, where no scheme that works brings the ball
DAMPING_RATIO = 0.1  # of press and bounce
PLACES = 8  # of the impact of bounce between two communication points


def start_values(damping_ratio: float, dashpot: str) -> dict[str, Any]:
    return WALL | {"contact.viscous_penalty_factor": 2.0 * damping_ratio * OMEGA, "contact.dashpot": dashpot}


# Two problems with exact answers


class Trial(NamedTuple):
    """One run: where it starts, the step in s, how many steps; and the exact end that the error is measured from"""

    ball: Ball
    size: float
    steps: int
    end: tuple[float | None, float]  # displacement, where it counts, and velocity
    unit: float  # of the error


def press(step: float) -> Iterator[Trial]:
    """A ball pressed on a wall by gravity and pushed once: a damped oscillation that never leaves the wall.

    s and s' of s'' + 2 zeta omega s' + omega^2 s = 0 with s(0) = push, s'(0) = 0, for zeta < 1"""
    end, push = 10.0 / OMEGA, 0.1 * DEPTH
    turning, decay = OMEGA * math.sqrt(1.0 - DAMPING_RATIO**2), DAMPING_RATIO * OMEGA
    size, cosine, sine = push * math.exp(-decay * end), math.cos(turning * end), math.sin(turning * end)
    exact = size * (cosine + decay / turning * sine) - DEPTH, -size * OMEGA**2 / turning * sine
    steps = max(1, round(end / step))
    yield Trial(Ball(push - DEPTH, 0.0), end / steps, steps, exact, push)


def bounce(step: float) -> Iterator[Trial]:
    """One impact with a dashpot at 1 m/s, gravity off: the speed afterwards, for several places of the impact
    between two communication points"""
    exact = closed_forms.restitution("non_adhesive", DAMPING_RATIO)
    lasts = closed_forms.overlap_duration("non_adhesive", 1.0, STIFFNESS, 2.0 * DAMPING_RATIO * OMEGA)
    for place in range(PLACES):
        gap, steps = step * (place + 0.5) / PLACES, math.ceil(2.0 * lasts / step) + 4
        yield Trial(Ball(gap, -1.0), step, steps, (None, exact), 1.0)


class Problem(NamedTuple):
    title: str
    trials: Any  # of a communication step
    values: dict[str, Any]
    gravity: float

    @property
    def tool(self) -> Tool:
        return Tool(-self.gravity, STIFFNESS, 2.0 * DAMPING_RATIO * OMEGA)


PROBLEMS = {
    "bounce": Problem(
        "one impact: error of the speed afterwards", bounce, start_values(DAMPING_RATIO, "non_adhesive"), 0.0
    ),
    "press": Problem("lasting contact: error, of the push", press, start_values(DAMPING_RATIO, "unclamped"), GRAVITY),
}
# Communication steps in h omega
FULL = {
    "bounce": [math.pi / count for count in (1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 256)],
    "press": [0.4, 0.2, 0.1, 0.05, 0.025, 0.0125],
}
QUICK = {"bounce": FULL["bounce"][2:9:2], "press": FULL["press"][2:]}
WANTED = 0.01  # of the speed after an impact


def error_of(problem: Problem, scheme: Scheme, fmu: ContactFmu, step: float) -> float | None:
    """The worst error of the problem's trials; None where the ball has left the scene"""
    worst = 0.0
    for trial in problem.trials(step / OMEGA):
        element = FmuElement(fmu, problem.values)
        ball = run(scheme, element, problem.tool, trial.ball, trial.size, trial.steps, gone)
        if gone(ball):
            return None
        u, v = trial.end
        off = abs(ball.v - v) if u is None else math.hypot(ball.u - u, (ball.v - v) / OMEGA)
        worst = max(worst, off / trial.unit)
    return worst


def gone(ball: Ball) -> bool:
    return not abs(ball.u) < LOST


def order_between(steps: list[float], errors: list[float | None]) -> float | None:
    """The order of convergence is the slope of the last two errors that are there."""
    usable = [pair for pair in zip(steps, errors, strict=True) if pair[1]]
    if len(usable) < 2:
        return None
    (first, large), (last, small) = usable[-2:]
    return math.log(large / small) / math.log(first / last)


def steps_wanted(steps: list[float], errors: list[float | None]) -> float | None:
    """Communication steps in an undamped contact (pi/omega) from which on the error of a bounce stays small"""
    found = None
    for step, error in sorted(zip(steps, errors, strict=True)):
        if error is None or error > WANTED:
            break
        found = math.pi / step
    return found


# The largest communication step that keeps a lasting contact quiet: by theory and measured on the FMU.
#
# Theory: with F = -k u - c v a step of a scheme is a linear map of (u, v, last F), found column by column
# from a linear stand-in of the FMU; it keeps quiet while no eigenvalue is outside the unit circle. Measured:
# a ball pressed on a wall is pushed a little; the step is bisected between growing and not growing.

LEAST, MOST = 1e-2, 30.0  # in h omega; below: none, above: any
DAMPING_RATIOS = [0.0, 0.025, 0.5]


def spectral_radius(scheme: Scheme, step: float, damping_ratio: float) -> float:
    """The spectral radius of one step for m = k = 1, so that the step is h omega"""
    tool = Tool(0.0, 1.0, 2.0 * damping_ratio)
    element = LinearElement(tool.stiffness, tool.damping)
    columns = [scheme.step(element, tool, Ball(*unit), step) for unit in np.eye(3).tolist()]
    return float(np.max(np.abs(np.linalg.eigvals(np.array(columns).T))))


def bisected(quiet) -> float:
    """The step in h omega where quiet(step) ends: 0 for none, infinite for any"""
    steps = np.geomspace(LEAST, MOST, 25).tolist()
    loud = next((k for k, step in enumerate(steps) if not quiet(step)), None)
    if not loud:
        return math.inf if loud is None else 0.0
    low, high = steps[loud - 1], steps[loud]
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if quiet(middle) else (low, middle)
    return low


def stable_step_of_theory(scheme: Scheme, damping_ratio: float) -> float:
    return bisected(lambda step: spectral_radius(scheme, step, damping_ratio) <= 1.0 + 1e-9)


def stable_step_measured(fmu: ContactFmu, scheme: Scheme, damping_ratio: float, steps: int) -> float:
    tool, push = Tool(-GRAVITY, STIFFNESS, 2.0 * damping_ratio * OMEGA), 0.01 * DEPTH

    def quiet(step: float) -> bool:
        element, largest = FmuElement(fmu, start_values(damping_ratio, "unclamped")), [0.0]

        def noted(ball: Ball) -> bool:
            size = math.hypot(ball.u + DEPTH, ball.v / OMEGA)
            largest[-1] = max(largest[-1], size)
            return size > 30.0 * push

        ball = run(scheme, element, tool, Ball(push - DEPTH, 0.0), step / OMEGA, steps // 2, noted)
        largest.append(0.0)
        run(scheme, element, tool, ball, step / OMEGA, steps // 2, noted)
        return largest[1] <= 1.02 * largest[0] and largest[1] < 20.0 * push

    return bisected(quiet)


def measured(scheme: Scheme, fmu: ContactFmu, quick: bool) -> dict[str, Any]:
    """All of one scheme, ready for JSON: infinite stable steps are "any" there"""
    found: dict[str, Any] = {"integrator": scheme.integrator, "coupling": scheme.coupling}
    sizes = QUICK if quick else FULL
    for name, problem in PROBLEMS.items():
        found[name] = [error_of(problem, scheme, fmu, step) for step in sizes[name]]
    found["order"] = order_between(sizes["press"], found["press"])
    found["steps_wanted"] = steps_wanted(sizes["bounce"], found["bounce"])
    ratios, steps = (DAMPING_RATIOS[:1], 400) if quick else (DAMPING_RATIOS, 1000)
    theory = [stable_step_of_theory(scheme, ratio) for ratio in DAMPING_RATIOS]
    shown = [stable_step_measured(fmu, scheme, ratio, steps) for ratio in ratios]
    for name, limits in (("theory", theory), ("measured", shown)):
        found[name] = ["any" if math.isinf(one) else one or "none" for one in limits]
    return found


# The section of the report's page, the table on the terminal and the figure

FIGURE = "force_element"
LOOKS = {
    "at once": ("#1f6fb4", "-"),
    "held": ("#7f7f7f", ":"),
    "derivative 1": ("#e0a100", "-"),
    "derivatives 1, 2": ("#d95f02", "--"),
    "mean, predicted": ("#8e44ad", "-"),
    "mean, iterated": ("#2b9348", "-"),
}


def section(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The section of force_element.json (docs/report_parts.md)"""
    words = read_words(__file__)
    wanted = {row["coupling"]: row["steps_wanted"] for row in rows if row["integrator"] == "velocity Verlet"}
    counts = ", ".join(f"{count:.3g} ({coupling})" for coupling, count in wanted.items() if count)
    texts = [text.replace("{counts}", counts or "more than were tried") for text in words["paragraphs"]]
    figure = {"name": FIGURE, "caption": words["caption"]}
    return {"title": words["title"], "paragraphs": texts, "tables": [table(rows)], "figures": [figure]}


def table(rows: list[dict[str, Any]]) -> dict[str, Any]:
    header = ["integrator", "force"]
    for ratio in DAMPING_RATIOS:
        header += [f"stable h omega, zeta = {ratio:g}: theory", "measured"]
    cells = []
    for row in rows:
        limits = row["measured"] + [None] * (len(DAMPING_RATIOS) - len(row["measured"]))
        pairs = [one for pair in zip(row["theory"], limits, strict=True) for one in pair]
        numbers = [*pairs, row["order"] and float(f"{row['order']:.2g}"), row["steps_wanted"]]
        texts = [one if isinstance(one, str) else "–" if one is None else f"{one:.3g}" for one in numbers]
        cells.append([row["integrator"], row["coupling"], *texts])
    caption = "Stable step in units of 1/omega, measured order in lasting contact, steps an impact wants"
    return {"caption": caption, "header": [*header, "order", "steps per contact for 1 %"], "rows": cells}


def draw(rows: list[dict[str, Any]], sizes: dict[str, list[float]], folder: Path) -> None:
    """A line for each problem, a column for each integrator, a colour for each coupling"""
    integrators = list(dict.fromkeys(row["integrator"] for row in rows))
    with mpl.rc_context(fname=STYLE):
        figure, axes = panels(len(PROBLEMS), len(integrators), 6.6)
        for place, (name, integrator) in enumerate((n, i) for n in PROBLEMS for i in integrators):
            for row in (one for one in rows if one["integrator"] == integrator):
                errors = [error if error and error < 10.0 else math.nan for error in row[name]]
                color, line = LOOKS[row["coupling"]]
                axes[place].plot(sizes[name], errors, line, marker="o", ms=3, color=color, label=row["coupling"])
            axes[place].axvline(2.0, color="#aaaaaa", lw=0.8)
            axes[place].set_title(integrator)
            axes[place].set_xlabel("communication step h ω")
            axes[place].set_ylabel(PROBLEMS[name].title if place % len(integrators) == 0 else "")
        legend(figure, len(LOOKS))
        save(figure, folder, FIGURE)


def main(arguments: list[str] | None = None) -> int:
    options = parse("force-element", arguments)
    say, rows = stopwatch(), []
    with ContactFmu(fmu_file("SphereSphere")) as fmu:
        for scheme in SCHEMES:
            rows.append(measured(scheme, fmu, options.quick))
            say(f"{scheme.integrator}, {scheme.coupling}")
    options.output.mkdir(parents=True, exist_ok=True)
    sizes = QUICK if options.quick else FULL
    content = {"quick": options.quick, "steps": sizes, "damping_ratios": DAMPING_RATIOS, "schemes": rows}
    write_json(options.output / "force_element.json", content | {"sections": [section(rows)]})
    draw(rows, sizes, options.output)
    show(Table(**table(rows), numbers=2))
    return 0
