"""Rows of results as Arrow tables: run, parameters, outputs, status, message; units stand in the schema"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from contact_fmus.fmu.variables import Variable

from .plan import Rows
from .study import Output, Study, fmu_digest

# Of fmi2Status; a run whose process ended has no status of its own.
OK, DISCARD, CRASH = 0, 2, 255
STATUSES = ("ok", "discard", "error", "crash")
WORDS = 120  # characters kept of what an FMU said


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
        fields.append(_field(output.name, output_type(output), _output_about(output)))
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
    return pa.field(
        name, kind, nullable=nullable, metadata={key: value for key, value in about.items() if value}
    )


def _about(variable: Variable) -> dict[str, str]:
    return {
        "unit": variable.unit or ("1" if variable.type == "Real" else ""),
        "variable": variable.name,
        "description": variable.description,
    }


def _output_about(output: Output) -> dict[str, str]:
    at = "" if output.time is None else repr(output.time)
    return _about(output.variable) | {"role": "output", "reduce": output.reduction, "at": at}


def _type(variable: Variable) -> pa.DataType:
    if variable.type == "Enumeration":
        return pa.dictionary(pa.int32(), pa.string())
    return {"Real": pa.float64(), "Integer": pa.int32(), "Boolean": pa.bool_()}[variable.type]


def output_type(output: Output) -> pa.DataType:
    return pa.float64() if output.reduction == "mean" else _type(output.variable)


def make_table(study: Study, schema: pa.Schema, values: dict[str, np.ndarray], rows: Rows) -> pa.Table:
    """`values` are the parameters of these runs, as Samples.values gives them"""
    count = len(rows.status)
    columns: list[pa.Array] = [_numbers(np.arange(rows.first, rows.first + count), pa.int64(), None)]
    for one in study.parameters:
        columns += [
            _array(one.variable, values[one.name][:, index], _type(one.variable), None)
            for index in range(len(one.columns))
        ]
    failed = rows.status != OK
    for place, output in enumerate(study.outputs):
        mask = failed if failed.any() else None
        columns.append(_array(output.variable, rows.values[place], output_type(output), mask))
    # fmi2Error and fmi2Fatal are one to a user
    codes = np.select([~failed, rows.status == DISCARD, rows.status == CRASH], [0, 1, 3], 2).astype(np.int8)
    columns.append(pa.DictionaryArray.from_arrays(_numbers(codes, pa.int8(), None), _texts(STATUSES)))
    columns.append(_numbers(rows.warnings, pa.int32(), None))
    if rows.messages:
        columns.append(pa.array([_words(rows.messages.get(place)) for place in range(count)], pa.string()))
    else:
        columns.append(pa.nulls(count, pa.string()))
    return pa.Table.from_arrays(columns, schema=schema)


def _array(variable: Variable, values: np.ndarray, kind: pa.DataType, mask: Any) -> pa.Array:
    if pa.types.is_float64(kind):
        return _numbers(np.ascontiguousarray(values, float), kind, mask)
    whole = np.where(np.isnan(values), 0, values).astype(np.int32)
    if pa.types.is_dictionary(kind):
        return _items(variable, whole, mask)
    if pa.types.is_boolean(kind):
        return _numbers(np.packbits(whole != 0, bitorder="little"), kind, mask, len(whole))
    return _numbers(whole, kind, mask)


def _numbers(values: np.ndarray, kind: pa.DataType, mask: Any, count: int | None = None) -> pa.Array:
    """As pa.array, which would import pandas: a third of a second"""
    valid = None if mask is None else pa.py_buffer(np.packbits(~mask, bitorder="little"))
    return pa.Array.from_buffers(kind, len(values) if count is None else count, [valid, pa.py_buffer(values)])


def _texts(texts: Sequence[str]) -> pa.Array:
    """As pa.array, without pandas too"""
    encoded = [text.encode() for text in texts]
    offsets = np.cumsum([0, *map(len, encoded)]).astype(np.int32)
    buffers = [None, pa.py_buffer(offsets), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(texts), buffers)


def _items(variable: Variable, values: np.ndarray, mask: Any) -> pa.Array:
    """Enumerations by name. A number that the FMU does not declare is no item: null."""
    known = np.array(variable.item_values, np.int32)
    order = np.argsort(known)
    places = np.clip(np.searchsorted(known[order], values), 0, len(known) - 1)
    found = known[order][places] == values
    missing = ~found if mask is None else mask | ~found
    indices = _numbers(order[places].astype(np.int32), pa.int32(), missing if missing.any() else None)
    return pa.DictionaryArray.from_arrays(indices, _texts(variable.items))


def _words(text: str | None) -> str | None:
    if text is None:
        return None
    line = " ".join(text.split())
    return line if len(line) <= WORDS else line[: WORDS - 1].rstrip() + "…"
