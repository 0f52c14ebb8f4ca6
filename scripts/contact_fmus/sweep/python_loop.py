"""A batch of runs by fmpy, where the compiled loop is not there, and of FMI 3.0: the same calls, slower"""

import functools
import math
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException

from contact_fmus.fmu.slaves import slave_of

from .native import AT, MAX, MEAN, MESSAGE_SIZE, Batch, Clock, Plan, Rows

OK, WARNING, ERROR, FATAL = 0, 1, 3, 4  # fmi2Status
described = functools.cache(fmpy.read_model_description)


class _Instance:
    """One that is reset before each run, and replaced after an error"""

    def __init__(self, plan: Plan, folder: Path):
        self.plan, self.folder = plan, folder
        self.message, self.warnings = "", 0
        self.slave: Any = None

    def ready(self) -> Any:
        if self.slave is not None:
            try:
                self.slave.reset()
            except FMICallException as error:
                self.drop(error.status)
        if self.slave is None:
            description = described(self.folder, validate=False)
            slave = slave_of(description, self.folder, self.plan.identifier)
            slave.begin(self._log, debug=False)
            self.slave = slave
        self.message, self.warnings = "", 0
        return self.slave

    def drop(self, status: int) -> None:
        """After fmi2Fatal no function may be called, fmi2FreeInstance included"""
        if self.slave is not None and status != FATAL:
            self.slave.freeInstance()
        self.slave = None

    def _log(self, status: int, _category: str, text: str) -> None:
        self.warnings += status == WARNING
        if status > WARNING and not self.message:
            cut = text.replace("%", "%%").encode()[: MESSAGE_SIZE - 1].decode("utf-8", "ignore")
            self.message = cut.replace("%%", "%")  # as the compiled loop cuts it


def run(plan: Plan, batch: Batch, folder: Path) -> Rows:
    """`folder` is the unpacked FMU"""
    warnings = np.zeros(batch.runs, np.int32)
    clock = Clock()
    values = np.full((len(plan.outputs), batch.runs), math.nan)
    status = np.zeros(batch.runs, np.uint8)
    messages: dict[int, str] = {}
    instance = _Instance(plan, folder)
    for place in range(batch.runs):
        try:
            values[:, place] = _run_once(plan, batch, place, instance.ready())
        except FMICallException as error:
            status[place] = error.status
            messages[place] = instance.message
            if error.status >= ERROR:
                instance.drop(error.status)
        warnings[place] = instance.warnings
    instance.drop(OK)
    return Rows(batch.first, values, status, messages, clock.seconds(), warnings)


def _run_once(plan: Plan, batch: Batch, place: int, slave: Any) -> list[float]:
    slave.setupExperiment(plan.tolerance, plan.start_time, None)
    setters = (slave.setReal, slave.setInteger, slave.setBoolean)
    for setting, column, set_values in zip(plan.settings, batch.columns, setters, strict=True):
        if len(setting.references):
            values = [*column[:, place].tolist(), *setting.constants.tolist()]
            set_values(setting.references.tolist(), values)
    for reference, text in plan.strings:
        slave.setString([reference], [text])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    now, read = plan.start_time, np.full((len(plan.points) + 1, sum(map(len, plan.read))), math.nan)
    sizes = np.zeros(len(plan.points))
    for point in range(len(plan.points) + 1):
        if point > 0:
            sizes[point - 1] = size = float(plan.points[point - 1]) - now
            slave.doStep(now, size)
            now += size
        if plan.reads[point]:
            getters = zip(plan.read, (slave.getReal, slave.getInteger, slave.getBoolean), strict=True)
            read[point] = [one for references, get in getters if len(references) for one in get(references.tolist())]
    length = now - plan.start_time
    return [_reduced(read[:, source], code, point, sizes, length) for source, code, point in plan.outputs.tolist()]


def _reduced(values: np.ndarray, code: int, point: int, sizes: np.ndarray, length: float) -> float:
    """What is not a number stays. The mean is summed step by step, as the compiled loop does it."""
    if code == MEAN:
        return float(np.cumsum(0.5 * (values[:-1] + values[1:]) * sizes)[-1]) / length
    return float(values[point] if code == AT else values.max() if code == MAX else values.min())
