"""The atlas' motion at a rim against the reference of the physics tests, which integrates it in space"""

import math

import numpy as np
import pytest

from contact_fmus.stability.edge import TURN, Edge
from support.checks import check_close
from support.reference.capped import CappedPair, run


@pytest.mark.parametrize("hertz", [False, True])
@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("angle, offset", [(TURN, 0.03), (TURN, -0.03), (0.0, 0.1), (math.pi / 4, -0.04)])
def test_the_ball_is_where_the_other_reference_sees_it(angle, offset, law, hertz):
    edge = Edge(law=law, hertz=hertz, angle=angle, offset=offset, depth=0.1).timed()
    pair = CappedPair(
        radius=edge.source_radius,
        other_radius=edge.destination_radius,
        length=edge.length,
        axis=(0.0, 1.0, 0.0),
        masses=(edge.source_mass, np.inf),
        gravity=(0.0, 0.0, 0.0),
        hertz=hertz,
        stiffness=edge.stiffness,
        damping=edge.damping,
        dashpot="unclamped" if law == "undamped" else law,
    )
    begin, velocity = [*edge.begin(), 0.0], [*(edge.speed * edge.towards()), 0.0]
    there = run(pair, np.concatenate([begin, np.zeros(3), velocity, np.zeros(3)]), edge.end)
    moved = np.subtract(there.state[:3], begin)
    check_close("displacement", edge.expected().displacement["source"], moved, 1e-9)
    assert sum(branch == "full" for _, branch in there.changes) == edge.expected().onsets


def test_a_ball_that_keeps_off_passes():
    edge = Edge(offset=0.2).timed()
    there = edge.expected()
    assert there.onsets == 0 and there.last_onset is None
    check_close("displacement", there.displacement["source"], [0.0, -edge.speed * edge.end, 0.0], 1e-15)
