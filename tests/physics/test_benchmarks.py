"""The peers' problems P1, P2, P3 and P3b through the FMU, at tolerance 1e-10, whatever the communication
steps; and ten variants of each with the event-driven method.
"""

from functools import cache
from operator import itemgetter

import pytest

from support.checks import METHODS, check_close, run
from support.reference.stored import both_bodies, stored
from support.scenes.benchmarks import BENCHMARKS

ALLOWED = 1e-6  # m
TOLERANCE = 1e-10
EXACT = 1e-9  # m, event_driven


@pytest.fixture(scope="module")
def final_position(opened):
    @cache
    def position(name, method, steps):
        problem = BENCHMARKS[name]
        fmu = run(opened(problem.fmu), problem.configuration, problem.end, steps, TOLERANCE, method)
        return fmu["source.position"]

    return position


@pytest.mark.parametrize("steps", [1, 10, 1000])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", BENCHMARKS)
def test_end_of_the_run_is_the_reference(final_position, name, method, steps):
    check_close(f"{name} position", final_position(name, method, steps), BENCHMARKS[name].position, ALLOWED)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_error_follows_the_tolerance(opened, name, method):
    """At the everyday tolerance 1e-8 CVODE is still right to a tenth of a millimetre, event_driven to ten
    times the tolerance.
    """
    allowed = 1e-7 if method == "event_driven" else 1e-4
    problem = BENCHMARKS[name]
    fmu = run(opened(problem.fmu), problem.configuration, problem.end, 10, 1e-8, method)
    check_close(f"{name} position", fmu["source.position"], problem.position, allowed)


@pytest.mark.parametrize("tolerance", [None, TOLERANCE])
@pytest.mark.parametrize("steps", [1, 997])
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
