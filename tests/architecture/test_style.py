"""The style that tools can check: format, lint, lengths, and no trace of one machine."""

import ast
import os
import re
import sys

import pytest

from support import sources
from support.programs import finished

C_FILES = (
    sources.HEADERS
    + sources.UNITS
    + [file for name in ("scripts", "tests") for file in (sources.ROOT / name).rglob("*.[ch]")]
)
PROGRAMS = sorted((sources.ROOT / "scripts").rglob("*.c"))
FUNCTION_LINES = 60  # one screen
TIDY_NODES = 30_000
LINE_COLUMNS = 110  # ColumnLimit of .clang-format


def output(*command):
    """What the command says; empty when it is content."""
    run = finished(command, cwd=sources.ROOT)
    return "" if run.returncode == 0 else run.stdout + run.stderr


def test_c_is_formatted():
    assert output("clang-format", "--dry-run", "--Werror", *map(str, C_FILES)) == ""


@pytest.mark.parametrize("file", C_FILES, ids=sources.label)
def test_no_line_of_c_is_wider_than_110_columns(file):
    """Of comments and macros too, which clang-format does not break."""
    lines = enumerate(file.read_text(encoding="utf-8").splitlines(), 1)
    assert [f"line {number}: {len(line)}" for number, line in lines if len(line) > LINE_COLUMNS] == []


def test_python_is_linted():
    assert output(sys.executable, "-m", "ruff", "check", "--no-cache", ".") == ""


def test_python_is_formatted():
    assert output(sys.executable, "-m", "ruff", "format", "--no-cache", "--check", ".") == ""


@pytest.mark.parametrize("unit", sources.UNITS + PROGRAMS, ids=sources.label)
def test_clang_tidy_finds_nothing(unit):
    """One file a run: given several, clang-tidy 14 sees faults in va_list that are not there. A function is
    followed through TIDY_NODES places of its paths, in the long run through as many as is clang's default."""
    given = unit in sources.units_of("ForceElement") and unit not in sources.units_of("SphereCylinder")
    scene = sources.BUILD / "scenes" / ("ForceElement" if given else "SphereCylinder")
    arguments = ["-std=c11", "-D_POSIX_C_SOURCE=200809L", f"-I{sources.SOURCE}", f"-I{scene}"]
    if "CONTACT_SCENES" not in os.environ:
        for word in ("-analyzer-config", f"max-nodes={TIDY_NODES}"):
            arguments += ["-Xclang", word]
    arguments += ["-isystem", str(sources.fmi_headers())]
    assert output("clang-tidy", "--quiet", str(unit), "--", *arguments) == ""


def c_functions(text):
    """(first line, number of lines) of each function: Linux braces open and close it in the first column."""
    start = None
    for number, line in enumerate(sources.code_only(text).splitlines(), 1):
        if line == "{":
            start = number
        elif line.startswith("}") and start is not None:
            yield start, number - start + 1
            start = None


def python_functions(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.lineno, node.end_lineno - node.lineno + 1


@pytest.mark.parametrize("file", C_FILES + sources.python_files(), ids=sources.label)
def test_a_function_fits_one_screen(file):
    find = python_functions if file.suffix == ".py" else c_functions
    long = [f"line {line}: {lines}" for line, lines in find(file.read_text()) if lines > FUNCTION_LINES]
    assert long == []


def test_the_length_of_functions_is_measured():
    assert list(c_functions("int f(void)\n{\n    return 1;\n}\n\nstruct s {\n    int a;\n};\n")) == [(2, 3)]
    assert list(python_functions("def f():\n    return 1\n")) == [(1, 2)]


def test_every_folder_of_python_tests_is_run_by_ctest():
    listed = (sources.ROOT / "tests" / "CMakeLists.txt").read_text(encoding="utf-8")
    tests = sources.ROOT / "tests"
    folders = {file.parent.relative_to(tests).as_posix() for file in tests.rglob("test_*.py")}
    assert {"physics", "stability"} <= folders
    named = set(re.findall(r"^ *contact_python_tests\(\w+ tests/([\w/]+)", listed, re.MULTILINE))
    assert folders == named


def repository_files():
    listed = finished(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], check=True, cwd=sources.ROOT
    ).stdout.splitlines()
    files = [sources.ROOT / name for name in listed if "tests/fuzz/corpus/" not in name]
    return [file for file in files if file.suffix != ".png" and file.is_file()]


@pytest.mark.parametrize("file", repository_files(), ids=sources.label)
def test_a_file_knows_no_machine_and_leaves_nothing_to_do(file):
    text = file.read_text(encoding="utf-8")
    assert re.findall(r"(?<![\w.}])/(?:home|root|Users|tmp|work)/\w+", text) == []
    assert re.findall(r"\b(?:TO" "DO|FIX" r"ME|X{3})\b", text) == []
