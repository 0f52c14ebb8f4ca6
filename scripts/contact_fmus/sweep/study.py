"""A study file (docs/sweep.md): which FMU, how long, what is constant, what varies, what is kept"""

import atexit
import hashlib
import json
import math
import shutil
import subprocess
import sys
import tempfile
import warnings
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np

from contact_fmus.errors import RunFailure, UserError, read_toml, similar
from contact_fmus.fmu.files import fmu_file, unpack
from contact_fmus.fmu.variables import Variable, read_variables, scalars

# The keys of a study file, taken one by one; what is wrong is said in one sentence


def number(value: Any, where: str) -> float:
    """A finite number; text such as "50 mm" is none"""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{where}: a number is wanted (SI units, no quotation marks), not {value!r}")
    if not math.isfinite(value):
        raise UserError(f"{where}: a finite number is wanted, not {value!r}")
    return float(value)


def whole(value: Any, where: str, least: int, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise UserError(f"{where}: a whole number from {least} to {most} is wanted, not {value!r}")
    return value


def text(value: Any, where: str) -> str:
    if not isinstance(value, str) or not value:
        raise UserError(f"{where}: a text in quotation marks is wanted, not {value!r}")
    return value


def one_of(value: Any, where: str, allowed: tuple[str, ...]) -> str:
    if value not in allowed:
        raise UserError(f"{where}: one of {', '.join(allowed)} is wanted, not {value!r}{similar(str(value), allowed)}")
    return value


class Table(dict[str, Any]):
    """A table of a TOML file of which every key is to be taken"""

    def __init__(self, content: Any, where: str, allowed: tuple[str, ...]):
        if not isinstance(content, dict):
            raise UserError(f"{where}: a table is wanted, not {content!r}")
        for key in content:
            if key not in allowed:
                said = f"{where}: there is no key {key!r}; allowed: {', '.join(allowed)}"
                raise UserError(said + similar(key, allowed))
        super().__init__(content)
        self.where = where

    def place(self, key: str) -> str:
        return f"{self.where}: {key}"

    def number(self, key: str, default: float | None = None) -> float:
        if key not in self and default is not None:
            return default
        return number(self.needed(key), self.place(key))

    def positive(self, key: str, default: float | None = None) -> float:
        value = self.number(key, default)
        if value <= 0:
            raise UserError(f"{self.place(key)}: a number above 0 is wanted, not {value!r}")
        return value

    def needed(self, key: str) -> Any:
        if key not in self:
            raise UserError(f"{self.where}: the key {key} is missing")
        return self[key]

    def pair(self, key: str) -> tuple[float, float]:
        """[a, b] with a < b"""
        value, where = self.needed(key), self.place(key)
        if not isinstance(value, list) or len(value) != 2:
            raise UserError(f"{where}: two numbers, [from, to], are wanted, not {value!r}")
        low, high = (number(one, where) for one in value)
        if not low < high:
            raise UserError(f"{where}: the first number has to be below the second, not {value!r}")
        return low, high


# What a study may set and read of its FMU

# A whole number of FMI 2.0 has 32 bits.
LEAST, MOST = -(2**31), 2**31 - 1


class Interface(NamedTuple):
    """Variables of an FMU by name, with their ranges"""

    about: Any  # the description, by fmpy
    variables: dict[str, Variable]
    ranges: dict[int, tuple[float, float]]  # of Real and Integer, by value reference and type's first letter
    settable: frozenset[str]

    def variable(self, name: str, where: str) -> Variable:
        if name not in self.variables:
            said = f"{where}: {self.about.modelName} has no variable '{name}'"
            raise UserError(said + similar(name, self.variables))
        return self.variables[name]

    def parameter(self, name: str, where: str) -> Variable:
        """One that may be set before the start"""
        variable = self.variable(name, where)
        if name not in self.settable:
            article = "an" if variable.causality[0] in "aeiou" else "a"
            raise UserError(f"{where}: '{name}' cannot be set, it is {article} {variable.causality}")
        return variable

    def value(self, variable: Variable, value: Any, where: str) -> Any:
        """The value as the FMU takes it: float, int (Integer, Enumeration), bool, str, or a vector's tuple"""
        if variable.is_vector:
            size = len(variable.references)
            if not isinstance(value, list) or len(value) != size:
                raise UserError(f"{where}: {variable.name} takes {size} values, [..], not {value!r}")
            return tuple(self._scalar(variable, one, where) for one in value)
        return self._scalar(variable, value, where)

    def _scalar(self, variable: Variable, value: Any, where: str) -> Any:
        if variable.type == "Boolean":
            if not isinstance(value, bool):
                raise UserError(f"{where}: {variable.name} is true or false, not {value!r}")
            return value
        if variable.type == "String":
            return text(value, where)
        if variable.type == "Enumeration":
            return item(variable, value, where)
        found = whole(value, where, LEAST, MOST) if variable.type == "Integer" else number(value, where)
        self.inside(variable, found, where)
        return found

    def inside(self, variable: Variable, value: float, where: str) -> None:
        low, high = self.ranges.get(variable.references[0], (-math.inf, math.inf))
        if not low <= value <= high:
            unit = f" {variable.unit}" if variable.unit else ""
            said = f"{where}: {variable.name} = {value!r}{unit} is outside what {self.about.modelName} allows, "
            raise UserError(f"{said}{low!r} to {high!r}{unit}")


def item(variable: Variable, value: Any, where: str) -> int:
    """The value of an enumeration's item, given by name or number"""
    if value in variable.items:
        return variable.item_values[variable.items.index(value)]
    if not isinstance(value, bool) and isinstance(value, int) and value in variable.item_values:
        return value
    said = f"{where}: {variable.name} is one of {', '.join(variable.items)}, not {value!r}"
    raise UserError(said + similar(str(value), variable.items))


def read_interface(file: Path) -> Interface:
    _, description = unpack(file)
    every, variables = scalars(description), read_variables(description)
    # What may be set before the start: FMI 2.0, 2.2.7
    settable = {
        one.name
        for one in every
        if one.causality in ("parameter", "input")
        or (one.initial in ("exact", "approx") and one.variability != "constant")
    }
    settable |= {name for name, one in variables.items() if one.is_vector and f"{name}[1]" in settable}
    ranges = {one.valueReference: _range(one) for one in every if one.type in ("Real", "Integer")}
    return Interface(description, variables, ranges, frozenset(settable))


def _range(scalar: Any) -> tuple[float, float]:
    declared = scalar.declaredType
    low = scalar.min if scalar.min is not None else (declared.min if declared else None)
    high = scalar.max if scalar.max is not None else (declared.max if declared else None)
    return (-math.inf if low is None else float(low), math.inf if high is None else float(high))


# The FMU that a study names: a file, a shipped name, or a scene that is built first


def find_fmu(name: str, folder: Path) -> Path:
    """A file is looked for beside the study, then in the present folder"""
    where = "fmu"
    if Path(name).suffix in (".fmu", ".toml"):
        places = [folder / name, Path.cwd() / name]
        file = next((place for place in places if place.is_file()), None)
        if file is None:
            raise UserError(f"{where}: there is no file {places[0]}")
        return build_scene(file) if file.suffix == ".toml" else file.resolve()
    try:
        return fmu_file(name)
    except FileNotFoundError as error:
        raise UserError(f"{where}: '{name}' is no file NAME.fmu or SCENE.toml, and {error}") from None


def build_scene(scene: Path) -> Path:
    """The scene's FMU, made by `contact-fmus build` in a folder that goes when the sweep ends"""
    target = Path(tempfile.mkdtemp(prefix=f"contact-{scene.stem}-"))
    atexit.register(shutil.rmtree, target, ignore_errors=True)
    command = [sys.executable, "-m", "contact_fmus", "build", str(scene), "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    built = sorted(target.glob("*.fmu"))
    if done.returncode != 0 or len(built) != 1:
        lines = done.stderr.strip().splitlines() or ["no FMU came of it"]
        raise RunFailure(f"fmu: {scene} cannot be built: {lines[-1]}")
    return built[0]


# How the values of one parameter are chosen: a list, a grid, or a distribution to draw from

SCALES = ("linear", "log")
DISTRIBUTIONS = {  # and the keys that belong to each
    "uniform": {"range", "scale"},
    "normal": {"range", "mean", "deviation"},
    "lognormal": {"range", "median", "deviation"},
    "triangular": {"range", "mode"},
}
# Keys of each form of an entry of [vary], told apart by the key that only it has
GRID = ("from", "to", "count", "scale")
SAMPLED = ("range", "scale", "distribution", "mean", "deviation", "median", "mode")
MOST_RUNS = 2**40  # of a study; a run of a microsecond would keep a processor busy for two weeks


@dataclass(frozen=True)
class Parameter:
    """One that varies: its `values` each (list, grid), or the `quantile` of numbers in [0, 1)"""

    name: str
    variable: Variable
    values: np.ndarray | None = None  # one row for each value of a vector
    quantile: Callable[[np.ndarray], np.ndarray] | None = None

    @property
    def sampled(self) -> bool:
        return self.values is None

    @property
    def columns(self) -> list[str]:
        """Its scalars: a vector has one for each component"""
        if not self.variable.is_vector:
            return [self.name]
        return [f"{self.name}[{index}]" for index in range(1, len(self.variable.references) + 1)]


def read_parameter(interface: Interface, name: str, entry: Any) -> Parameter:
    """An entry of [vary]"""
    where = f"[vary] {name}"
    variable = interface.parameter(name, where)
    if variable.type == "String":
        raise UserError(f"{where}: a text cannot vary; set it under [start]")
    if isinstance(entry, list):
        return Parameter(name, variable, _array(variable, _listed(interface, variable, entry, where)))
    if isinstance(entry, dict) and "choices" in entry:
        choices = Table(entry, where, ("choices",)).get("choices")
        values = _array(variable, _listed(interface, variable, choices, where))
        return Parameter(name, variable, quantile=lambda u: values[_place(u, len(values))])
    if not isinstance(entry, dict):
        said = "values in [..], { from, to, count }, { range }, { distribution } or { choices } are wanted"
        raise UserError(f"{where}: {said}, not {entry!r}")
    if variable.is_vector:
        raise UserError(f"{where}: vary the components of a vector one by one, '{name}[1]', or list vectors")
    if variable.type not in ("Real", "Integer"):
        raise UserError(f"{where}: a {variable.type} takes a list, or {{ choices = [..] }} to sample from")
    if "from" in entry or "to" in entry:
        return Parameter(name, variable, _grid(interface, variable, Table(entry, where, GRID)))
    return Parameter(name, variable, quantile=_drawn(interface, variable, Table(entry, where, SAMPLED)))


def _listed(interface: Interface, variable: Variable, entry: Any, where: str) -> list[Any]:
    if not isinstance(entry, list) or not entry:
        raise UserError(f"{where}: at least one value in [..] is wanted, not {entry!r}")
    return [interface.value(variable, one, where) for one in entry]


def _array(variable: Variable, values: list[Any]) -> np.ndarray:
    kind = float if variable.type == "Real" else np.int32
    return np.array(values, dtype=kind).reshape(len(values), len(variable.references))


def _place(u: np.ndarray, count: int) -> np.ndarray:
    """Equally likely places 0 to count - 1"""
    return np.minimum((u * count).astype(np.int64), count - 1)


def _ends(interface: Interface, variable: Variable, low: float, high: float, table: Table) -> bool:
    """Both ends are allowed; true on a logarithmic scale"""
    for value in (low, high):
        interface.inside(variable, value, table.where)
    logarithmic = one_of(table.get("scale", "linear"), table.place("scale"), SCALES) == "log"
    if logarithmic and min(low, high) <= 0:
        raise UserError(f"{table.where}: a logarithmic scale wants numbers above 0, not {low!r} to {high!r}")
    return logarithmic


def _grid(interface: Interface, variable: Variable, table: Table) -> np.ndarray:
    low, high = table.number("from"), table.number("to")
    count = whole(table.needed("count"), table.place("count"), 1, MOST_RUNS)
    logarithmic = _ends(interface, variable, low, high, table)
    values = (np.geomspace if logarithmic else np.linspace)(low, high, count)
    if variable.type == "Integer":
        values = np.unique(np.round(values)).astype(np.int32)
    return values.reshape(-1, 1)


def _drawn(interface: Interface, variable: Variable, table: Table) -> Callable[[np.ndarray], np.ndarray]:
    kind = one_of(table.get("distribution", "uniform"), table.place("distribution"), tuple(DISTRIBUTIONS))
    for key in table:
        if key not in DISTRIBUTIONS[kind] | {"distribution"}:
            allowed = ", ".join(sorted(DISTRIBUTIONS[kind]))
            raise UserError(f"{table.place(key)} does not belong to the distribution {kind}; allowed: {allowed}")
    if kind == "uniform":
        low, high = table.pair("range")
        logarithmic = _ends(interface, variable, low, high, table)
        # Values stay between the ends whatever the rounding.
        start, width = (math.log(low), math.log(high / low)) if logarithmic else (low, high - low)
        quantile = (
            (lambda u: np.clip(np.exp(start + width * u), low, high)) if logarithmic else lambda u: start + width * u
        )
        if variable.type == "Integer":
            first, count = math.ceil(low), math.floor(high) - math.ceil(low) + 1
            return lambda u: (first + _place(u, count)).astype(np.int32).reshape(-1, 1)
    else:
        quantile = _bounded(interface, variable, kind, table)
    if variable.type == "Integer":
        return lambda u: np.round(quantile(u)).astype(np.int32).reshape(-1, 1)
    return lambda u: quantile(u).reshape(-1, 1)


def _bounded(interface: Interface, variable: Variable, kind: str, table: Table) -> Callable[[np.ndarray], np.ndarray]:
    """A distribution of scipy, cut off to what `range` or the FMU allows: values outside are not drawn"""
    from scipy import stats  # takes a second to import, which a uniform study need not wait for

    if kind == "triangular":
        low, high = table.pair("range")
        _ends(interface, variable, low, high, table)
        mode = table.number("mode", (low + high) / 2)
        if not low <= mode <= high:
            raise UserError(f"{table.place('mode')}: a number from {low!r} to {high!r} is wanted, not {mode!r}")
        return stats.triang((mode - low) / (high - low), low, high - low).ppf
    deviation = table.positive("deviation")
    if kind == "normal":
        base = stats.norm(number(table.needed("mean"), table.place("mean")), deviation)
    else:
        base = stats.lognorm(deviation, scale=table.positive("median"))
    low, high = interface.ranges.get(variable.references[0], (-math.inf, math.inf))
    if "range" in table:
        low, high = table.pair("range")
        _ends(interface, variable, low, high, table)
    first, last = base.cdf(low), base.cdf(high)
    if not last > first:
        raise UserError(f"{table.where}: no value of this distribution lies in {low!r} to {high!r}")
    return lambda u: np.clip(base.ppf(first + (last - first) * u), low, high)


# The values of every run, by its number: any stretch of runs, in any order, gives the same bits.
#
# Lists and grids make every combination, the last one named fastest; at each combination all samples are
# taken. Samples are numbers in [0, 1), one row for each: a Latin hypercube with the bits of scipy.stats.qmc,
# sequences by scipy.stats.qmc itself. Only the strata of a Latin hypercube are kept, 4 bytes for each sample
# and parameter; the place within a stratum is drawn again where it is needed, in blocks. Samples of a Latin
# hypercube and random ones depend on the parameter's name, the seed and the count alone.

METHODS = ("latin_hypercube", "random", "sobol", "halton")
# Samples drawn at a time from one seed: short enough to draw again for a batch, long enough to cost nothing.
BLOCK = 8192


@dataclass(frozen=True)
class Sampling:
    method: str = "latin_hypercube"
    count: int = 1
    seed: int = 0


class Samples:
    """Start values of runs 0 to `runs` - 1"""

    def __init__(self, parameters: Sequence[Parameter], sampling: Sampling):
        self.parameters = parameters
        self.listed = [one for one in parameters if not one.sampled]
        self.sampled = [one for one in parameters if one.sampled]
        self.sampling = sampling
        self.shape = tuple(len(one.values) for one in self.listed)
        self.samples = sampling.count if self.sampled else 1
        self.runs = math.prod(self.shape) * self.samples
        self._strata: dict[str, np.ndarray] = {}

    def prepare(self) -> None:
        """What takes a moment, where there are many samples"""
        if self.sampling.method == "latin_hypercube":
            for one in self.sampled:
                self._stratum(one.name)

    def values(self, first: int, count: int) -> dict[str, np.ndarray]:
        """The values of each parameter have a row for each run of the stretch."""
        runs = np.arange(first, first + count)
        found: dict[str, np.ndarray] = {}
        if self.listed:
            places = np.unravel_index(runs // self.samples, self.shape)
            found = {one.name: one.values[place] for one, place in zip(self.listed, places, strict=True)}
        if self.sampled:
            uniform = self._uniform(first, count)
            for index, one in enumerate(self.sampled):
                found[one.name] = one.quantile(uniform[:, index])
        return {one.name: found[one.name] for one in self.parameters}

    def _uniform(self, first: int, count: int) -> np.ndarray:
        """Rows of numbers in [0, 1) for the stretch, which may begin again with the first sample"""
        starts = range(first - first % self.samples, first + count, self.samples)
        ends = ((max(first - one, 0), min(first + count - one, self.samples)) for one in starts)
        return np.concatenate([self._stretch(start, end - start) for start, end in ends])

    def _stretch(self, start: int, size: int) -> np.ndarray:
        if self.sampling.method in ("sobol", "halton"):
            return self._sequence(start, size)
        columns = [self._jitter(one.name, start, size) for one in self.sampled]
        if self.sampling.method == "latin_hypercube":
            strata = [self._stratum(one.name)[start : start + size] for one in self.sampled]
            columns = [(stratum + jitter) / self.samples for stratum, jitter in zip(strata, columns, strict=True)]
            # Rounding must not lift the last stratum to 1.
            columns = [np.minimum(column, np.nextafter(1.0, 0.0)) for column in columns]
        return np.stack(columns, axis=1)

    def _sequence(self, start: int, size: int) -> np.ndarray:
        from scipy.stats import qmc  # takes a second to import

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # a count that is no power of 2 is allowed
            make = {"sobol": qmc.Sobol, "halton": qmc.Halton}[self.sampling.method]
            engine = make(len(self.sampled), rng=self.sampling.seed)
            if start:
                engine.fast_forward(start)
            return engine.random(size)

    def _stratum(self, name: str) -> np.ndarray:
        """Sample by sample the stratum of one parameter, 0 to count - 1: each once"""
        if name not in self._strata:
            # scipy.stats.qmc.LatinHypercube gives these bits too, and takes a second to import.
            strata = np.arange(self.samples, dtype=np.uint32)
            self._generator(name, "strata").spawn(1)[0].shuffle(strata)
            self._strata[name] = strata
        return self._strata[name]

    def _jitter(self, name: str, start: int, size: int) -> np.ndarray:
        blocks = range(start // BLOCK, (start + size - 1) // BLOCK + 1)
        drawn = np.concatenate([self._generator(name, "block", block).random(BLOCK) for block in blocks])
        offset = start - blocks[0] * BLOCK
        return drawn[offset : offset + size]

    def _generator(self, name: str, *purpose: str | int) -> np.random.Generator:
        text = "\n".join([name, *map(str, purpose)])
        words = np.frombuffer(hashlib.sha256(text.encode()).digest(), np.uint32)
        return np.random.default_rng(np.random.SeedSequence([self.sampling.seed, *map(int, words)]))


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
        """Two studies of one digest give the same rows: it is taken of all that decides the results"""
        parts = {key: value for key, value in self.content.items() if key not in ("title", "fmu")}
        text = json.dumps(parts, sort_keys=True, default=str) + fmu_digest(self.fmu)
        return hashlib.sha256(text.encode()).hexdigest()


def fmu_digest(fmu: Path) -> str:
    return hashlib.sha256(fmu.read_bytes()).hexdigest()


def read_study(file: Path) -> Study:
    content = read_toml(file)
    top = Table(content, str(file), ("title", "fmu", "experiment", "start", "vary", "samples", "outputs"))
    fmu = find_fmu(text(top.needed("fmu"), top.place("fmu")), file.parent)
    interface = read_interface(fmu)
    vary = _filled(top.needed("vary"))
    parameters = tuple(read_parameter(interface, name, entry) for name, entry in vary.items())
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


def _filled(vary: Any) -> dict[str, Any]:
    """The table [vary], which has an entry at least"""
    if not isinstance(vary, dict) or not vary:
        raise UserError("[vary]: at least one entry is wanted")
    known = {"from", "to", "range", "distribution", "choices"}
    for name, entry in vary.items():
        if isinstance(entry, dict) and name.isidentifier() and not known & set(entry):
            _refuse_bare(f"[vary] {name}", name, entry)
    return vary


def _refuse_bare(where: str, name: str, entry: dict[str, Any]) -> NoReturn:
    """TOML takes a name with a dot for a table"""
    part = next(iter(entry), "name")
    raise UserError(f'{where}.{part}: names with a dot stand in quotation marks, "{name}.{part}"')


def _constants(interface: Interface, start: Any, parameters: tuple[Parameter, ...]) -> dict[str, Any]:
    if not isinstance(start, dict):
        raise UserError(f"[start]: a table is wanted, not {start!r}")
    constants = {}
    for name, value in start.items():
        where = f"[start] {name}"
        if isinstance(value, dict):
            _refuse_bare(where, name, value)
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
            raise UserError(f"{experiment.place('step')}: {ratio:.3g} steps; at most {MOST_STEPS} are allowed")
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


# What is asked of a sweep's picture, known to make sense before the first run


def columns_of(study: Study, x: str | None, y: str | None, color: str | None) -> list[str]:
    """Across, up and, for a map, the colour; UserError where there is no such column"""
    parameters = [column for one in study.parameters for column in one.columns]
    outputs = [one.name for one in study.outputs]
    x = x or parameters[0]
    if color is not None and y is None:
        if len(parameters) < 2:
            raise UserError("--color: a map wants two parameters, and only one varies; say --y")
        y = next(one for one in parameters if one != x)
    names = [x, y or outputs[0], *([color] if color else [])]
    for option, name in zip(("--x", "--y", "--color"), names, strict=False):
        if name not in parameters + outputs + ["run"]:
            allowed = ", ".join(["run", *parameters, *outputs])
            hint = similar(name, parameters + outputs)
            raise UserError(f"{option} {name}: no such column{hint}; {allowed}")
    return names
