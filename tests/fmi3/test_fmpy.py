"""An importer that others wrote: fmpy simulates the FMI 3.0 FMUs, with and without event mode."""

import math

import fmpy
import numpy as np
import pytest

from contact_fmus.fmu.files import fmu_file
from support.checks import check_close
from support.fmi3 import raw

EXPERIMENT = {"stop_time": 1.0, "output_interval": 0.05, "relative_tolerance": 1e-10}


def simulate(path, **options):
    return fmpy.simulate_fmu(str(path), **EXPERIMENT, **options)


@pytest.mark.parametrize("scene", raw.SCENES)
def test_fmpy_records_what_it_records_of_fmi2(scene):
    third, second = simulate(raw.FMUS / f"{scene}.fmu"), simulate(fmu_file(scene))
    assert len(third) == len(second) == 21
    for name in third.dtype.names:
        columns = third[name].reshape(len(third), -1).T
        names = [name] if len(columns) == 1 else [f"{name}[{k + 1}]" for k in range(len(columns))]
        for column, scalar in zip(columns, names, strict=True):
            assert np.array_equal(column, second[scalar]), scalar


def test_with_event_mode_fmpy_records_the_impact():
    """A ball falls 0.3 m on a sphere; fmpy shortens its step to the instant at which they touch."""
    values = {"source.center": [0.0, 0.0, 0.9], "gravity": [0.0, 0.0, -10.0]}
    rows = simulate(
        raw.FMUS / "SphereSphere.fmu",
        start_values=values,
        early_return_allowed=True,
        use_event_mode=True,
        output=["contact.onsets", "contact.gap"],
    )
    first = rows[np.flatnonzero(rows["contact.onsets"])[0]]
    check_close("time", first["time"], math.sqrt(2 * 0.3 / 10.0), 1e-12)
    check_close("gap", first["contact.gap"], 0.0, 1e-12)
