"""Reads a scenario file (docs/scenarios.md): one experiment with one FMU and what it claims.

Errors are UserError: file, place, what is wrong and what is allowed, in one line.
"""

import dataclasses
import inspect
import itertools
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError, read_toml, similar
from contact_fmus.fmu.files import FMI3, fmu_file, fmus_folder, has_scene, read_scene, repository, shipped_fmus, unpack
from contact_fmus.fmu.variables import read_settings, read_variables

from . import claims
from .experiment import Claim, Experiment, InputSignal, Scenario, Variant

NUMBER = (int, float)
TOP = dict.fromkeys(("title", "description", "fmu"), str) | dict.fromkeys(("input", "claim"), list)
TOP |= dict.fromkeys(("experiment", "start", "vary", "plot"), dict)
EXPERIMENT = {"stop_time": NUMBER, "steps": int, "tolerance": NUMBER, "start_time": NUMBER}
INPUT = {"variable": str, "derivative_of": str, "derivatives": int, "times": list, "values": list}
INPUT |= dict.fromkeys(("offset", "amplitude"), (*NUMBER, list)) | dict.fromkeys(("frequency", "phase"), NUMBER)
CLAIM = {"check": str, "text": str, "absolute": NUMBER, "relative": NUMBER, "when": dict}
PLOT = {"steps": int, "compare": str}
VARIED_SETTINGS = ("steps", "tolerance")


def read_scenario(path: Path) -> Scenario:
    table = read_toml(path)
    if "body" in table:
        raise UserError(f"{path}: this is a scene; contact-fmus build {path} makes the FMU that can be run")
    if "vary" in table and "outputs" in table:
        raise UserError(f"{path}: this is a study; contact-fmus sweep {path} runs it")
    place = str(path)
    _check(place, table, TOP, required=("title", "fmu", "experiment"))
    experiment = table["experiment"]
    _check(f"{place}: [experiment]", experiment, EXPERIMENT, required=("stop_time", "steps"))
    start_time, stop_time = float(experiment.get("start_time", 0.0)), float(experiment["stop_time"])
    if not stop_time > start_time:
        raise UserError(f"{place}: [experiment]: stop_time {stop_time} is not after start_time {start_time}")
    variants = _variants(place, experiment, table.get("start", {}), table.get("vary", {}))
    plot = table.get("plot", {})
    _check(f"{place}: [plot]", plot, PLOT)
    _positive(f"{place}: [plot]", plot.get("steps", 1))
    if plot.get("compare") not in (None, *table.get("vary", {})):
        raise UserError(f"{place}: [plot]: compare = '{plot['compare']}' is not a name of [vary]")
    return Scenario(
        Path(path).stem,
        table["title"],
        table.get("description", "").strip(),
        table["fmu"],
        start_time,
        stop_time,
        variants,
        _inputs(place, table.get("input", [])),
        [
            _claim(f"{place}: [[claim]] {number}", entry, table.get("vary", {}))
            for number, entry in enumerate(table.get("claim", []), 1)
        ],
        plot.get("steps", max(variant.steps for variant in variants)),
        plot.get("compare"),
    )


def _variants(place: str, experiment: dict, start: dict, vary: dict) -> list[Variant]:
    for name, values in vary.items():
        if not isinstance(values, list) or not values:
            raise UserError(f"{place}: [vary]: {name} needs a list of values")
    variants = []
    for values in itertools.product(*vary.values()):
        choice = dict(zip(vary, values, strict=True))
        steps = choice.get("steps", experiment["steps"])
        _positive(f"{place}: steps", steps)
        tolerance = choice.get("tolerance", experiment.get("tolerance"))
        chosen = {name: value for name, value in choice.items() if name not in VARIED_SETTINGS}
        variants.append(Variant(choice, start | chosen, steps, tolerance))
    return variants


def _inputs(place: str, entries: list) -> list[InputSignal]:
    signals: dict[str, InputSignal] = {}
    for number, entry in enumerate(entries, 1):
        here = f"{place}: [[input]] {number}"
        _check(here, entry, INPUT, required=("variable",))
        options = {key: value for key, value in entry.items() if key not in ("variable", "derivatives")}
        if "derivative_of" in options:
            if options["derivative_of"] not in signals:
                raise UserError(f"{here}: derivative_of = '{options['derivative_of']}' is no input before it")
            options = {"derivative_of": signals[options["derivative_of"]]}
        try:
            signals[entry["variable"]] = InputSignal.make(entry["variable"], entry.get("derivatives", 0), options)
        except ValueError as error:
            raise UserError(f"{here}: {error}") from None
    return list(signals.values())


def _claim(place: str, entry: dict, vary: dict) -> Claim:
    if not isinstance(entry, dict) or entry.get("check") not in claims.CHECKS:
        raise UserError(f"{place}: check is one of {', '.join(sorted(claims.CHECKS))}")
    parameters = list(inspect.signature(claims.CHECKS[entry["check"]]).parameters.values())[1:]
    _check(
        place,
        entry,
        CLAIM | {parameter.name: object for parameter in parameters},
        required=("text", *(p.name for p in parameters if p.default is p.empty)),
    )
    if ("absolute" in entry) == ("relative" in entry):
        raise UserError(f"{place}: give either absolute or relative, the error allowed")
    relative = "relative" in entry
    allowed = entry["relative" if relative else "absolute"]
    if not allowed >= 0.0:
        raise UserError(f"{place}: the error allowed is {allowed}, less than 0")
    for name, value in entry.get("when", {}).items():
        if value not in vary.get(name, []):
            raise UserError(f"{place}: when: [vary] has no {name} = {value!r}")
    options = {key: value for key, value in entry.items() if key not in CLAIM}
    return Claim(entry["check"], entry["text"], float(allowed), relative, options, entry.get("when", {}))


def _check(place: str, table: Any, kinds: dict[str, Any], required: tuple[str, ...] = ()) -> None:
    """Keys and types of one table"""
    if not isinstance(table, dict):
        raise UserError(f"{place}: a table is needed, not {table!r}")
    for key, value in table.items():
        if key not in kinds:
            raise UserError(f"{place}: unknown key '{key}' (allowed: {', '.join(sorted(kinds))})")
        kind = kinds[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not object):
            names = " or ".join(one.__name__ for one in (kind if isinstance(kind, tuple) else (kind,)))
            raise UserError(f"{place}: {key} = {value!r} is not of type {names}")
    for key in required:
        if key not in table:
            raise UserError(f"{place}: key '{key}' is missing")


def _positive(place: str, steps: Any) -> None:
    if not isinstance(steps, int) or isinstance(steps, bool) or steps < 1:
        raise UserError(f"{place}: {steps!r} is not a positive whole number")


# What a command is given by its user: an FMU or a scenario, as a file or by the name of a shipped one

STOP = 1.0  # s, where an FMU names no end of its own
STEPS = 1000  # communication steps where neither the user nor the FMU says how long they are
FORMS = {".fmu": "an FMU (.fmu)", ".toml": "a scenario (.toml)", ".csv": "a result (.csv)"}
RUNS = (".fmu", ".toml")
SCENARIOS = (".toml",)
ANY = tuple(FORMS)


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
        listed = ", ".join(one for one in fmus if not one.startswith(FMI3)) or f"none is built in {fmus_folder()}"
        known = f"FMUs (of FMI 3.0: {FMI3}NAME): {listed}; {known}"
    kinds = "FMU or scenario" if ".fmu" in suffixes else "scenario"
    known = "" if hint else f"; {known}"  # all names only where none is near
    raise UserError(f"'{name}' is no {kinds}{hint}, and no file: {words(suffixes)}{known}")


def first_run(path: Path) -> tuple[Experiment, str]:
    """An FMU's own default experiment or the first run of a scenario, and how many runs that has, if more"""
    if path.suffix == ".fmu":
        return of_fmu(path), ""
    scenario = read_scenario(path)
    one, count = of_scenario(scenario, path, scenario.variants[0]), len(scenario.variants)
    return one, f"{path.name} varies: this is the first of {count} runs, {one.label}" if count > 1 else ""


def drawn_runs(path: Path) -> list[Experiment]:
    """An FMU's own default experiment, or the runs that a scenario compares"""
    if path.suffix == ".fmu":
        return [of_fmu(path)]
    scenario = read_scenario(path)
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
    """The experiment with the settings of the user, NAME=VALUE, and an end of their own"""
    values = read_settings(settings, read_variables(unpack(experiment.fmu, kind="")[1]), experiment.fmu)
    stop = experiment.stop_time if stop is None else stop
    if not experiment.start_time < stop < math.inf:
        raise UserError(f"--stop {stop:g}: a time after the start at {experiment.start_time:g} s is needed")
    step = min(experiment.step, stop - experiment.start_time)
    return dataclasses.replace(experiment, values=experiment.values | values, stop_time=stop, step=step)
