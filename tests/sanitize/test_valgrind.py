"""valgrind finds no wrong access, no unset value and no leak in an FMU that the C host runs."""

import pytest

from contact_fmus.fmu.host import Case, case_arguments, host_file
from support.programs import finished
from support.scenes.benchmarks import BENCHMARKS

VALGRIND = [
    "valgrind", "--quiet", "--error-exitcode=99", "--leak-check=full",
    "--show-leak-kinds=definite,indirect,possible", "--errors-for-leak-kinds=definite,indirect,possible",
    "--keep-debuginfo=yes",  # the host closes the library before leaks are looked for
]  # fmt: skip


def checked(*command):
    return finished([*VALGRIND, *command])


@pytest.mark.parametrize("method", ["event_driven", "cvode_bdf"])
def test_a_scenario_is_clean(fmu_path, method):
    problem = BENCHMARKS["P2"]
    start = {**problem.configuration, "solver.method": method}
    case = Case("P2", fmu_path(problem.fmu), problem.end, 20, start, outputs=("contact.onsets",))
    run = checked(host_file(), "--repeat", "2", "--fresh", *case_arguments(case))
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.count("P2") == 1


def test_valgrind_would_tell(tmp_path):
    """Without this the test above could pass because nothing looks."""
    source, program = tmp_path / "bad.c", tmp_path / "bad"
    source.write_text(
        "#include <stdlib.h>\n"
        "int main(int count, char **names)\n"
        "{\n    (void)names;\n    char *lost = malloc(9);\n    if (lost[count] == 3) {\n"
        "        return 1;\n    }\n    lost = 0;\n    return 0;\n}\n"
    )
    finished(["gcc", "-O0", "-g", source, "-o", program], check=True)
    run = checked(program)
    assert run.returncode == 99
    assert "uninitialised value" in run.stderr and "definitely lost" in run.stderr
