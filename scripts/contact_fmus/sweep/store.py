"""The folder of a sweep: study.json, batches/FIRST-END.parquet while it runs, results.parquet at the end.

A batch file appears by rename, whole or not at all. Files on disk say which runs are done; nothing else
does.
"""

import contextlib
import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.variables import Variable
from contact_fmus.results import notes_file

from .native import Rows
from .study import Output, Study, fmu_digest

# Rows of results as Arrow tables: run, parameters, outputs, status, message; units stand in the schema

# Codes of fmi2Status. CRASH stands for a run whose process ended.
OK, DISCARD, CRASH = 0, 2, 255
STATUSES = ("ok", "discard", "error", "crash")
MESSAGE_WORDS = 120  # characters kept of what an FMU said


def schema_of(study: Study) -> pa.Schema:
    """Columns with unit, variable and description; the study, its digest and the FMU's in the metadata"""
    fields = [_field("run", pa.int64(), {"description": "number of the run, from 0"})]
    for one in study.parameters:
        for index, name in enumerate(one.columns):
            scalar = study.interface.variables[name]
            about = _about(scalar) | {"role": "parameter"}
            fields.append(_field(name, _type(one.variable), about, nullable=False))
            assert scalar.references[0] == one.variable.references[index]
    for output in study.outputs:
        at = "" if output.time is None else repr(output.time)
        about = _about(output.variable) | {"role": "output", "reduce": output.reduction, "at": at}
        fields.append(_field(output.name, output_type(output), about))
    words = pa.dictionary(pa.int8(), pa.string())
    fields.append(_field("status", words, {"description": ", ".join(STATUSES)}))
    told = {"description": "how many warnings the FMU logged"}
    fields.append(_field("warnings", pa.int32(), told, nullable=False))
    fields.append(_field("message", pa.string(), {"description": "what the FMU said of a run that failed"}))
    metadata = {
        "contact_fmus.study": json.dumps(study.content, default=str, ensure_ascii=False),
        "contact_fmus.study_digest": study.digest(),
        "contact_fmus.fmu": study.fmu.name,
        "contact_fmus.fmu_sha256": fmu_digest(study.fmu),
        "contact_fmus.runs": str(study.samples().runs),
    }
    return pa.schema(fields, metadata=metadata)


def _field(name: str, kind: pa.DataType, about: dict[str, str], nullable: bool = True) -> pa.Field:
    return pa.field(name, kind, nullable=nullable, metadata={key: value for key, value in about.items() if value})


def _about(variable: Variable) -> dict[str, str]:
    unit = variable.unit or ("1" if variable.type == "Real" else "")
    return {"unit": unit, "variable": variable.name, "description": variable.description}


def _type(variable: Variable) -> pa.DataType:
    if variable.type == "Enumeration":
        return pa.dictionary(pa.int32(), pa.string())
    return {"Real": pa.float64(), "Integer": pa.int32(), "Boolean": pa.bool_()}[variable.type]


def output_type(output: Output) -> pa.DataType:
    return pa.float64() if output.reduction == "mean" else _type(output.variable)


def make_table(study: Study, schema: pa.Schema, values: dict[str, np.ndarray], rows: Rows) -> pa.Table:
    """`values` are the parameters of these runs, as Samples.values gives them"""
    count = len(rows.status)
    columns: list[pa.Array] = [pa.array(np.arange(rows.first, rows.first + count))]
    for one in study.parameters:
        for index in range(len(one.columns)):
            columns.append(_array(one.variable, values[one.name][:, index], _type(one.variable), np.zeros(count, bool)))
    failed = rows.status != OK
    for place, output in enumerate(study.outputs):
        columns.append(_array(output.variable, rows.values[place], output_type(output), failed))
    # fmi2Error and fmi2Fatal are one to a user
    codes = np.select([~failed, rows.status == DISCARD, rows.status == CRASH], [0, 1, 3], 2).astype(np.int8)
    columns.append(pa.DictionaryArray.from_arrays(pa.array(codes), pa.array(STATUSES)))
    columns.append(pa.array(rows.warnings))
    columns.append(pa.array([_words(rows.messages.get(place)) for place in range(count)], pa.string()))
    return pa.Table.from_arrays(columns, schema=schema)


def _array(variable: Variable, values: np.ndarray, kind: pa.DataType, mask: np.ndarray) -> pa.Array:
    if pa.types.is_float64(kind):
        return pa.array(np.ascontiguousarray(values, float), kind, mask=mask)
    whole = np.where(np.isnan(values), 0, values).astype(np.int32)
    if not pa.types.is_dictionary(kind):
        return pa.array(whole != 0 if pa.types.is_boolean(kind) else whole, kind, mask=mask)
    # Enumerations by name. A number that the FMU does not declare is no item: null.
    places = {value: place for place, value in enumerate(variable.item_values)}
    items = pa.array(
        [None if bad else places.get(one) for one, bad in zip(whole.tolist(), mask, strict=True)], pa.int32()
    )
    return pa.DictionaryArray.from_arrays(items, pa.array(variable.items, pa.string()))


def _words(text: str | None) -> str | None:
    if text is None:
        return None
    line = " ".join(text.split())
    return line if len(line) <= MESSAGE_WORDS else line[: MESSAGE_WORDS - 1].rstrip() + "…"


BATCH = re.compile(r"(\d+)-(\d+)\.parquet")
DIGITS = 13  # of a run's number in a file's name: 2**40 has so many
# Rows gathered for a row group at least: readers skip and decode by groups.
GROUP_ROWS = 50_000
# Columns of words are worth a dictionary; numbers of a sample hardly ever repeat.
WORDS = pa.types.is_dictionary


class Store:
    """Opened for one sweep at a time"""

    def __init__(self, folder: Path, study: Study):
        self.folder, self.study = folder, study
        self.schema = schema_of(study)
        self.batches = folder / "batches"
        self.results = folder / "results.parquet"
        self.runs = study.samples().runs
        self._lock: int | None = None

    def open(self, resume: bool) -> None:
        """Takes the folder; one that holds another study, or results without --resume, is refused"""
        if self.folder.exists() and not self.folder.is_dir():
            raise UserError(f"{self.folder}: this is a file, and a folder is needed")
        with self._room():
            self.folder.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(self.folder / ".lock", os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise UserError(f"{self.folder} is in use by another sweep; give another folder with -o") from None
        known = None
        with contextlib.suppress(OSError, ValueError):
            known = json.loads((self.folder / "study.json").read_text(encoding="utf-8"))
        if known is None:
            if self.results.exists() or self.batches.exists():
                said = "holds results of unknown origin; give another folder with -o"
                raise UserError(f"{self.folder} {said}")
            about = {"digest": self.study.digest(), "fmu": self.study.fmu.name, "runs": self.runs}
            about |= {"fmu_sha256": fmu_digest(self.study.fmu), "study": self.study.content}
            with self._whole(self.folder / "study.json") as part:
                part.write_text(json.dumps(about, indent=1, default=str, ensure_ascii=False), encoding="utf-8")
        elif known.get("digest") != self.study.digest():
            fmu = known.get("fmu_sha256") != fmu_digest(self.study.fmu)
            other = "was made with another build of the FMU" if fmu else "holds the results of another study"
            raise UserError(f"{self.folder} {other}; give another folder with -o")
        elif not resume:
            said = "holds this study's results; --resume goes on, -o names another folder"
            raise UserError(f"{self.folder} {said}")
        self.batches.mkdir(exist_ok=True)

    def close(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    @contextlib.contextmanager
    def _room(self) -> Iterator[None]:
        """A failure to write ends in a sentence, and the rows that are there stay."""
        try:
            yield
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno else str(error)
            said = "" if self._lock is None else f"; {self.done():,} of {self.runs:,} runs are kept there"
            raise RunFailure(f"{self.folder}: cannot be written ({reason}){said}, --resume goes on") from None

    @contextlib.contextmanager
    def _whole(self, file: Path) -> Iterator[Path]:
        """The file appears whole or not at all: what is yielded is written, and renamed in the end."""
        part = file.with_name(f"{file.name}.part")
        with self._room():
            try:
                yield part
                part.replace(file)
            except OSError:
                part.unlink(missing_ok=True)
                raise

    # batches

    def files(self) -> list[tuple[int, int, Path]]:
        """First run, run after the last, file; by first run"""
        matches = ((BATCH.fullmatch(file.name), file) for file in self.batches.glob("*.parquet"))
        return sorted((int(match[1]), int(match[2]), file) for match, file in matches if match)

    @property
    def complete(self) -> bool:
        return self.results.exists()

    def done(self) -> int:
        return self.runs if self.complete else sum(end - first for first, end, _ in self.files())

    def check(self) -> None:
        """Throws away what a full disk or a power cut may have left: such files are no batches"""
        for part in self.folder.rglob("*.part"):
            part.unlink()
        for first, end, file in self.files():
            try:
                whole = pq.read_metadata(file).num_rows == end - first
            except (OSError, pa.ArrowException):
                whole = False
            if not whole:
                file.unlink()

    def gaps(self) -> list[tuple[int, int]]:
        """Stretches of runs that are still to be done"""
        found, after = [], 0
        for first, end, _ in self.files():
            if first > after:
                found.append((after, first))
            after = end
        return [*found, (after, self.runs)] if after < self.runs else found

    def write(self, table: pa.Table, first: int) -> None:
        name = f"{first:0{DIGITS}}-{first + len(table):0{DIGITS}}.parquet"
        with self._whole(self.batches / name) as part, self._writer(part, "none") as writer:
            writer.write_table(table)

    def _writer(self, file: Path, compression: str) -> pq.ParquetWriter:
        words = [field.name for field in self.schema if WORDS(field.type)]
        return pq.ParquetWriter(
            file, self.schema, compression=compression, use_dictionary=[*words, "message"], write_statistics=True
        )

    # all runs

    def groups(self) -> Iterator[pa.Table]:
        """All batches in order, gathered to row groups"""
        gathered: list[pa.Table] = []
        for _, _, file in self.files():
            with pq.ParquetFile(file) as rows:  # pq.read_table would import pandas, a third of a second
                gathered.append(rows.read())
            if sum(map(len, gathered)) >= GROUP_ROWS:
                yield pa.concat_tables(gathered)
                gathered = []
        if gathered:
            yield pa.concat_tables(gathered)

    def merge(self) -> None:
        """One file of all runs, in order; then the batches go"""
        with self._whole(self.results) as part, self._writer(part, "snappy") as writer:
            for group in self.groups():
                writer.write_table(group, row_group_size=max(len(group), 1))
        shutil.rmtree(self.batches)

    def write_csv(self) -> Path:
        """Writes the rows as text. Units and the study stand in a .json beside it."""
        from pyarrow import csv

        target = self.folder / "results.csv"
        units = {one.name: (one.metadata or {}).get(b"unit", b"").decode() for one in self.schema}
        plain = pa.schema([pa.field(one.name, pa.string()) if WORDS(one.type) else one for one in self.schema])
        with self._whole(target) as part, pq.ParquetFile(self.results) as rows, csv.CSVWriter(part, plain) as writer:
            for index in range(rows.num_row_groups):
                writer.write_table(rows.read_row_group(index).cast(plain))
        about = {"units": units, "study_digest": self.study.digest()}
        with self._whole(notes_file(target)) as part:
            part.write_text(json.dumps(about, ensure_ascii=False) + "\n", encoding="utf-8")
        return target

    def counts(self) -> tuple[dict[str, int], int]:
        """Runs by status, and how many the FMU warned of"""
        found: dict[str, int] = {}
        warned = 0
        with pq.ParquetFile(self.results) as rows:
            for index in range(rows.num_row_groups):
                group = rows.read_row_group(index, columns=["status", "warnings"])
                for one in group["status"].value_counts().to_pylist():
                    found[one["values"]] = found.get(one["values"], 0) + one["counts"]
                warned += int(np.count_nonzero(group["warnings"].to_numpy()))
        return found, warned
