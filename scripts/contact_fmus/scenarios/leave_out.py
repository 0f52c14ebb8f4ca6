"""What leaving out saves: variables, library, state and time per communication step of each FMU"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file, fmus_folder

from .experiment import scene_file

STEP = 1e-3  # s, a usual communication step
STEPS = 1000
REPETITIONS = 5


@dataclass(frozen=True)
class FmuSize:
    name: str
    variables: int
    library: int  # bytes of the shared library
    state: int  # bytes of the serialized state
    time: float  # s per communication step, fmpy's part included
    universal: str | None  # the FMU with every choice open that does the same
    universal_time: float


def measure_all() -> list[FmuSize]:
    """Universal FMUs first, each followed by those that pin its choices; none whose scene is gone"""
    names = [file.stem for file in fmus_folder().glob("*.fmu") if scene_file(file.stem)]
    return [
        measure(name) for name in sorted(names, key=lambda name: (_family(name), name != _family(name), name))
    ]


def _family(name: str) -> str:
    """SphereSphere, SphereCylinder: the shapes of source and destination"""
    bodies = scene_file(name).get("body", [])
    return "".join(body["shape"].capitalize() for body in bodies)


def measure(name: str) -> FmuSize:
    family = _family(name)
    universal = family if family not in ("", name) and (fmus_folder() / f"{family}.fmu").is_file() else None
    with ContactFmu(fmu_file(name)) as fmu:
        library = sum(file.stat().st_size for file in Path(fmu.folder, "binaries").rglob("*.so"))
        variables = len(fmu.description.modelVariables)
        fmu.start()
        state = len(bytes(fmu.save()))
        own = time_per_step(fmu, {})
    other = 0.0
    if universal is not None:
        scene = scene_file(name)
        with ContactFmu(fmu_file(universal)) as fmu:
            other = time_per_step(fmu, scene.get("start", {}) | _constants(scene.get("pinned", {})))
    return FmuSize(name, variables, library, state, own, universal, other)


def _constants(pinned: dict[str, Any]) -> dict[str, Any]:
    """Without the choices that keep several of their items"""
    return {
        name: value
        for name, value in pinned.items()
        if not (isinstance(value, list) and isinstance(value[0], str))
    }


def time_per_step(fmu: ContactFmu, start: dict[str, Any]) -> float:
    """The least of several averages over STEPS steps: what the machine does besides only ever adds"""
    averages = []
    for _ in range(REPETITIONS):
        fmu.reset()
        fmu.start(start)
        do_step, component = fmu.slave.fmi2DoStep, fmu.slave.component
        begin = time.perf_counter()
        for index in range(STEPS):
            do_step(component, index * STEP, STEP, True)
        averages.append((time.perf_counter() - begin) / STEPS)
    return min(averages)
