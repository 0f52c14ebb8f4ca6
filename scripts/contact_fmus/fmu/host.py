"""FMUs timed by the C program fmu_host (scripts/tools/fmu_host), named as a user names things.

    case = Case("P1", fmu_file("SphereSphere"), stop=5.0, steps=997, tolerance=1e-9,
                start={"contact.method": "penalty", "source.center": [0, 0, 1.1]},
                outputs=["source.position", "contact.onsets"])
    result = run_host([case], repeat=20)[0]
    result.least, result.median          # s of stepping
    result.outputs["source.position"]    # numpy array

Several cases take turns in one process (A B A B ...), so that ratios of their times mean something on a busy
machine. Any FMI 2.0 co-simulation FMU of this platform will do; with `integrator` one of Model Exchange.
"""

import json
import os
import statistics
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from contact_fmus.errors import RunFailure

from .files import repository, unpack
from .variables import Variable, numbers_of, read_variables, value_of

TYPES = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}


class HostError(RunFailure):
    """The host or an FMU refused; the text is what it said."""


class HostTimeout(HostError):
    """The host took longer than it was given and was ended."""


@dataclass
class Case:
    """One experiment; names and values of variables are those of ContactFmu"""

    name: str
    fmu: Path
    stop: float  # s
    steps: int = 1  # communication steps, all of one size
    start: dict[str, Any] = field(default_factory=dict)
    tolerance: float | None = None  # what fmi2SetupExperiment is given
    outputs: Sequence[str] = ()  # read at the end
    get: Sequence[Sequence[str]] = ()  # each: one fmi2GetReal of these names after every communication step
    start_time: float = 0.0
    integrator: str = ""  # of Model Exchange: radau5 or kencarp4
    states: Sequence[str] = ()  # that it moves: displacements, velocities in the same order, others
    absolute_tolerance: float = 0.0  # of the integrator


@dataclass
class Result:
    """The measurements of a case"""

    name: str
    times: list[float]  # s of stepping, one a run
    initialization: list[float]  # s, one a run
    outputs: dict[str, Any]  # of the last run
    error: str = ""  # why there are no times and outputs, where run_host keeps going

    @property
    def least(self) -> float:
        return min(self.times)

    @property
    def median(self) -> float:
        return statistics.median(self.times)


def host_file() -> Path:
    """build/fmu_host, or in the build folder that the environment variable CONTACT_BUILD names"""
    path = Path(os.environ.get("CONTACT_BUILD") or repository() / "build") / "fmu_host"
    if not path.is_file():
        raise FileNotFoundError(f"{path} does not exist: build it first (cmake --build --preset default)")
    return path


def run_host(
    cases: Sequence[Case],
    repeat: int = 1,
    *,
    burst: int = 1,
    fresh: bool = False,
    budget: float | None = None,
    timeout: float | None = None,
    keep_going: bool = False,
) -> list[Result]:
    """Gives each case `repeat` turns of `burst` runs.

    `budget`: a case is not run again once its runs took so many seconds. `timeout`: seconds for all of it.
    `fresh`: a new instance for each run, instead of fmi2Reset. `keep_going`: where an FMU refuses, its
    Result has an `error`; otherwise HostError is raised."""
    command = [str(host_file()), "--repeat", str(repeat), "--burst", str(burst)]
    command += ["--fresh"] if fresh else []
    command += ["--budget", repr(budget)] if budget is not None else []
    for case in cases:
        command += case_arguments(case)
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        raise HostTimeout(f"{', '.join(case.name for case in cases)}: not done after {timeout} s") from None
    lines = run.stdout.splitlines()
    if run.returncode != 0 and not (keep_going and run.returncode == 1 and len(lines) == len(cases)):
        raise HostError(run.stderr.strip() or f"{command[0]} ended with status {run.returncode}")
    return [_result(case, json.loads(line)) for case, line in zip(cases, lines, strict=True)]


def case_arguments(case: Case) -> list[str]:
    """The host's options for one case"""
    folder, description = unpack(case.fmu, "2.0")
    variables = read_variables(description)
    identifier = description.coSimulation.modelIdentifier
    arguments = ["--case", case.name, "--guid", description.guid]
    arguments += ["--library", str(folder / "binaries" / "linux64" / f"{identifier}.so")]
    arguments += ["--resources", (folder / "resources").as_uri()]
    arguments += ["--start-time", repr(float(case.start_time)), "--stop-time", repr(float(case.stop))]
    arguments += ["--steps", str(case.steps)]
    arguments += ["--tolerance", repr(float(case.tolerance))] if case.tolerance is not None else []
    for name, value in case.start.items():
        variable = _variable(case, variables, name)
        for reference, number in zip(variable.references, numbers_of(variable, value), strict=True):
            number = int(number) if variable.type == "Boolean" else number
            arguments += [f"--set-{TYPES[variable.type]}", f"{reference}={number!r}"]
    if case.integrator:
        states = [one.variable.derivative.name.partition("[")[0] for one in description.derivatives]
        moved = [place for name in case.states for place, state in enumerate(states) if state == name]
        displacements = sum("displacement" in states[place] for place in moved)
        numbers = [len(states), description.numberOfEventIndicators, displacements, *moved]
        arguments += ["--integrator", case.integrator, "--absolute", repr(case.absolute_tolerance)]
        arguments += ["--states", ",".join(map(str, numbers))]
    for names in case.get:
        references = [_variable(case, variables, name).references for name in names]
        arguments += ["--get", ",".join(str(one) for group in references for one in group)]
    for name in case.outputs:
        variable = _variable(case, variables, name)
        arguments += [f"--read-{TYPES[variable.type]}", ",".join(map(str, variable.references))]
    return arguments


def _variable(case: Case, variables: dict[str, Variable], name: str) -> Variable:
    if name not in variables:
        raise KeyError(f"case {case.name}: {case.fmu.name} has no variable '{name}'")
    return variables[name]


def _result(case: Case, line: dict[str, Any]) -> Result:
    if "error" in line:
        return Result(line["case"], [], [], {}, line["error"])
    variables, outputs = read_variables(unpack(case.fmu)[1]), {}
    for name in case.outputs:
        variable = variables[name]
        values = [line[TYPES[variable.type]][str(reference)] for reference in variable.references]
        # A value that is not finite comes as null.
        outputs[name] = value_of(variable, [np.nan if value is None else value for value in values])
    return Result(line["case"], line["stepping_s"], line["initialization_s"], outputs)
