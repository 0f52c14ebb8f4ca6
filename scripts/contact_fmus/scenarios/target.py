"""What a command is given by its user: an FMU or a scenario, as a file or by the name of a shipped one"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.files import fmu_file, fmus_folder, repository, shipped_fmus, unpack
from contact_fmus.fmu.scene import has_scene, read_scene
from contact_fmus.fmu.settings import read_settings
from contact_fmus.fmu.variables import read_variables

from .experiment import Scenario, Variant
from .inputs import InputSignal
from .scenario import read_scenario

STOP = 1.0  # s, where an FMU names no end of its own
STEPS = 1000  # communication steps where neither the user nor the FMU says how long they are
FORMS = {".fmu": "an FMU (.fmu)", ".toml": "a scenario (.toml)", ".csv": "a result (.csv)"}
RUNS = (".fmu", ".toml")
SCENARIOS = (".toml",)
ANY = tuple(FORMS)


@dataclass(frozen=True)
class Experiment:
    """What is run: an FMU with settings, or one variant of a scenario. Times in s"""

    name: str
    title: str
    fmu: Path
    start_time: float
    stop_time: float
    step: float
    tolerance: float | None = None
    values: dict[str, Any] = field(default_factory=dict)
    inputs: tuple[InputSignal, ...] = ()
    label: str = ""  # what tells it from the other runs of a scenario


def words(suffixes: Iterable[str] = RUNS) -> str:
    """The kinds of files in a sentence"""
    *first, last = (FORMS[suffix] for suffix in suffixes)
    return f"{', '.join(first)} or {last}" if first else last


def find(name: str, suffixes: tuple[str, ...] = RUNS) -> Path:
    """The file of this name, or the shipped FMU or scenario; UserError where there is no such thing"""
    path = Path(name)
    if not name:
        raise UserError(f"an empty name; {words(suffixes)} is needed")
    if path.is_dir():
        raise UserError(f"{name}: this is a folder; {words(suffixes)} is needed")
    if path.suffix in suffixes:
        if not path.is_file():
            near = [file.name for file in path.parent.glob(f"*{path.suffix}")]
            raise UserError(f"{name}: there is no such file{similar(path.name, near)}")
        return path
    if path.is_file():
        raise UserError(f"{name}: {words(suffixes)} is needed")
    scenarios = {file.stem: file for file in (repository() / "scripts" / "scenarios").glob("*.toml")}
    fmus = shipped_fmus() if ".fmu" in suffixes else []
    if name in fmus:
        return fmu_file(name)
    if name in scenarios:
        return scenarios[name]
    hint = similar(name, [*fmus, *scenarios])
    known = f"scenarios: {', '.join(sorted(scenarios))}"
    if ".fmu" in suffixes:
        known = f"FMUs: {', '.join(fmus) or f'none is built in {fmus_folder()}'}; {known}"
    kinds = "FMU or scenario" if ".fmu" in suffixes else "scenario"
    raise UserError(f"'{name}' is no {kinds}{hint}, and no file: {words(suffixes)}; {known}")


def first_run(path: Path) -> tuple[Experiment, str]:
    """An FMU's own default experiment or the first run of a scenario, and how many runs that has, if more"""
    if path.suffix == ".fmu":
        return of_fmu(path), ""
    scenario = _scenario(path)
    one, count = of_scenario(scenario, path, scenario.variants[0]), len(scenario.variants)
    return one, f"{path.name} varies: this is the first of {count} runs, {one.label}" if count > 1 else ""


def drawn_runs(path: Path) -> list[Experiment]:
    """An FMU's own default experiment, or the runs that a scenario compares"""
    if path.suffix == ".fmu":
        return [of_fmu(path)]
    scenario = _scenario(path)
    return [of_scenario(scenario, path, variant) for variant in scenario.plotted()]


def of_fmu(file: Path, kind: str = "coSimulation") -> Experiment:
    """An FMU's own default experiment; UserError where it is not of that kind of simulation"""
    description = unpack(file, kind=kind)[1]
    default = description.defaultExperiment

    def number(name: str) -> float | None:
        text = getattr(default, name, None)
        return float(text) if text else None

    start = number("startTime") or 0.0
    stop = number("stopTime") or start + STOP
    title = read_scene(file).title if has_scene(file) else description.modelName
    step = number("stepSize") or (stop - start) / STEPS
    return Experiment(file.stem, title, file, start, stop, step, number("tolerance"))


def of_scenario(scenario: Scenario, file: Path, variant: Variant) -> Experiment:
    """The scenario's FMU is a name, or a file beside the scenario's"""
    beside = file.parent / scenario.fmu
    try:
        fmu = beside if beside.suffix == ".fmu" and beside.is_file() else fmu_file(scenario.fmu)
    except FileNotFoundError as error:
        raise UserError(f"{file}: {error}") from None
    return Experiment(
        scenario.name,
        scenario.title,
        fmu,
        scenario.start_time,
        scenario.stop_time,
        (scenario.stop_time - scenario.start_time) / scenario.plot_steps,
        variant.tolerance,
        variant.start,
        tuple(scenario.inputs),
        variant.label,
    )


def changed(experiment: Experiment, settings: Iterable[str], stop: float | None = None) -> Experiment:
    """With what the user asked for. `settings`: NAME=VALUE"""
    values = read_settings(settings, read_variables(unpack(experiment.fmu, kind="")[1]), experiment.fmu)
    stop = experiment.stop_time if stop is None else stop
    if not experiment.start_time < stop < math.inf:
        raise UserError(f"--stop {stop:g}: a time after the start at {experiment.start_time:g} s is needed")
    step = min(experiment.step, stop - experiment.start_time)
    return dataclasses.replace(experiment, values=experiment.values | values, stop_time=stop, step=step)


def _scenario(file: Path) -> Scenario:
    """A scene is no scenario, which its file tells before read_scenario would complain of it"""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        table = {}  # read_scenario says what is wrong
    if "body" in table:
        raise UserError(f"{file}: this is a scene; contact-fmus build {file} makes the FMU that can be run")
    if "vary" in table and "outputs" in table:
        raise UserError(f"{file}: this is a study; contact-fmus sweep {file} runs it")
    return read_scenario(file)
