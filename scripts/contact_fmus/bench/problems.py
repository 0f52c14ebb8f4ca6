"""The problems that are solved: the problems P1 to P3b, as their scenario files state them, those with friction and
rotation, those of many contacts and of the later pairs, and the stiffness sweep."""

import json
import math
import tempfile
import tomllib
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contact_fmus.building.cmake_build import How, build_fmus, check_scene, find_compiler
from contact_fmus.fmu.files import fmu_file, read_scene, repository
from contact_fmus.fmu.host import Case
from contact_fmus.fmu.variables import OPEN

SCENARIOS = {
    "P1": "p1_head_on_bounces",
    "P2": "p2_oblique_bounces",
    "P3": "p3_sliding_in_cylinder",
    "P3b": "p3b_bouncing_in_cylinder",
}
REFERENCES = Path(__file__).with_name("stiff_references.json")  # tests/support/reference/make_stiff_references.py
# make_scene_references.py, there too
TURNING, ISLANDS, PAIRS = (
    Path(__file__).with_name(f"{name}_references.json") for name in ("turning", "island", "pair")
)
# tests/support/reference/make_law_references.py
LAW_REFERENCES = Path(__file__).with_name("law_references.json")
LAW_PROBLEMS = Path(__file__).with_name("law_problems.toml")


@dataclass(frozen=True)
class Problem:
    """A motion from 0 to `stop` and where its bodies are then"""

    name: str
    title: str
    fmu: str
    stop: float  # s
    start: dict[str, Any] = field(hash=False)
    position: tuple[float, ...]  # x, y and z of each of `bodies`
    uncertainty: float = 0.0  # of `position`, m
    method: str = "Taylor series in quadruple precision"  # by which `position` was computed
    bodies: tuple[str, ...] = ("source",)
    contacts: tuple[str, ...] = ("contact",)

    @property
    def penalty_factor(self) -> float:
        return self.start.get("contact.penalty_factor", math.nan)

    def error(self, position: Any) -> float:
        return float(np.linalg.norm(np.asarray(position) - self.position))

    def end(self, outputs: dict[str, Any]) -> tuple[float, int]:
        """The error of what an FMU gave, and how many contacts it counted"""
        error = self.error(np.concatenate([outputs[f"{body}.position"] for body in self.bodies]))
        return error, sum(outputs[f"{contact}.onsets"] for contact in self.contacts)


@cache
def benchmarks() -> dict[str, Problem]:
    """P1, P2, P3 and P3b with the references of their scenario files"""
    found = {}
    for name, file in SCENARIOS.items():
        text = (repository() / "scripts" / "scenarios" / f"{file}.toml").read_text(encoding="utf-8")
        scenario = tomllib.loads(text)
        claim = next(one for one in scenario["claim"] if one.get("variable") == "source.position")
        title, stop = scenario["title"].partition(": ")[2], scenario["experiment"]["stop_time"]
        found[name] = Problem(name, title, scenario["fmu"], stop, scenario["start"], tuple(claim["expected"]))
    return found


@cache
def stored_problems(file: Path) -> dict[str, Problem]:
    """The problems of a file, which holds their references too"""
    rows = json.loads(file.read_text(encoding="utf-8"))
    rows = [{key: tuple(one) if isinstance(one, list) else one for key, one in row.items()} for row in rows]
    return {row["name"]: Problem(**{key: one for key, one in row.items() if key != "onsets"}) for row in rows}


def turning_problems() -> dict[str, Problem]:
    """F1 to F4, with friction and rotation"""
    return stored_problems(TURNING)


@cache
def law_benchmarks() -> dict[str, Problem]:
    """P1 to P3b by Hertz's law and over a rim, P1 and P2 on a plane, with their references"""
    ends, found = json.loads(LAW_REFERENCES.read_text(encoding="utf-8")), {}
    for row in tomllib.loads(LAW_PROBLEMS.read_text(encoding="utf-8"))["problem"]:
        base, without = benchmarks()[row.pop("base")], tuple(row.pop("without", ()))
        row["start"] = {key: one for key, one in base.start.items() if not key.startswith(without)} | row["start"]
        row |= {"position": tuple(ends.get(row["name"], ())), "method": "extrapolation in extended precision"}
        found[row["name"]] = replace(base, **row)
    return found


def law_problems(hertz: bool) -> dict[str, Problem]:
    """P1 to P3b by Hertz's law; or P1 and P2 on a plane, P1 to P3b over a rim"""
    return {name: one for name, one in law_benchmarks().items() if name.endswith("Hertz") == hertz}


# What the report measures error against time of: the name of the page's section, that of the ratios, and the problems
SETS = {
    "work_precision": ("ratios", benchmarks),
    "shapes": ("shape_ratios", lambda: law_problems(hertz=False)),
    "hertz": ("hertz_ratios", lambda: law_problems(hertz=True)),
    "turning": ("turning_ratios", turning_problems),
    "islands": ("island_ratios", lambda: stored_problems(ISLANDS)),
    "pairs": ("pair_ratios", lambda: stored_problems(PAIRS)),
}


@cache
def stiff_families() -> dict[str, list[Problem]]:
    """P3 in the cylinder and in a hollow sphere, damped to 10 % of the critical damping and undamped, by
    ascending penalty factor"""
    families: dict[str, list[Problem]] = {}
    for reference in json.loads(REFERENCES.read_text(encoding="utf-8")):
        name = f"stiff {reference['shape']}, {'damped' if reference['damping'] else 'undamped'}"
        families.setdefault(name, []).append(_stiff_problem(name, reference))
    return families


def _stiff_problem(name: str, reference: dict[str, Any]) -> Problem:
    base = benchmarks()["P3"]
    stiffness, damping = reference["penalty_factor"], reference["damping"]
    start = base.start | {"contact.penalty_factor": stiffness}
    if damping:
        start["contact.viscous_penalty_factor"] = 2 * damping * math.sqrt(start["source.mass"] * stiffness)
    else:
        start["contact.method"] = "penalty"
        del start["contact.viscous_penalty_factor"], start["contact.dashpot"]
    if reference["shape"] == "sphere":
        del start["destination.axis"]
    title, fmu, position = f"{name}, p_n = {stiffness:g} N/m", OPEN[reference["shape"]], tuple(reference["position"])
    known = {"uncertainty": reference["uncertainty"], "method": reference["method"]}
    return replace(base, name=name, title=title, fmu=fmu, start=start, position=position, **known)


# Ways to solve a benchmark problem: method, tolerance and number of communication steps

EVENT_DRIVEN, CVODE = "event_driven", ("cvode_bdf", "cvode_adams")
METHODS = (EVENT_DRIVEN, *CVODE)
CODES = {"radau5": "RADAU5", "kencarp4": "KenCarp4"}  # integrators of other authors, which use Model Exchange
ABSOLUTE = 1e-4  # absolute tolerance / relative tolerance, as in the start values
UNLIMITED = 1_000_000_000  # internal steps: CVODE takes seconds where bodies are stiff
STIFF_TOLERANCE = 1e-9  # of the runs that the stiffness tables show


class Setting(NamedTuple):
    """One way to solve a problem"""

    problem: Problem
    method: str
    tolerance: float
    steps: int

    @property
    def name(self) -> str:
        return f"{self.problem.title}, {self.method}, {self.tolerance:g}, {self.steps} steps"

    @property
    def where(self) -> str:
        stiffness = self.problem.penalty_factor  # NaN where a problem has several
        return f" at {self.tolerance:g}" + (f", p_n = {stiffness:g} N/m" if stiffness > 0.0 else "")

    def case(self) -> Case:
        problem = self.problem
        outputs = [f"{body}.position" for body in problem.bodies] + [f"{one}.onsets" for one in problem.contacts]
        known = (self.name, runnable(problem.fmu), problem.stop, self.steps)
        if self.method in CODES:
            codes = (self.method, moved_states(problem.start), ABSOLUTE * self.tolerance)
            return Case(*known, problem.start, self.tolerance, outputs, (), 0.0, *codes)
        start = {
            **problem.start,
            "solver.method": self.method,
            "solver.relative_tolerance": self.tolerance,
            "solver.absolute_tolerance": ABSOLUTE * self.tolerance,
            "solver.max_internal_steps": UNLIMITED,
        }
        return Case(*known, start, outputs=outputs)


@cache
def runnable(fmu: str) -> Path:
    """The shipped FMU; where its scene pins the method, an FMU of the same scene with the method open, for CVODE. It is
    built as contact-fmus build does it, in the user's cache."""
    shipped, pin = fmu_file(fmu), '"solver.method" = "event_driven"\n'
    if "solver.method" not in read_scene(shipped).pinned:
        return shipped
    text = (repository() / "modelDescription" / "scenes" / f"{fmu}.toml").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{fmu}.toml")
        file.write_text(text.replace(pin, "").replace(f'"{fmu}"', f'"{fmu}Open"'), encoding="utf-8")
        how = How(tuple(find_compiler(None)))
        return build_fmus([check_scene(file, Path(folder))], how, lambda _what: None)[0]


def moved_states(start: dict[str, Any]) -> list[str]:
    """The states that act on these problems, in which the source is a free sphere and friction is not elastic"""
    free = ["source", *["destination"] * (start.get("destination.motion") == "free")]
    turning = [body for body in free if start.get(f"{body}.rotation") == "free"]
    names = [f"{body}.{name}_state" for name in ("displacement", "velocity") for body in free]
    names += [f"{body}.angular_velocity_state" for body in turning]
    return names + [f"{body}.orientation_state" for body in turning if body == "destination"]
