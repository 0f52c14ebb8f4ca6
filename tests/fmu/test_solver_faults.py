"""Each allocation of an FMU with a solver fails once, alone and with all after it: SUNDIALS' own too.

What the FMU asks for itself is refused and works when tried again. SUNDIALS 6.4.1 reads the null pointer
that it gets in the functions below and ends the process (it also prints, where CVodeCreate gets none); the
list is exact, so that a version of SUNDIALS that checks more makes this test fail."""

import json
import os
import shutil
from pathlib import Path

import pytest

from support.fmi2 import raw
from support.programs import environment, finished, python

HERE = Path(__file__).resolve().parent
LIBRARIES = Path(os.environ.get("CONTACT_BUILD", HERE.parents[1] / "build")).resolve() / "libraries"
CRASHES = {
    "N_VNewEmpty", "N_VCloneEmpty_Serial", "N_VClone_Serial", "SUNHashMap_New", "SUNNonlinSolNewEmpty",
    "SUNNonlinSol_Newton",
}  # fmt: skip
OWN = {"instance_create", "model_create", "block_to_write", "integrator_open"}
EVENT_DRIVEN = 1


@pytest.fixture(scope="session")
def shim(tmp_path_factory) -> Path:
    compiler = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler, "a C compiler is needed"
    library = tmp_path_factory.mktemp("shim") / "failing_malloc.so"
    source = HERE / "failing_malloc.c"
    flags = ["-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]
    finished([*compiler.split(), *flags, str(source), "-o", str(library), "-ldl"], check=True)
    return library


def functions_at(library: Path, addresses: list[int]) -> list[str]:
    command = ["addr2line", "-f", "-e", str(library), *(hex(address - 1) for address in addresses)]
    return [line.partition(".")[0] for line in finished(command, check=True).stdout.splitlines()[::2]]


def lives(shim: Path, what: str, scene: str, library: Path, method: int = 0) -> list[dict]:
    """The rows of support/fmi2/solver_faults.py, none of which is about a fault"""
    fmu = raw.load(scene)
    names = ("contact.gap", "solver.method") if method else ("contact.gap",)
    numbers = [*(fmu.variables[name].reference for name in names), 0][:2]
    command = python("support.fmi2.solver_faults", what, library, fmu.guid, *numbers, method)
    run = finished(command, env=environment(LD_PRELOAD=str(shim)))
    assert run.returncode == 0, run.stderr
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row for row in rows if "fault" in row] == []
    return rows


@pytest.mark.parametrize("method", [1, 2, 3])
def test_every_failed_allocation_is_survived_but_for_those_sundials_does_not_check(shim, method):
    library = LIBRARIES / "SphereSphere.so"
    rows = lives(shim, "fail", "SphereSphere", library, method)
    names = functions_at(library, [row["caller"] for row in rows])
    ends = {}
    for name, row in zip(names, rows, strict=True):
        ends.setdefault(name, set()).update((row["alone"], row["and all after"]))
    died = {name for name, found in ends.items() if found != {"survived"}}
    if method == EVENT_DRIVEN:
        assert set(ends) == OWN
        assert died == set()
    else:
        assert set(ends) >= OWN | {"cvode_open"}
        assert died == CRASHES


def test_every_failed_allocation_is_survived_where_there_is_no_solver(shim):
    rows = lives(shim, "fail", "ForceElement", raw.load("ForceElement").library_file)
    assert len(rows) >= 3
    assert {row[how] for row in rows for how in ("alone", "and all after")} == {"survived"}


def runs_with_cvode() -> list[tuple[str, int]]:
    """cvode_adams is explicit: at slip velocities of 1e-5 m/s or less a second takes it 1e6 steps or more."""
    stiff = [("GolfersDilemma", 3), ("Turntable", 3)]
    scenes = [name for name in raw.SOLVER_SCENES if name not in raw.WITHOUT_CVODE]
    return [(scene, method) for scene in scenes for method in (2, 3) if (scene, method) not in stiff]


@pytest.mark.parametrize("scene, method", runs_with_cvode())
def test_nothing_is_allocated_in_steps_and_nothing_is_kept(shim, scene, method):
    """Each life checks that; the integrator's memory, which is not the importer's, counts too."""
    assert len(lives(shim, "count", scene, raw.load(scene).library_file, method)) > 10


@pytest.mark.parametrize("scene", raw.WITHOUT_CVODE)
def test_nothing_but_the_models_own_memory_is_allocated_without_cvode(shim, scene):
    assert len(lives(shim, "count", scene, raw.load(scene).library_file)) <= 10
