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
    settings: list[tuple[str, int, int]]  # name, reference and value of Integers


def request() -> Request:
    fmu, step, count, *rest = sys.argv[1:]
    references, settings = {}, []
    for text in rest:
        variable, _, value = text.partition(":=")
        name, _, number = variable.rpartition("=")
        if value:
            settings.append((name, int(number), int(value)))
        else:
            references[name] = int(number)
    return Request(fmu, float(step), int(count), references, settings)


def answer(version: str, names, values) -> None:
    print(json.dumps({"version": version, "values": dict(zip(names, values, strict=True))}))
