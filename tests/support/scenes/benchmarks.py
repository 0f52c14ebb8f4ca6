"""The four problems of the peers' comparison: configuration, end and position, as in their scenarios.

The references come from a quadruple-precision Taylor integrator checked by a second method; event_driven
ends within 1e-9 m of them (test_benchmarks.py)."""

from typing import NamedTuple

from contact_fmus.bench.problems import benchmarks

SHAPES = {"SphereSphere": "sphere", "SphereCylinder": "cylinder"}
MOTION = {"source.motion": "free", "destination.motion": "fixed"}


class Benchmark(NamedTuple):
    fmu: str
    shape: str
    configuration: dict
    end: float
    position: tuple


BENCHMARKS = {
    name: Benchmark(one.fmu, SHAPES[one.fmu], MOTION | one.start, one.stop, one.position)
    for name, one in benchmarks().items()
}
