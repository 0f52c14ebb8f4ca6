"""Ways to solve a benchmark problem: method, tolerance and number of communication steps"""

from __future__ import annotations

from typing import NamedTuple

from contact_fmus.fmu.files import fmu_file
from contact_fmus.fmu.host import Case

from .problems import Problem

EVENT_DRIVEN, CVODE = "event_driven", ("cvode_bdf", "cvode_adams")
METHODS = (EVENT_DRIVEN, *CVODE)
ABSOLUTE = 1e-4  # absolute tolerance / relative tolerance, as in the start values
CVODE_ERROR, EVENT_DRIVEN_ERROR = 1e-7, 1e-9  # m, what the compared runs have to reach
STIFF_TOLERANCE = 1e-9  # of the runs that the stiffness tables show


class Setting(NamedTuple):
    """One way to solve a problem"""

    problem: Problem
    method: str
    tolerance: float
    steps: int

    @property
    def name(self) -> str:
        return f"{self.problem.title}, {self.method}, {self.tolerance:g}, {self.steps} steps"

    @property
    def where(self) -> str:
        return f" at {self.tolerance:g}, p_n = {self.problem.penalty_factor:g} N/m"

    def case(self) -> Case:
        start = {
            **self.problem.start,
            "solver.method": self.method,
            "solver.relative_tolerance": self.tolerance,
            "solver.absolute_tolerance": ABSOLUTE * self.tolerance,
        }
        outputs = ("source.position", "contact.onsets")
        return Case(
            self.name, fmu_file(self.problem.fmu), self.problem.stop, self.steps, start, outputs=outputs
        )
