"""What leaving out saves: variables, library, state and time per communication step of each FMU"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file, fmus_folder
from contact_fmus.fmu.host import Case, run_host

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
    time: float  # s per communication step
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
        start = open_start(fmu, name)
    own, other = times_per_step(name, universal, start)
    return FmuSize(name, variables, library, state, own, universal, other)


def times_per_step(name: str, universal: str | None, start: dict[str, Any]) -> tuple[float, float]:
    """The least of several averages over STEPS steps, in turns: what the machine does besides only adds"""
    cases = [Case(name, fmu_file(name), STEP * STEPS, STEPS)]
    if universal is not None:
        cases.append(Case(universal, fmu_file(universal), STEP * STEPS, STEPS, start=start))
    times = [result.least / STEPS for result in run_host(cases, REPETITIONS)]
    return times[0], times[1] if universal is not None else 0.0


def open_start(fmu: ContactFmu, name: str) -> dict[str, Any]:
    """What lets the FMU with every choice open do the same: what the scene pins, and all parameters, whose
    start values are others there
    """
    given = [one for one, variable in fmu.variables.items() if variable.causality == "parameter"]
    whole = {one: fmu[one] for one in given if not one.endswith("]")}
    return whole | _constants(scene_file(name).get("pinned", {}))


def _constants(pinned: dict[str, Any]) -> dict[str, Any]:
    """Without the choices that keep several of their items"""
    return {
        name: value
        for name, value in pinned.items()
        if not (isinstance(value, list) and isinstance(value[0], str))
    }
