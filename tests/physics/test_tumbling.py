"""A ball fired at a cylinder that tumbles, in one communication step of 10 s: no touch is missed or made up.

scripts/studies/tumbling.py runs a thousand of these scenes.
"""

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, fmu_file
from support.scenes.tumbling_checks import failures

CASES = [
    ("event_driven", "open", range(60)),
    ("event_driven", "capped", range(20)),
    ("cvode_bdf", "open", range(60, 70)),
]
AT_ONCE = 10
RUNS = [(method, ends, i) for method, ends, seeds in CASES for i in seeds[::AT_ONCE]]


@pytest.mark.parametrize("method,ends,first", RUNS)
def test_onsets_are_those_of_an_independent_reference(method, ends, first):
    lines = []
    with ContactFmu(fmu_file("SphereCylinder")) as fmu:
        for seed in range(first, first + AT_ONCE):
            lines += failures(fmu, seed, method, ends)[0]
    assert not lines, "\n".join(lines)
