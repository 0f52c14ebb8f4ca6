"""The same inputs give the same bits: run to run, with any compiler and flags, across a saved state.

Instance to instance and thread to thread are test_threads.py's, processes test_state.py's. No build may
fuse a multiplication and an addition (-ffp-contract=off), none uses -ffast-math, and all call the same C
library and CVODE: nothing is left that a compiler may choose, whatever operations a processor could fuse."""

import functools
import re
from pathlib import Path

import pytest

from support.fmi2 import raw
from support.fmi2.other_builds import build
from support.fmi2.raw import WARNING
from support.fmi2.runs import RUNS, begin, go_on
from support.programs import finished
from support.scenes.benchmarks import BENCHMARKS

FUSING = ["-O3", "-mavx2", "-mfma"]
CAN_FUSE = "fma" in Path("/proc/cpuinfo").read_text().split()
# Some of each for every scene: -O0 is quick to compile, -O3 is where compilers differ most.
BUILDS = {
    "gcc -O0": ("SphereSphere", "gcc", ["-O0"]),
    "clang -O3": ("SphereSphere", "clang", ["-O3"]),
    "gcc -O3 for this processor": ("SphereCylinder", "gcc", FUSING if CAN_FUSE else ["-O3", "-march=native"]),
    "clang -O0": ("SphereCylinder", "clang", ["-O0"]),
}
FUSED = r"\bvfn?m(?:add|sub)\w*"  # instructions of x86-64
METHODS = {"event_driven": (1, 7), "cvode_bdf": (3,), "cvode_adams": (3,)}  # with numbers of steps


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Each build is made once."""
    return functools.cache(lambda *how: build(how[0], how[1], how[2:], tmp_path_factory.mktemp("build")))


@pytest.fixture(scope="module", params=BUILDS)
def pair(request, built) -> tuple[raw.Fmu, raw.Fmu]:
    """The FMU as it was built, and with the code of another build"""
    scene, compiler, flags = BUILDS[request.param]
    return raw.load(scene), built(scene, compiler, *flags)


def test_no_operation_is_fused_for_a_processor_that_could(built):
    """gcc 12 makes some of sums and differences side by side, whatever -ffp-contract says."""
    other = built("SphereCylinder", "gcc", *FUSING)
    code = finished(["objdump", "-d", "--no-show-raw-insn", str(other.library_file)], check=True).stdout
    assert "vmulpd" in code
    assert re.findall(FUSED, code) == []


def benchmarks_of(fmu):
    """Stiff impacts in one communication step or several, by every method"""
    problems = [problem for problem in BENCHMARKS.values() if problem.fmu == fmu.name][:1]
    assert problems
    return [(problems[0], method, steps) for method in METHODS for steps in METHODS[method]]


def bits_of(fmu, problem, method, steps):
    values = {**problem.configuration, "solver.method": method}
    with raw.Instance(fmu) as instance:
        instance.initialize(values, tolerance=1e-9)
        rows = []
        for index in range(steps):
            time = instance.time()
            status = instance.call("DoStep", time, problem.end * (index + 1) / steps - time, 1)
            assert status <= WARNING, instance.texts()
            rows.append(instance.bits("output"))
        return rows


def test_runs_have_the_same_bits_from_another_compiler(pair):
    shipped, other = pair
    names = [name for name, run in RUNS.items() if run.scene == shipped.name]
    assert len(names) > 4
    for name in names:
        with begin(RUNS[name], shipped) as one, begin(RUNS[name], other) as two:
            assert go_on(one, RUNS[name], 0) == go_on(two, RUNS[name], 0), name


def test_stiff_impacts_have_the_same_bits_from_another_compiler(pair):
    shipped, other = pair
    for problem, method, steps in benchmarks_of(shipped):
        expected = bits_of(shipped, problem, method, steps)
        assert bits_of(shipped, problem, method, steps) == expected, "from run to run"
        assert bits_of(other, problem, method, steps) == expected, (problem.configuration, method, steps)


def test_a_state_saved_by_one_build_goes_on_in_another(pair):
    """One step over several impacts, split at a state that is saved: both builds, whoever saved it"""
    shipped, other = pair
    problem = next(problem for problem in BENCHMARKS.values() if problem.fmu == shipped.name)
    for method in METHODS:
        with raw.Instance(shipped) as one, raw.Instance(other) as two:
            one.initialize({**problem.configuration, "solver.method": method}, tolerance=1e-9)
            one.run([0.4 * problem.end])
            saved = one.save()
            rest = (problem.end - one.time(), one.time())
            expected = one.run([rest[0]], start=rest[1])
            two.restore(saved)
            assert two.save() == saved
            assert two.run([rest[0]], start=rest[1]) == expected
