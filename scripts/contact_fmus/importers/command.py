"""The command importers: FMUs in every importer that is installed, compared with fmpy"""

import json
import math
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import jinja2
import platformdirs
from rich.console import Console

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import file_or_shipped, unpack
from contact_fmus.options import parse

# Some importers report success for an FMU that never ran: numbers are compared, always.
RUNNERS = Path(__file__).resolve().parent / "runners"
SECONDS = 900  # a run takes less than one; the rest is a busy machine

# An importer that makes fmpy's calls at fmpy's times gets fmpy's bits. One that adds up its clock makes steps that
# differ by rounding; most FMUs then differ by 1e-14. docs/importers.md says which scenes multiply such roundings.
AGREE = 1e-12

TEXT = {"capture_output": True, "text": True, "check": False}


@dataclass(frozen=True)
class Importer:
    name: str
    registry: str
    module: str  # of Python; empty for Java, see prepared_java
    script: str
    fmi3: bool = True  # False where nobody has tried


ROWS = tomllib.loads(Path(__file__).with_name("importers.toml").read_text(encoding="utf-8"))
IMPORTERS = tuple(Importer(name, **row) for name, row in ROWS.items())
Programs = dict[str, list[str]]  # how a command for an importer of Java begins, by its name


@dataclass(frozen=True)
class Given:
    """What is asked of every importer"""

    step: float  # s
    count: int
    python: Path
    java: Programs
    settings: dict[str, int] = field(default_factory=dict)  # choices by name, set before the start


@dataclass
class Trial:
    """An FMU in an importer"""

    importer: Importer
    fmu: str
    version: str = ""
    values: dict[str, float] = field(default_factory=dict)
    problem: str = ""  # one line; empty where it ran

    def difference(self, other: Self) -> float:
        """The largest, relative to values above 1 and absolute below; infinite where the other did not run"""
        pairs = [(self.values[name], value) for name, value in other.values.items()]
        off = [abs(a - b) / max(1.0, abs(b)) for a, b in pairs]
        return max(off) if off and all(map(math.isfinite, off)) else math.inf


def installed(importer: Importer, python: Path, java: Programs) -> bool:
    if not importer.module:
        return importer.name in java
    return _done([str(python), "-c", f"import {importer.module}"])


def prepared_java(folder: Path) -> Programs:
    """Maven and javac fill the folder. A program that cannot be had is left out."""
    programs = {}
    fmi4j, maestro = folder / "fmi4j", folder / "maestro"
    source = RUNNERS / "WithFmi4j.java"
    compiling = ["javac", "-cp", f"{fmi4j}/*", "-d", str(fmi4j), str(source)]
    if _fetched(RUNNERS / "pom.xml", fmi4j) and _done(compiling):
        programs["FMI4j"] = ["java", "-cp", f"{fmi4j}/*:{fmi4j}", source.stem]
    if _fetched(RUNNERS / "maestro.xml", maestro, "-DexcludeTransitive=true"):
        (jar,) = maestro.glob("*.jar")
        programs["Maestro"] = [sys.executable, str(RUNNERS / "with_maestro.py"), str(jar)]
    return programs


def _fetched(project: Path, folder: Path, *options: str) -> bool:
    """The libraries that a project of Maven names"""
    copying = ["mvn", "-q", "-B", "-f", str(project), "dependency:copy-dependencies", *options]
    return any(folder.glob("*.jar")) or _done([*copying, f"-DoutputDirectory={folder}"])


def _done(command: list[str]) -> bool:
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def outputs(fmu: Path) -> dict[str, int]:
    """Outputs of one number each, by name. In FMI 3.0 vectors are arrays, which few importers read."""
    variables = unpack(fmu, kind="")[1].modelVariables
    numbers = [v for v in variables if v.type in ("Real", "Float64") and not v.dimensions]
    return {v.name: v.valueReference for v in numbers if v.causality == "output"}


def chosen(fmu: Path, settings: dict[str, int]) -> list[str]:
    """Settings as the runners read them. FMI sets enumerations as it sets integers."""
    variables = {v.name: v for v in unpack(fmu, kind="")[1].modelVariables}
    for name in settings:
        if name not in variables or variables[name].type not in ("Integer", "Enumeration", "Int64"):
            raise UserError(f"{fmu}: there is no Integer or Enumeration {name!r}")
    return [f"{name}={variables[name].valueReference}:={value}" for name, value in settings.items()]


def tried(importer: Importer, fmu: Path, given: Given) -> Trial:
    """The importer runs in a folder of its own, where it may write logs."""
    program = given.java.get(importer.name) or [str(given.python), str(RUNNERS / importer.script)]
    names = [f"{name}={reference}" for name, reference in outputs(fmu).items()]
    settings = chosen(fmu, given.settings)
    command = [*program, str(fmu.resolve()), repr(given.step), str(given.count), *settings, *names]
    trial = Trial(importer, fmu.stem)
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    with tempfile.TemporaryDirectory() as folder:
        try:
            run = subprocess.run(command, cwd=folder, env=environment, timeout=SECONDS, **TEXT)
        except subprocess.TimeoutExpired:
            trial.problem = f"no answer within {SECONDS} s"
            return trial
    lines = [line for line in run.stdout.splitlines() if line.startswith('{"version"')]
    if run.returncode or not lines:
        killed = f"ended by signal {-run.returncode}"
        status = killed if run.returncode < 0 else f"status {run.returncode}"
        lines = (run.stderr.strip() or run.stdout.strip() or status).splitlines()
        of_java = r"Exception in thread \"main\" [\w.]+: "
        said = next((line for line in lines if re.match(of_java, line)), lines[-1])
        said = re.sub(of_java, "", said)
        trial.problem = re.sub(r"/\S*/", "", said)[-160:]  # whose folders differ from run to run
        return trial
    found = json.loads(lines[-1])
    trial.version, trial.values = found["version"], found["values"]
    return trial


# docs/importers.md: the table of what was tried, and what to click or write in tools that were not

PAGE = Path(__file__).with_name("page.md")


def page(tables: dict[int, list[str]], step: float, count: int) -> str:
    """The page has a table for each version of FMI."""
    template = jinja2.Template(PAGE.read_text(encoding="utf-8"), trim_blocks=True, keep_trailing_newline=True)
    return template.render(tables=tables, count=count, step=f"{step:g}", agree=f"{AGREE:g}")


def table(trials: list[Trial], present: list[Importer], importers: Sequence[Importer] = IMPORTERS) -> list[str]:
    """Its lines: a row for each FMU, a column for each importer"""
    fmus = list(dict.fromkeys(trial.fmu for trial in trials))
    found = {(trial.importer.name, trial.fmu): trial for trial in trials}
    versions = {trial.importer.name: trial.version for trial in trials if trial.version}
    heads = [f"{one.name} {versions.get(one.name, '')} ({one.registry})".replace("  ", " ") for one in importers]
    lines = [f"| FMU | {' | '.join(heads)} |", f"| --- | {' | '.join('---' for _ in heads)} |"]
    problems: dict[str, str] = {}
    for fmu in fmus:
        cells = [
            _cell(found[one.name, fmu], found["fmpy", fmu], problems) if one in present else "not installed"
            for one in importers
        ]
        lines.append(f"| {fmu} | {' | '.join(cells)} |")
    if problems:
        lines += ["", *(f"- {name} refuses: {text}" for name, text in problems.items())]
    return lines


def _cell(trial: Trial, reference: Trial, problems: dict[str, str]) -> str:
    if trial.problem:
        problems[trial.importer.name] = trial.problem
        return "refused"
    if trial is reference:
        return "reference"
    off = trial.difference(reference)
    return ("0" if off == 0.0 else f"{off:.0e}") + ("" if off <= AGREE else " **differs**")


def main(arguments: list[str] | None = None) -> int:
    """0: every importer that ran an FMU agrees with fmpy; 1: one does not, or refuses one; 2: no such FMU"""
    options = parse("importers", arguments)
    python = options.python or Path(sys.executable)
    files = [file_or_shipped(name) for name in options.fmus]
    for fmu in files:
        if not fmu.is_file():
            raise UserError(f"{fmu}: there is no such file")
    if not (options.steps > 0 and 0.0 < options.step < 1e6):
        raise UserError("--steps and --step: (allowed: at least 1 step of more than 0 and less than 1e6 s)")
    java = prepared_java(Path(platformdirs.user_cache_path("contact-fmus")) / "importers")
    present = [importer for importer in IMPORTERS if installed(importer, python, java)]
    given = Given(options.step, options.steps, python, java, dict(options.set))
    console, good, tables = Console(stderr=True), True, {}
    for version in (2, 3):
        fmus = [fmu for fmu in files if unpack(fmu, kind="")[1].fmiVersion.startswith(f"{version}.")]
        taking = [importer for importer in IMPORTERS if version == 2 or importer.fmi3]
        trials = []
        for fmu in fmus:
            with console.status(fmu.stem):
                trials += [tried(importer, fmu, given) for importer in taking if importer in present]
        good = told(trials) and good
        if fmus:
            tables[version] = table(trials, present, taking)
    if options.output:
        options.output.write_text(page(tables, options.step, options.steps), encoding="utf-8")
    return 0 if good else 1


def told(trials: list[Trial]) -> bool:
    """Prints a line each; whether all agree"""
    references = {trial.fmu: trial for trial in trials if trial.importer.name == "fmpy"}
    good = True
    for trial in trials:
        off = None if trial.problem else trial.difference(references[trial.fmu])
        good = good and off is not None and off <= AGREE
        print(f"{trial.fmu}: {trial.importer.name}: {trial.problem or f'differs by {off:.1e}'}")
    return good
