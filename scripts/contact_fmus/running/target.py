"""What `contact-fmus run` is given: an FMU's file or name, a scenario's file or name"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.files import fmu_file, fmus_folder, repository, unpack
from contact_fmus.scenarios.inputs import InputSignal
from contact_fmus.scenarios.scenario import read_scenario

STEPS = 1000  # communication steps where neither the user nor the FMU says how long they are


@dataclass(frozen=True)
class Experiment:
    """What is run: times in s"""

    name: str
    fmu: Path
    start_time: float
    stop_time: float
    step: float
    tolerance: float | None
    values: dict[str, Any] = field(default_factory=dict)
    inputs: list[InputSignal] = field(default_factory=list)
    note: str = ""


def find_experiment(target: str) -> Experiment:
    """UserError where there is no such thing"""
    path = Path(target)
    if path.suffix == ".toml" or (path.suffix != ".fmu" and _scenario_file(target).is_file()):
        return _scenario(path if path.suffix == ".toml" else _scenario_file(target))
    if path.suffix == ".fmu" or path.is_file():
        if not path.is_file():
            raise UserError(f"{target}: there is no such file")
        return _fmu(path)
    fmus = sorted(file.stem for file in fmus_folder().glob("*.fmu"))
    if target in fmus:
        return _fmu(fmu_file(target))
    scenarios = sorted(file.stem for file in _scenario_file("").parent.glob("*.toml"))
    hint = similar(target, [*fmus, *scenarios])
    built = ", ".join(fmus) or f"none is built in {fmus_folder()}"
    raise UserError(
        f"'{target}' is no file, FMU or scenario{hint}; FMUs: {built}; scenarios: {', '.join(scenarios)}"
    )


def _scenario_file(name: str) -> Path:
    return repository() / "scripts" / "scenarios" / f"{name}.toml"


def _fmu(file: Path) -> Experiment:
    """The FMU's own default experiment, where it has one"""
    default = unpack(file)[1].defaultExperiment

    def number(name: str) -> float | None:
        text = getattr(default, name, None)
        return float(text) if text else None

    start, tolerance = number("startTime") or 0.0, number("tolerance")
    stop = number("stopTime") or start + 1.0
    return Experiment(file.stem, file, start, stop, number("stepSize") or (stop - start) / STEPS, tolerance)


def _scenario(file: Path) -> Experiment:
    """The first run of a scenario; its FMU is a name, or a file beside the scenario's"""
    _refuse_scene(file)
    scenario = read_scenario(file)
    beside = file.parent / scenario.fmu
    fmu = beside if beside.suffix == ".fmu" and beside.is_file() else fmu_file(scenario.fmu)
    variant, count = scenario.variants[0], len(scenario.variants)
    step = (scenario.stop_time - scenario.start_time) / scenario.plot_steps
    note = f"{file.name} varies: this is the first of {count} runs, {variant.label}" if count > 1 else ""
    return Experiment(
        scenario.name,
        fmu,
        scenario.start_time,
        scenario.stop_time,
        step,
        variant.tolerance,
        variant.start,
        scenario.inputs,
        note,
    )


def _refuse_scene(file: Path) -> None:
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return  # read_scenario says what is wrong
    if "body" in table:
        raise UserError(f"{file}: this is a scene; contact-fmus build {file} makes the FMU that can be run")
