"""The energy balance of every law, dashpot, location and shape, and each term on its own, along runs."""

from itertools import pairwise

import numpy as np
import pytest

from support.checks import METHODS, check_close, run
from support.scenes.head_on import AXIS, DASHPOTS, GEOMETRIES, approach, head_on
from support.scenes.scene_checks import FMU

BALANCE = 1e-8  # of the largest term, at tolerance 1e-10
TERMS = [f"energy.{name}" for name in ("kinetic", "potential", "contact", "dissipated", "external_work")]
LAWS = {
    "penalty": {"contact.method": "penalty"},
    "penalty_dynamic": {"contact.method": "penalty_dynamic"},
    "viscous_only": {"contact.method": "penalty_dynamic", "contact.penalty_control": "viscous_only"},
}


class Balance:
    """Records total energy and the largest term at every communication point."""

    def __init__(self):
        self.totals, self.dissipated, self.largest = [], [], 0.0

    def __call__(self, fmu):
        terms = {name: fmu[name] for name in TERMS}
        total = fmu["energy.total"]
        summed = sum(terms.values()) - 2 * terms["energy.external_work"]
        size = max(map(abs, terms.values()))
        check_close("energy.total against its terms", total, summed, 1e-14 * size)
        self.totals.append(total)
        self.dissipated.append(terms["energy.dissipated"])
        self.largest = max(self.largest, size)

    def check(self):
        wanted = [self.totals[0]] * len(self.totals)
        check_close("energy.total along the run", self.totals, wanted, BALANCE * self.largest)


def oblique(shape, location, law, dashpot):
    """A ball bouncing under gravity with sideways speed; several contacts."""
    down = approach(location)
    values = head_on(shape, location, gap=0.02, contact_dashpot=dashpot, **{"contact_penalty_factor": 1e5})
    values.update(LAWS[law])
    values["gravity"] = (20 * down).tolist()
    values["source.initial_velocity"] = (0.5 * down + 0.2 * AXIS + 0.1 * np.cross(AXIS, down)).tolist()
    return values


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dashpot", DASHPOTS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_energy_balances_for_every_law_and_dashpot(opened, shape, location, law, dashpot, method):
    balance = Balance()
    fmu = run(
        opened(FMU[shape]), oblique(shape, location, law, dashpot), 0.4, 40, method=method, each=balance
    )
    assert fmu["contact.onsets"] >= 1
    balance.check()
    if law == "penalty":
        check_close("energy.dissipated", max(balance.dissipated), 0.0, BALANCE * balance.largest)
    else:
        assert balance.dissipated[-1] > 1e-3
        slack = BALANCE * balance.largest
        assert all(b >= a - slack for a, b in pairwise(balance.dissipated)), (
            f"dissipated work falls: {balance.dissipated}"
        )
