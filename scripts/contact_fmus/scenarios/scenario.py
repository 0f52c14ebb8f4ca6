"""Reads a scenario file: one experiment with one FMU and what it claims.

    title = "..."                     # one line
    description = "..."               # what is set up and why the expectation holds
    fmu = "SphereSphere"              # name of a file in build/fmus

    [experiment]
    stop_time = 5.0                   # s
    steps = 10                        # communication steps
    tolerance = 1e-10                 # given to the FMU; start_time defaults to 0

    [start]                           # start values; vectors are lists, enumerations item names
    "source.center" = [0.0, 0.0, 1.1]

    [vary]                            # a run for every combination; besides variables: steps, tolerance
    "solver.method" = ["cvode_bdf", "cvode_adams"]

    [[input]]                         # an input over time, set at every communication point
    variable = "source.prescribed_displacement"
    times = [0.0, 1.0]                # straight lines between (time, value), constant outside, or
    values = [[0.0, 0.0, 0.0], [0.0, 0.0, -0.1]]
    # offset, amplitude (as the variable: number or list), frequency (Hz), phase (rad): a sinusoid, or
    # derivative_of = "another input": its time derivative
    derivatives = 1                   # how many time derivatives go to the FMU as well (0, 1 or 2)

    [[claim]]                         # none is needed: `contact-fmus run` shows any scenario
    check = "final_value"             # a function of claims.py; its other arguments stand here too
    text = "..."                      # the claim in words
    absolute = 1e-6                   # or relative: the error allowed
    when = { "solver.method" = "cvode_bdf" }    # only for these runs of [vary]

    [plot]
    steps = 2000                      # communication steps of the run that is drawn
    compare = "contact.dashpot"       # a name of [vary]: one curve each

Errors are ScenarioError: file, place, what is wrong and what is allowed, in one line.
"""

from __future__ import annotations

import inspect
import itertools
import tomllib
from pathlib import Path
from typing import Any

from contact_fmus.errors import UserError

from . import claims, turning_claims  # noqa: F401 (its checks join those of claims)
from .experiment import Claim, Scenario, Variant
from .inputs import InputSignal

NUMBER = (int, float)
TOP = {
    "title": str,
    "description": str,
    "fmu": str,
    "experiment": dict,
    "start": dict,
    "vary": dict,
    "input": list,
    "claim": list,
    "plot": dict,
}
EXPERIMENT = {"stop_time": NUMBER, "steps": int, "tolerance": NUMBER, "start_time": NUMBER}
INPUT = {
    "variable": str,
    "times": list,
    "values": list,
    "offset": (*NUMBER, list),
    "amplitude": (*NUMBER, list),
    "frequency": NUMBER,
    "phase": NUMBER,
    "derivative_of": str,
    "derivatives": int,
}
CLAIM = {"check": str, "text": str, "absolute": NUMBER, "relative": NUMBER, "when": dict}
PLOT = {"steps": int, "compare": str}
VARIED_SETTINGS = ("steps", "tolerance")


class ScenarioError(UserError):
    """The file says what it cannot mean"""


def read_scenario(path: Path) -> Scenario:
    try:
        table = tomllib.loads(Path(path).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ScenarioError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ScenarioError(f"{path}: this is no text: a scenario is a TOML file in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: {error}") from None
    place = str(path)
    _check(place, table, TOP, required=("title", "fmu", "experiment"))
    experiment = table["experiment"]
    _check(f"{place}: [experiment]", experiment, EXPERIMENT, required=("stop_time", "steps"))
    start_time, stop_time = float(experiment.get("start_time", 0.0)), float(experiment["stop_time"])
    if not stop_time > start_time:
        raise ScenarioError(
            f"{place}: [experiment]: stop_time {stop_time} is not after start_time {start_time}"
        )
    variants = _variants(place, experiment, table.get("start", {}), table.get("vary", {}))
    plot = table.get("plot", {})
    _check(f"{place}: [plot]", plot, PLOT)
    _positive(f"{place}: [plot]", plot.get("steps", 1))
    if plot.get("compare") not in (None, *table.get("vary", {})):
        raise ScenarioError(f"{place}: [plot]: compare = '{plot['compare']}' is not a name of [vary]")
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
            raise ScenarioError(f"{place}: [vary]: {name} needs a list of values")
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
                raise ScenarioError(
                    f"{here}: derivative_of = '{options['derivative_of']}' is no input before it"
                )
            options = {"derivative_of": signals[options["derivative_of"]]}
        try:
            signals[entry["variable"]] = InputSignal.make(
                entry["variable"], entry.get("derivatives", 0), options
            )
        except ValueError as error:
            raise ScenarioError(f"{here}: {error}") from None
    return list(signals.values())


def _claim(place: str, entry: dict, vary: dict) -> Claim:
    if not isinstance(entry, dict) or entry.get("check") not in claims.CHECKS:
        raise ScenarioError(f"{place}: check is one of {', '.join(sorted(claims.CHECKS))}")
    parameters = list(inspect.signature(claims.CHECKS[entry["check"]]).parameters.values())[1:]
    _check(
        place,
        entry,
        CLAIM | {parameter.name: object for parameter in parameters},
        required=("text", *(p.name for p in parameters if p.default is p.empty)),
    )
    if ("absolute" in entry) == ("relative" in entry):
        raise ScenarioError(f"{place}: give either absolute or relative, the error allowed")
    relative = "relative" in entry
    allowed = entry["relative" if relative else "absolute"]
    if not allowed >= 0.0:
        raise ScenarioError(f"{place}: the error allowed is {allowed}, less than 0")
    for name, value in entry.get("when", {}).items():
        if value not in vary.get(name, []):
            raise ScenarioError(f"{place}: when: [vary] has no {name} = {value!r}")
    options = {key: value for key, value in entry.items() if key not in CLAIM}
    return Claim(entry["check"], entry["text"], float(allowed), relative, options, entry.get("when", {}))


def _check(place: str, table: Any, kinds: dict[str, Any], required: tuple[str, ...] = ()) -> None:
    """Keys and types of one table"""
    if not isinstance(table, dict):
        raise ScenarioError(f"{place}: a table is needed, not {table!r}")
    for key, value in table.items():
        if key not in kinds:
            raise ScenarioError(f"{place}: unknown key '{key}' (allowed: {', '.join(sorted(kinds))})")
        kind = kinds[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not object):
            names = " or ".join(one.__name__ for one in (kind if isinstance(kind, tuple) else (kind,)))
            raise ScenarioError(f"{place}: {key} = {value!r} is not of type {names}")
    for key in required:
        if key not in table:
            raise ScenarioError(f"{place}: key '{key}' is missing")


def _positive(place: str, steps: Any) -> None:
    if not isinstance(steps, int) or isinstance(steps, bool) or steps < 1:
        raise ScenarioError(f"{place}: {steps!r} is not a positive whole number")
