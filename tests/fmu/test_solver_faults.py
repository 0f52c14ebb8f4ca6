"""Each allocation of an FMU with a solver fails once, alone and with all after it: SUNDIALS' own too.

What the FMU asks for itself is refused and works when tried again. SUNDIALS 6.4.1 reads the null pointer that
it gets in the functions below and ends the process (it also prints, where CVodeCreate gets none); the list is
exact, so that a version of SUNDIALS that checks more makes this test fail.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from support.fmi2 import raw
from support.programs import PATIENCE, environment, python

HERE = Path(__file__).resolve().parent
LIBRARIES = Path(os.environ.get("CONTACT_BUILD", HERE.parents[1] / "build")).resolve() / "libraries"
CRASHES = {
    "N_VNewEmpty",
    "N_VCloneEmpty_Serial",
    "N_VClone_Serial",
    "SUNHashMap_New",
    "SUNNonlinSolNewEmpty",
    "SUNNonlinSol_Newton",
}
OWN = {"instance_create", "model_create", "state_list_add"}
EVENT_DRIVEN = 1


@pytest.fixture(scope="session")
def shim(tmp_path_factory) -> Path:
    compiler = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler, "a C compiler is needed"
    library = tmp_path_factory.mktemp("shim") / "failing_malloc.so"
    source = HERE / "failing_malloc.c"
    flags = ["-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]
    subprocess.run([*compiler.split(), *flags, str(source), "-o", str(library), "-ldl"], check=True)
    return library


def functions_at(library: Path, addresses: list[int]) -> list[str]:
    command = ["addr2line", "-f", "-e", str(library), *(hex(address - 1) for address in addresses)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.partition(".")[0] for line in lines[::2]]


@pytest.mark.parametrize("method", [1, 2, 3])
def test_every_failed_allocation_is_survived_but_for_those_sundials_does_not_check(shim, method):
    fmu = raw.load("SphereSphere")
    library = LIBRARIES / "SphereSphere.so"
    reference = fmu.variables["solver.method"].reference
    command = python("support.fmi2.solver_faults", library, fmu.guid, reference, method)
    run = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=environment(LD_PRELOAD=str(shim)),
    )
    assert run.returncode == 0, run.stderr
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row for row in rows if "fault" in row] == []
    names = functions_at(library, [row["caller"] for row in rows])
    ends = {}
    for name, row in zip(names, rows, strict=True):
        ends.setdefault(name, set()).update((row["alone"], row["and all after"]))
    died = {name for name, found in ends.items() if found != {"survived"}}
    if method == EVENT_DRIVEN:  # which allocates nothing of its own
        assert set(ends) == OWN
        assert died == set()
    else:
        assert set(ends) >= OWN | {"cvode_open"}
        assert died == CRASHES
