"""The peers' problems P1, P2, P3 and P3b through the FMU, whatever the communication steps; and ten variants
of each with the event-driven method."""

from operator import itemgetter

import pytest

from support.checks import check_close, run
from support.reference.stored import both_bodies, stored
from support.scenes.benchmarks import BENCHMARKS

TOLERANCE = 1e-10
EXACT = 1e-9  # m, event_driven


@pytest.mark.parametrize("tolerance, allowed", [(1e-8, 1e-4), (TOLERANCE, 1e-6)])
@pytest.mark.parametrize("steps", [1, 10, 1000])
@pytest.mark.parametrize("method", ["cvode_bdf", "cvode_adams"])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_cvode_ends_at_the_reference(opened, name, method, steps, tolerance, allowed):
    """At the everyday tolerance 1e-8 still to a tenth of a millimetre"""
    problem = BENCHMARKS[name]
    fmu = run(opened(problem.fmu), problem.configuration, problem.end, steps, tolerance, method)
    check_close(f"{name} position", fmu["source.position"], problem.position, allowed)


@pytest.mark.parametrize("tolerance", [None, TOLERANCE])
@pytest.mark.parametrize("steps", [1, 10, 997])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_event_driven_is_exact_to_a_nanometre(opened, name, steps, tolerance):
    """With the FMU's own tolerance too"""
    problem = BENCHMARKS[name]
    fmu = run(opened(problem.fmu), problem.configuration, problem.end, steps, tolerance, "event_driven")
    check_close(f"{name} position", fmu["source.position"], problem.position, EXACT)


@pytest.mark.parametrize("steps", [1, 997])
@pytest.mark.parametrize("row", stored("variant"), ids=itemgetter("name"))
def test_event_driven_is_exact_on_variants_too(opened, row, steps):
    benchmark = BENCHMARKS[row["name"].split()[0]]
    fmu = run(opened(benchmark.fmu), row["values"], row["end"], steps, TOLERANCE, "event_driven")
    check_close("displacement", both_bodies(fmu, "displacement"), row["displacement"], EXACT)
    assert fmu["contact.onsets"] == row["onsets"]
