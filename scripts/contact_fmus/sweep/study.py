"""A study file (docs/sweep.md): which FMU, how long, what is constant, what varies, what is kept"""

from __future__ import annotations

import hashlib
import json
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError
from contact_fmus.fmu.variables import Variable

from .fmus import find_fmu
from .interface import Interface, read_interface
from .keys import Table, number, one_of, text, whole
from .samples import METHODS, Samples, Sampling
from .spread import MOST_RUNS, Parameter, read_parameter

REDUCTIONS = ("last", "at", "max", "min", "mean")
MOST_STEPS = 10_000_000  # of a run: its communication points are kept in memory
# A time this close to a communication point, in steps, is that point: 0.3 is no multiple of 0.1 in binary.
SAME_POINT = 1e-9
MOST_SAMPLES = 2**32 - 1  # numbers of strata have 32 bits


@dataclass(frozen=True)
class Output:
    """A column of the results: `reduction` of a variable's values; `time` belongs to "at" """

    name: str
    variable: Variable  # a scalar
    reduction: str = "last"
    time: float | None = None  # s


@dataclass(frozen=True)
class Study:
    """All of a study file, checked against its FMU"""

    title: str
    file: Path
    content: dict[str, Any]  # of the file
    fmu: Path
    interface: Interface
    start_time: float  # s
    tolerance: float | None
    points: tuple[float, ...]  # s, where communication steps end
    constants: dict[str, Any]  # as Interface.value gives them
    parameters: tuple[Parameter, ...]
    sampling: Sampling
    outputs: tuple[Output, ...]

    def samples(self) -> Samples:
        return Samples(self.parameters, self.sampling)

    def digest(self) -> str:
        """Of all that decides the results: two studies of one digest give the same rows"""
        parts = {key: value for key, value in self.content.items() if key not in ("title", "fmu")}
        text = json.dumps(parts, sort_keys=True, default=str) + fmu_digest(self.fmu)
        return hashlib.sha256(text.encode()).hexdigest()


def fmu_digest(fmu: Path) -> str:
    return hashlib.sha256(fmu.read_bytes()).hexdigest()


def read_study(file: Path) -> Study:
    content = _load(file)
    top = Table(content, str(file), ("title", "fmu", "experiment", "start", "vary", "samples", "outputs"))
    fmu = find_fmu(text(top.needed("fmu"), top.place("fmu")), file.parent)
    interface = read_interface(fmu)
    vary = Table(top.needed("vary"), "[vary]", tuple(content["vary"]) if _filled(content, "vary") else ())
    parameters = tuple(read_parameter(interface, name, entry) for name, entry in vary.content.items())
    outputs = _outputs(interface, top.needed("outputs"))
    experiment = Table(
        top.needed("experiment"), "[experiment]", ("start_time", "stop_time", "step", "steps", "tolerance")
    )
    start_time = experiment.number("start_time", 0.0)
    study = Study(
        text(top.get("title", file.stem), top.place("title")),
        file,
        content,
        fmu,
        interface,
        start_time,
        experiment.positive("tolerance") if "tolerance" in experiment else None,
        _points(experiment, start_time, outputs),
        _constants(interface, top.get("start", {}), parameters),
        parameters,
        _sampling(top.get("samples"), parameters),
        outputs,
    )
    _check_columns(study)
    return study


def _load(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise UserError(f"{file}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UserError(f"{file} is no text: a study is a TOML file in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{file} is no TOML file: {error}") from None


def _filled(content: dict[str, Any], key: str) -> bool:
    if not isinstance(content.get(key), dict) or not content[key]:
        raise UserError(f"[{key}]: at least one entry is wanted")
    for name, entry in content[key].items():
        if isinstance(entry, dict) and name.isidentifier() and key == "vary" and not _is_entry(entry):
            part = next(iter(entry), "name")
            raise UserError(
                f'[{key}] {name}.{part}: names with a dot stand in quotation marks, "{name}.{part}"'
            )
    return True


def _is_entry(entry: dict[str, Any]) -> bool:
    return any(key in entry for key in ("from", "to", "range", "distribution", "choices"))


def _constants(interface: Interface, start: Any, parameters: tuple[Parameter, ...]) -> dict[str, Any]:
    if not isinstance(start, dict):
        raise UserError(f"[start]: a table is wanted, not {start!r}")
    constants = {}
    for name, value in start.items():
        where = f"[start] {name}"
        if isinstance(value, dict):
            part = next(iter(value), "name")
            raise UserError(f'{where}.{part}: names with a dot stand in quotation marks, "{name}.{part}"')
        constants[name] = interface.value(interface.parameter(name, where), value, where)
    owner: dict[int | tuple[str, int], str] = {}
    for name in [*constants, *(one.name for one in parameters)]:
        variable = interface.variables[name]
        for reference in variable.references:
            key = (variable.type[0].replace("E", "I"), reference)
            if key in owner:
                raise UserError(f"[vary] {name}: it is set already, as {owner[key]}; say it once")
            owner[key] = name
    return constants


def _sampling(entry: Any, parameters: tuple[Parameter, ...]) -> Sampling:
    sampled = [one.name for one in parameters if one.sampled]
    if entry is None:
        if sampled:
            said = "say how many samples: [samples] with count (and method, seed)"
            raise UserError(f"[vary] {sampled[0]} is sampled; {said}")
        return Sampling()
    table = Table(entry, "[samples]", ("method", "count", "seed"))
    if not sampled:
        raise UserError("[samples]: nothing is sampled; give a { range = [from, to] } under [vary]")
    return Sampling(
        one_of(table.get("method", METHODS[0]), table.place("method"), METHODS),
        whole(table.needed("count"), table.place("count"), 1, MOST_SAMPLES),
        whole(table.get("seed", 0), table.place("seed"), 0, 2**63 - 1),
    )


def _outputs(interface: Interface, entry: Any) -> tuple[Output, ...]:
    if isinstance(entry, list):
        entry = {text(name, "outputs"): {} for name in entry}
    if not isinstance(entry, dict) or not entry:
        raise UserError("outputs: a list of variables or a table [outputs] is wanted, with one at least")
    found: list[Output] = []
    for name, one in entry.items():
        where = f"[outputs] {name}"
        table = Table({"variable": one} if isinstance(one, str) else one, where, ("variable", "reduce", "at"))
        variable = interface.variable(text(table.get("variable", name), table.place("variable")), where)
        if variable.type == "String":
            raise UserError(f"{where}: {variable.name} is a text, which a sweep does not keep")
        found += _reduced(interface, name, variable, table)
    return tuple(found)


def _reduced(interface: Interface, name: str, variable: Variable, table: Table) -> list[Output]:
    """A column for each reduction and each component of a vector"""
    reductions = table.get("reduce", "at" if "at" in table else "last")
    several = isinstance(reductions, list)
    reductions = reductions if several else [reductions]
    time = number(table.needed("at"), table.place("at")) if "at" in table or "at" in reductions else None
    if time is not None and "at" not in reductions:
        raise UserError(f'{table.where}: "at" gives a time; leave reduce out, or say reduce = "at"')
    outputs = []
    for reduction in reductions:
        one_of(reduction, table.place("reduce"), REDUCTIONS)
        if variable.type == "Enumeration" and reduction not in ("last", "at"):
            raise UserError(f"{table.where}: {variable.name} is an enumeration, which has no {reduction}")
        for index in range(len(variable.references)):
            suffix = f"[{index + 1}]" if variable.is_vector else ""
            column = f"{name}{suffix}" + (f".{reduction}" if several else "")
            scalar = interface.variables[f"{variable.name}{suffix}"]
            outputs.append(Output(column, scalar, reduction, time if reduction == "at" else None))
    return outputs


def _points(experiment: Table, start: float, outputs: tuple[Output, ...]) -> tuple[float, ...]:
    """Where communication steps end: whole steps, the stop time, and the times of outputs"""
    stop = experiment.number("stop_time")
    if not stop > start:
        raise UserError(f"{experiment.place('stop_time')}: a time after {start!r} s is wanted, not {stop!r}")
    if "step" in experiment and "steps" in experiment:
        raise UserError("[experiment]: give step (s) or steps (a number), not both")
    length = stop - start
    if "step" in experiment:
        ratio = length / experiment.positive("step")
        if ratio > MOST_STEPS:
            raise UserError(
                f"{experiment.place('step')}: {ratio:.3g} steps; at most {MOST_STEPS} are allowed"
            )
        count = max(1, math.ceil(ratio - SAME_POINT))
        points = [start + index * experiment.positive("step") for index in range(1, count)] + [stop]
    else:
        count = whole(experiment.get("steps", 1), experiment.place("steps"), 1, MOST_STEPS)
        points = [start + length * (index / count) for index in range(1, count + 1)]
    for one in outputs:
        if one.time is None:
            continue
        if not start <= one.time <= stop:
            raise UserError(f"[outputs] {one.name}: at = {one.time!r} s is outside {start!r} to {stop!r} s")
        if point_of(one.time, start, points) is None:
            points = sorted([*points, one.time])
    return tuple(points)


def point_of(time: float, start: float, points: Any) -> int | None:
    """The number of the communication point at this time; 0 is the start"""
    from bisect import bisect_left

    near = SAME_POINT * (points[-1] - start) / len(points)
    if time - start <= near:
        return 0
    place = bisect_left(points, time - near)
    return place + 1 if place < len(points) and abs(points[place] - time) <= near else None


def _check_columns(study: Study) -> None:
    names = ["run", *(column for one in study.parameters for column in one.columns)]
    names += [one.name for one in study.outputs] + ["status", "warnings", "message"]
    for name in names:
        if names.count(name) > 1:
            said = "two columns of the results have this name; call the output otherwise"
            raise UserError(f'[outputs] {name}: {said}, "my name" = {{ variable = "{name}" }}')
    if study.samples().runs > MOST_RUNS:
        raise UserError(f"[vary]: {study.samples().runs:.3g} runs; at most {MOST_RUNS} are allowed")
