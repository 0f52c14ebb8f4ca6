"""A ball fired at a cylinder that tumbles, in one communication step of 10 s: no touch is missed or made up.

scripts/studies/tumbling.py runs a thousand of these scenes.
"""

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.scenes.tumbling_checks import failures

SEEDS = {"event_driven": range(60), "cvode_bdf": range(60, 70)}
AT_ONCE = 10


@pytest.mark.parametrize(
    "method,first", [(name, i) for name, seeds in SEEDS.items() for i in seeds[::AT_ONCE]]
)
def test_onsets_are_those_of_an_independent_reference(method, first):
    lines = []
    with ContactFmu(fmu_file("SphereCylinder")) as fmu:
        for seed in range(first, first + AT_ONCE):
            lines += failures(fmu, seed, method)[0]
    assert not lines, "\n".join(lines)
