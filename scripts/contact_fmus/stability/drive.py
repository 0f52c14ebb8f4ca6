"""Runs one scene on an FMU and keeps what the checks need: the motion at every communication point's end"""

from __future__ import annotations

import ctypes
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError, Status, fmu_file

BODIES = ("source", "destination")
ENERGIES = ("kinetic", "rotational", "potential", "contact", "tangential", "dissipated", "friction")
ENERGIES += ("external_work", "total")
REALS = [
    *(f"{body}.{row}[{i}]" for body in BODIES for row in ("displacement", "velocity") for i in (1, 2, 3)),
    *(f"energy.{name}" for name in ENERGIES),
    *(f"contact.mean_force[{i}]" for i in (1, 2, 3)),
    *(f"source.orientation[{i}]" for i in (1, 2, 3, 4)),
    *(f"contact.{name}" for name in ("last_onset_time", "last_duration")),
    *(f"contact.{name}" for name in ("peak_force", "peak_penetration")),
]
PEAKS = 2  # at the end of REALS: an FMU refuses those that rounding of a stiff contact leaves unknown
COUNTS = ["contact.onsets", "solver.steps", "solver.events", "solver.force_evaluations", "solver.fallbacks"]


class Sample:
    """The Reals of REALS at one time"""

    def __init__(self, time: float, values: np.ndarray):
        self.time, self.values = time, values

    def vector(self, name: str, size: int = 3) -> np.ndarray:
        first = REALS.index(f"{name}[1]")
        return self.values[first : first + size]

    def __getitem__(self, name: str) -> float:
        return self.values[REALS.index(name)]


@dataclass
class Outcome:
    """What came of a run"""

    samples: list[Sample] = field(
        default_factory=list
    )  # at the start and after every step, also a discarded one
    counts: dict[str, int] = field(default_factory=dict)
    status: str = "ok"  # ok, refused (at initialization), discarded (in a step)
    message: str = ""
    seconds: float = 0.0  # of stepping

    @property
    def last(self) -> Sample:
        return self.samples[-1]


class Driver:
    """The universal FMUs, each instantiated once"""

    def __init__(self) -> None:
        self._open: dict[str, tuple[ContactFmu, Any, Any]] = {}

    def fmu(self, name: str) -> tuple[ContactFmu, Any, Any]:
        if name not in self._open:
            fmu = ContactFmu(fmu_file(name))
            references = [fmu.variable(row).references[0] for row in REALS]
            array = (ctypes.c_uint * len(references))(*references)
            self._open[name] = (fmu, array, (ctypes.c_double * len(references))())
        return self._open[name]

    def run(self, name: str, start: dict[str, Any], end: float, steps: int, jumps=()) -> Outcome:
        """`start` may have "<input>.derivatives", from time 0 on; `jumps`: of the destination along z, at
        communication steps"""
        fmu, references, buffer = self.fmu(name)
        fmu.reset()
        fmu.messages.clear()
        outcome = Outcome()

        def sample() -> None:
            try:
                fmu.call("fmi2GetReal", fmu.slave.component, references, len(references), buffer)
            except FmuError as error:
                if "is not known" not in _text(error):
                    raise
                known = len(references) - PEAKS
                fmu.call("fmi2GetReal", fmu.slave.component, references, known, buffer)
                buffer[known:] = [0.0] * PEAKS  # they are a scale of energies only, and then none
            outcome.samples.append(Sample(fmu.time, np.array(buffer)))

        derivatives = {name: rows for name, rows in start.items() if name.endswith(".derivatives")}
        try:
            fmu.start({name: value for name, value in start.items() if name not in derivatives})
            for name, rows in derivatives.items():
                for order, row in enumerate(rows, start=1):
                    fmu.set_derivative(name.removesuffix(".derivatives"), row, order=order)
        except FmuError as error:
            return Outcome(status="refused", message=_text(error))
        sample()
        for step in range(steps):
            for jump in jumps:
                if jump.step == step:
                    fmu["destination.prescribed_displacement"] = [0.0, 0.0, jump.shift]
            begin = time.perf_counter()
            try:
                fmu.step(end * ((step + 1) / steps) - fmu.time)
            except FmuError as error:
                outcome.status = "discarded" if error.status == Status.DISCARD else "error"
                outcome.message = _text(error)
            outcome.seconds += time.perf_counter() - begin
            if outcome.status != "error":
                sample()
            if outcome.status != "ok":
                break
        if outcome.status != "error":
            outcome.counts = {row: fmu[row] for row in COUNTS}
        return outcome


def _text(error: FmuError) -> str:
    return " ".join(message.text for message in error.messages) or str(error)
