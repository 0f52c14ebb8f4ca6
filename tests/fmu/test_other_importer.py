"""libcosim, an importer in C++ on FMI Library, computes what fmpy does where both call at the same times."""

import itertools
from collections.abc import Iterator

import numpy as np
import pytest
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmus_folder
from support.fmi2 import raw

STEPS = 2000
STEP = 1_000_000  # ns, the unit of libcosim's clock
TOLERANCE = 1e-12  # m; the calls are the same, and so are the bits where the processor is

LENGTHS = [*(f"source.position[{axis}]" for axis in (1, 2, 3)), "contact.gap"]
COUNTS = ["contact.onsets"]

# Beside the middle, so that the ball leaves sideways and every coordinate has something to say.
START = {"source.center[1]": 0.02, "source.center[2]": -0.05}

Row = tuple[list[float], list[int]]


def seconds(nanoseconds: int) -> float:
    """As libcosim computes it"""
    return nanoseconds / 1e9


def with_libcosim(fmu: raw.Fmu, path: str) -> Iterator[Row]:
    execution = CosimExecution.from_step_size(STEP)
    slave = CosimLocalSlave(path, "tested")
    index = execution.add_local_slave(slave)
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    found = {variable.name.decode(): variable.reference for variable in execution.slave_variables(index)}
    assert found.items() <= {(name, variable.reference) for name, variable in fmu.variables.items()}
    for name, value in START.items():
        assert execution.real_initial_value(index, found[name], value)
    lengths = [found[name] for name in LENGTHS]
    counts = [found[name] for name in COUNTS]
    for _ in range(STEPS):
        assert execution.step()
        yield (
            list(observer.last_real_values(index, lengths)),
            list(observer.last_integer_values(index, counts)),
        )


def with_fmpy(path: str) -> Iterator[Row]:
    with ContactFmu(path) as fmu:
        fmu.start(START)
        for before, after in itertools.pairwise(range(0, (STEPS + 1) * STEP, STEP)):
            fmu.call("doStep", seconds(before), seconds(after) - seconds(before))
            yield [fmu[name] for name in LENGTHS], [fmu[name] for name in COUNTS]


@pytest.mark.parametrize("scene", ["BallOnSphere", "SphereSphere"])
def test_libcosim_computes_what_fmpy_computes(scene):
    """Silently too: libcosim itself would tell errors only, and an FMU never writes to a stream."""
    log_output_level(CosimLogLevel.ERROR)
    path = str(fmus_folder() / f"{scene}.fmu")
    there = list(with_libcosim(raw.load(scene), path))
    here = list(with_fmpy(path))
    assert len(there) == len(here) == STEPS
    lengths_there, lengths_here = (np.array([lengths for lengths, _ in rows]) for rows in (there, here))
    assert np.abs(lengths_there - lengths_here).max() <= TOLERANCE
    assert [counts for _, counts in there] == [counts for _, counts in here]
    assert here[-1][1][0] >= 1, "no contact: nothing was compared"
