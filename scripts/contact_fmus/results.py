"""The result of a run: values over time, with units, and the file they are kept in.

    result = Result.read("bounce.csv")
    result.time                              # s, numpy array
    result.columns["contact.gap"]            # a scalar variable at those times
    result.vector("source.position")         # the three scalars of a vector, one row a time
    result.units["contact.gap"]              # "m"; "" where a variable has none
    result.parameters["source.radius"]       # value during the run; an enumeration's is its item's name
    result.fmu                               # the FMU that ran, None where the file does not say
    result.warnings                          # what the FMU warned of, each once

A file is a CSV table with a row of names; time comes first. Enumerations are written by name, Booleans as 0
and 1. Units, parameters, warnings and the FMU stand in bounce.csv.json beside it.
"""

import csv
import json
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import numpy as np

from .errors import UserError, similar


def notes_file(path: str | Path) -> Path:
    """Notes on a table stand beside it: those on bounce.csv in bounce.csv.json"""
    return Path(f"{path}.json")


@dataclass
class Result:
    """Values of one run over time; a zero has no sign"""

    time: np.ndarray  # s
    columns: dict[str, np.ndarray]  # by the variable's name; text where it is an enumeration
    units: dict[str, str] = field(default_factory=dict)
    fmu: Path | None = None
    parameters: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """-0.0 says no more than 0.0"""
        self.columns = {name: one + 0.0 if one.dtype.kind == "f" else one for name, one in self.columns.items()}

    def column(self, name: str) -> np.ndarray:
        """UserError with likely names where there is none of this name"""
        if name not in self.columns:
            raise UserError(f"the result has no variable '{name}'{similar(name, self.columns)}")
        return self.columns[name]

    def vector(self, name: str) -> np.ndarray:
        """The scalars name[1], name[2], name[3] as one row a time"""
        return np.column_stack([self.column(f"{name}[{index}]") for index in (1, 2, 3)])

    def write_csv(self, path: str | Path) -> None:
        """Numbers with all digits: reading the file gives the same bits. An OSError names the file."""
        about = {
            "fmu": str(self.fmu) if self.fmu is not None else None,
            "units": {"time": "s"} | {name: self.units.get(name, "") for name in self.columns},
            "parameters": self.parameters,
            "warnings": self.warnings,
        }
        try:
            with open(path, "w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(["time", *self.columns])
                writer.writerows(self.rows(self.columns))
            if Path(path).is_file():  # there is nothing beside /dev/stdout
                notes_file(path).write_text(json.dumps(about, indent=1, ensure_ascii=False) + "\n", "utf-8")
        except OSError as error:  # a full disk says so without a name
            error.filename = error.filename or str(path)
            raise

    def rows(self, names: Iterable[str]) -> Iterator[tuple]:
        """Time and these columns, Booleans as 0 and 1"""
        arrays = [self.time, *(np.asarray(self.columns[name]) for name in names)]
        return zip(*((one.astype(int) if one.dtype == bool else one).tolist() for one in arrays), strict=True)

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """UserError where the file is no such table"""
        try:
            with open(path, newline="", encoding="utf-8-sig") as file:
                lines = file.read().splitlines()
        except UnicodeDecodeError:
            raise UserError(f"{path}: this is no CSV file of results, but binary") from None
        about = _notes(notes_file(path))
        rows = list(csv.reader(line for line in lines if line))
        if not rows or rows[0][0] != "time":
            raise UserError(f"{path}: this is no CSV file of results: its first column is not 'time'")
        names, table = rows[0], rows[1:]
        for number, row in enumerate(table, 1):
            if len(row) != len(names):
                raise UserError(f"{path}: row {number} has {len(row)} values instead of {len(names)}")
        columns = {name: _column(path, name, [row[index] for row in table]) for index, name in enumerate(names)}
        time = columns.pop("time")
        fmu = Path(about["fmu"]) if about.get("fmu") else None
        kept = (about.get("units", {}), fmu, about.get("parameters", {}), about.get("warnings", []))
        return cls(time, columns, *kept)

    def tell_warnings(self) -> None:
        """On stderr, a line each"""
        for text in self.warnings:
            print(f"warning: {text}", file=sys.stderr)


def _notes(file: Path) -> dict[str, Any]:
    """Nothing where there is no such file: a table alone is a result too"""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except ValueError as error:
        raise UserError(f"{file}: this is no JSON text: {error}") from None
    if not isinstance(found, dict):
        raise UserError(f"{file}: these are no notes of a result: a JSON object is wanted")
    return found


def _column(path: str | Path, name: str, texts: list[str]) -> np.ndarray:
    """Numbers, or text where an enumeration's items stand"""
    try:
        return np.array([float(text) for text in texts])
    except ValueError:
        if name == "time":
            raise UserError(f"{path}: column time holds something that is no number") from None
        return np.array(texts)


PICTURES = (".png", ".svg", ".pdf")


def output_file(asked: Path | None, usual: str, suffixes: tuple[str, ...]) -> Path:
    """UserError before anything is run, where the file could not be written in the end"""
    output = Path(usual) if asked is None else asked
    if output.suffix not in suffixes:
        known = ", ".join(suffixes)
        near = similar(output.suffix, suffixes)
        raise UserError(f"{output}: '{output.suffix}' is none of the formats {known}{near}")
    if output.is_dir():
        raise UserError(f"{output}: this is a folder")
    return output
