"""The peers' problems P1, P2, P3 and P3b through the FMU, whatever the communication steps; and ten variants
of each with the event-driven method."""

from operator import itemgetter

import pytest

from support.checks import FMU, check_close, run
from support.reference.stored import both_bodies, errors_beyond, stored
from support.scenes.benchmarks import BENCHMARKS

TOLERANCE = 1e-10
EXACT = 1e-9  # m, event_driven


@pytest.mark.parametrize("tolerance, allowed", [(1e-8, 1e-4), (TOLERANCE, 1e-6)])
@pytest.mark.parametrize("steps", [1, 10, 1000])
@pytest.mark.parametrize("method", ["cvode_bdf", "cvode_adams"])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_cvode_ends_at_the_reference(opened, name, method, steps, tolerance, allowed):
    """At the everyday tolerance of 1e-8 the place is right to a tenth of a millimetre."""
    problem = BENCHMARKS[name]
    fmu = run(opened(problem.fmu), problem.configuration, problem.end, steps, tolerance, method)
    check_close(f"{name} position", fmu["source.position"], problem.position, allowed)


@pytest.mark.parametrize("tolerance", [None, TOLERANCE])
@pytest.mark.parametrize("steps", [1, 10, 997])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_event_driven_is_exact_to_a_nanometre(opened, name, steps, tolerance):
    """The claim holds at the FMU's default tolerance too."""
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


# The tolerance asked for is the error got: at the end of P1, P2, P3, P3b and of 200 random scenes the
# displacements are within FACTOR * tolerance * max(1 m, displacement) of another integrator's in 40 digits.
#
# Velocities, energies and onset times may also be off by what a relative change of everything given, by
# FACTOR * tolerance, does to them: behind a stiff contact they hang on the instant it began.

FACTOR = 10
TOLERANCES = [1e-6, 1e-9, 1e-12]
METHOD = "event_driven"
WIDE, CREEPING = stored("wide"), stored("overdamped")


def asked(configuration, tolerance, by):
    """Gives the tolerance as the importer's, or as the parameter."""
    if by == "importer":
        return configuration, tolerance
    return {**configuration, "solver.relative_tolerance": tolerance}, None


@pytest.mark.parametrize("by", ["importer", "parameter"])
@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_end_of_a_benchmark_is_as_exact_as_asked(opened, name, tolerance, by):
    problem = BENCHMARKS[name]
    configuration, given = asked(problem.configuration, tolerance, by)
    fmu = run(opened(problem.fmu), configuration, problem.end, 1, given, METHOD)
    check_close(f"{name} position", fmu["source.position"], problem.position, FACTOR * tolerance)


@pytest.mark.parametrize("by", ["importer", "parameter"])
@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("row", WIDE, ids=itemgetter("name"))
def test_the_end_of_a_random_scene_is_as_exact_as_asked(opened, row, tolerance, by):
    configuration, given = asked(row["values"], tolerance, by)
    fmu = run(opened(FMU[row["shape"]]), configuration, row["end"], 1, given, METHOD)
    assert errors_beyond(fmu, row, tolerance, FACTOR) == []


@pytest.mark.parametrize("steps", [1, 97])
@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("row", CREEPING, ids=itemgetter("name"))
def test_a_contact_that_creeps_is_as_exact_as_asked(opened, row, tolerance, steps):
    fmu = run(opened(FMU[row["shape"]]), row["values"], row["end"], steps, tolerance, METHOD)
    assert errors_beyond(fmu, row, tolerance, FACTOR) == []


@pytest.mark.parametrize("row", WIDE[::4], ids=itemgetter("name"))
def test_communication_steps_cost_no_accuracy(opened, row):
    fmu = run(opened(FMU[row["shape"]]), row["values"], row["end"], 97, 1e-9, METHOD)
    assert errors_beyond(fmu, row, 1e-9, FACTOR) == []


def test_the_scenes_are_of_many_kinds():
    """The references hold each kind of contact: flights, trains of bounces, lasting contact."""
    rows = WIDE
    assert len(rows) == 200
    assert sum(row["onsets"] == 0 for row in rows) < 10
    assert sum(row["onsets"] >= 3 for row in rows) > 50
    assert sum(row["energy.contact"] > 0 for row in rows) > 10
    assert sum(row["steps"] > 300 for row in rows) > 5


def test_the_comparison_sees_an_error(opened):
    """A run that ends a little early is found out."""
    row = WIDE[0]
    fmu = run(opened(FMU[row["shape"]]), row["values"], row["end"] * (1 - 1e-7), 1, 1e-12, METHOD)
    assert errors_beyond(fmu, row, 1e-9, FACTOR)
