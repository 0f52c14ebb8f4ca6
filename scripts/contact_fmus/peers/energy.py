"""The command energy: an undamped ball that bounces for 10 s, as CENIC's authors show it; energy.json and its figure

It is P1, head-on, so that the sphere acts as a plane does. Each instant is the end of a run of its own, so that looking
at the energy disturbs no integrator."""

import contextlib
import dataclasses
import itertools
import math
import statistics
from collections.abc import Iterator, Sequence

import matplotlib as mpl

from contact_fmus.bench.problems import CODES, METHODS, Setting, benchmarks
from contact_fmus.fmu.host import HostError, run_host
from contact_fmus.options import parse
from contact_fmus.pages import read_words, stopwatch, write_json
from contact_fmus.report import measure, tables
from contact_fmus.report.figures import FLOOR, STYLE, legend, panels, save

from .command import PEERS, QUICK, Measured, Worker
from .problems import BallAndWall, Case, problem_of

TIMES, TOLERANCES = [0.5 * k for k in range(1, 21)], (1e-6, 1e-9)
Found = tuple[list[str], list[Measured]]  # solver, law, setting and communication steps; each instant


def change(ball: BallAndWall, state: Sequence[float]) -> float:
    """The change of the energy since the start, that of the penalty spring included, over m g h of the fall"""
    deep = max(ball.touching_distance - math.hypot(*state[:3]), 0.0)
    lifted = (sum(v * v for v in state[3:]) + ball.stiffness / ball.mass * deep**2) / (2 * ball.gravity)
    return (state[2] - ball.position[2] + lifted) / (ball.position[2] - ball.touching_distance)


def own(plan: measure.Plan) -> Iterator[Found]:
    """The FMU's solvers, and others' codes on its Model Exchange, which have no communication steps"""
    ball, wanted = dataclasses.replace(benchmarks()["P1"], stop=TIMES[-1]), ("source.position", "source.velocity")
    kinds = [*itertools.product(METHODS, plan.communication_steps), *((code, None) for code in CODES)]
    for (method, steps), tolerance in itertools.product(kinds, TOLERANCES):
        case = Setting(ball, method, tolerance, 1).case()
        counts = [max(1, round((steps or 1) * time / ball.stop)) for time in TIMES]
        cases = [dataclasses.replace(case, stop=t, steps=n, outputs=wanted) for t, n in zip(TIMES, counts, strict=True)]
        try:
            results = run_host(cases, plan.repeat, timeout=20 * plan.limit)
            found = [Measured(one.times, [x for name in wanted for x in one.outputs[name]]) for one in results]
        except HostError as error:
            found = [Measured(error=str(error))]
        setting = f"{measure.RELATIVE_TOLERANCE} {tolerance:g}"
        yield [CODES.get(method, method), measure.SAME, setting, str(steps or tables.MISSING)], found


def of_peers() -> Iterator[Found]:
    ball = problem_of("P1")
    for name, peer in PEERS.items():
        with contextlib.closing(Worker(f"contact_fmus.peers.{name}_peer")) as worker:
            for row, parameter in ((run, one) for run in peer["runs"] for one in run.get("energy", ())):
                case = Case(row["integrator"], row["settings"][-1], parameter, row.get("law", measure.SAME))
                found = [worker.ask(ball._replace(end=time), case, QUICK)[0] for time in TIMES]
                setting = f"{case.setting} {parameter:g}"
                yield [f"{peer['name']} {case.integrator}", case.law, setting, tables.MISSING], found


def main(arguments: list[str] | None = None) -> int:
    options, say, cells = parse("energy", arguments), stopwatch(), []
    options.output.mkdir(parents=True, exist_ok=True)
    runs = own(measure.QUICK if options.quick else measure.FULL)
    with mpl.rc_context(fname=STYLE):
        figure, (panel,) = panels(1, 1, 6.0)
        for known, found in itertools.chain(runs, of_peers() if options.peers else ()):
            say(", ".join(known))
            if found[-1].error:
                cells.append([*known, found[-1].error, *[tables.MISSING] * 4])
                continue
            sizes = [abs(change(problem_of("P1"), one.state)) for one in found]
            shown = [*(sizes[TIMES.index(time)] for time in (1.0, 5.0, 10.0)), max(sizes)]
            cells.append([*known, tables.seconds(statistics.median(found[-1].times)), *(f"{x:.1e}" for x in shown)])
            if known[-1] in (tables.MISSING, "1"):
                look = {"marker": ".sv"[len(panel.lines) // 10], "ms": 4, "lw": 1}  # there are ten colors
                label = f"{known[0]}, {known[2].split()[-1]}"
                panel.plot(TIMES, [max(size, FLOOR) for size in sizes], label=label, **look)
        panel.set(xscale="linear", xlabel="time, s", ylabel="change of the energy over m g h")
        legend(figure, 3)
        save(figure, options.output, "energy")
    words = read_words(__file__)["energy"]
    words |= {"tables": [words.pop("table") | {"rows": cells}], "figures": [words.pop("figure")]}
    write_json(options.output / "energy.json", {"sections": [words]})
    return 0
