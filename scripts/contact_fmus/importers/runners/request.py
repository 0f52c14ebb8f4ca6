"""What every runner is asked, and how it answers"""

import json
import sys
from dataclasses import dataclass


@dataclass(frozen=True)
class Request:
    fmu: str
    step: float  # s
    count: int
    references: dict[str, int]


def request() -> Request:
    fmu, step, count, *outputs = sys.argv[1:]
    pairs = (output.rpartition("=") for output in outputs)
    return Request(fmu, float(step), int(count), {name: int(number) for name, _, number in pairs})


def answer(version: str, names, values) -> None:
    print(json.dumps({"version": version, "values": dict(zip(names, values, strict=True))}))
