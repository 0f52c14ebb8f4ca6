"""The plan of a study, and the start values of its batches"""

from __future__ import annotations

import numpy as np

from .plan import AT, MAX, MEAN, MIN, Batch, Plan, Setting
from .study import Study, point_of
from .worker import Work

CODES = {"last": AT, "at": AT, "max": MAX, "min": MIN, "mean": MEAN}
REAL, INTEGER, BOOLEAN = range(3)
TYPES = {"Real": REAL, "Integer": INTEGER, "Enumeration": INTEGER, "Boolean": BOOLEAN}


def make_plan(study: Study) -> Plan:
    read: list[dict[int, int]] = [{}, {}, {}]
    for one in study.outputs:
        kind = read[TYPES[one.variable.type]]
        kind.setdefault(one.variable.references[0], len(kind))
    offsets = np.cumsum([0, *map(len, read)])
    rows, last = [], len(study.points)
    reads = np.zeros(last + 1, np.uint8)
    for one in study.outputs:
        kind = TYPES[one.variable.type]
        time = study.points[-1] if one.time is None else one.time
        point = point_of(time, study.start_time, study.points)
        assert point is not None
        rows.append((offsets[kind] + read[kind][one.variable.references[0]], CODES[one.reduction], point))
        reads[point if CODES[one.reduction] == AT else slice(None)] = 1
    strings = [(name, value) for name, value in study.constants.items() if isinstance(value, str)]
    references = study.interface.variables
    return Plan(
        study.interface.identifier,
        study.interface.guid,
        study.interface.fmi3,
        study.start_time,
        study.tolerance,
        np.array(study.points),
        reads,
        (_setting(study, REAL), _setting(study, INTEGER), _setting(study, BOOLEAN)),
        tuple((references[name].references[0], value) for name, value in strings),
        tuple(np.array(list(kind), np.uint32) for kind in read),  # type: ignore[arg-type]
        np.array(rows, np.int64).reshape(-1, 3),
    )


def make_work(study: Study) -> Work:
    return Work(study.fmu.read_bytes(), make_plan(study), study.interface.single)


def _setting(study: Study, kind: int) -> Setting:
    variables = study.interface.variables
    varied = [
        reference
        for one in study.parameters
        if TYPES[one.variable.type] == kind
        for reference in one.variable.references
    ]
    references, constants = list(varied), []
    for name, value in study.constants.items():
        if TYPES.get(variables[name].type) == kind:
            references += variables[name].references
            constants += value if isinstance(value, tuple) else [value]
    number = float if kind == REAL else np.int32
    return Setting(np.array(references, np.uint32), len(varied), np.array(constants, number))


def make_batch(study: Study, first: int, values: dict[str, np.ndarray]) -> Batch:
    """`values` are those of Samples.values"""
    count = len(next(iter(values.values())))

    def stacked(kind: int) -> np.ndarray:
        number = float if kind == REAL else np.int32
        rows = [values[one.name].T for one in study.parameters if TYPES[one.variable.type] == kind]
        return np.ascontiguousarray(np.concatenate(rows), number) if rows else np.zeros((0, count), number)

    return Batch(first, stacked(REAL), stacked(INTEGER), stacked(BOOLEAN))
