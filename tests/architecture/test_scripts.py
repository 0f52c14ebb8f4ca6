"""scripts/contact_fmus flows one way, and the shell scripts are alike."""

import ast
import re

import pytest

from contact_fmus.__main__ import COMMANDS, main
from support.graph import circle
from support.programs import finished
from support.sources import ROOT, label

PACKAGE = ROOT / "scripts" / "contact_fmus"
MODULES = sorted(PACKAGE.rglob("*.py"))
# A package, or a module that stands alone, imports those before it.
PACKAGES = ("errors", "options", "fmu", "results", "pages", "scenarios", "plot", "animate", "sweep")
PACKAGES += ("building", "bench", "report", "peers", "coupling", "stability", "running", "checking")
PACKAGES += ("importers", "published", "whole_report")
SCRIPTS = sorted(file for file in (ROOT / "scripts").glob("*.sh") if file.stem != "prologue")


def name_of(file):
    parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {name_of(file) for file in MODULES}


def imports(name, text, package):
    """The modules of contact_fmus that the text imports, those for type checking too"""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            folders = (name if package else name.rpartition(".")[0]).split(".")
            base = ".".join(folders[: len(folders) - node.level + 1]) if node.level else ""
            origin = ".".join(part for part in (base, node.module) if part)
            modules = {f"{origin}.{alias.name}" for alias in node.names}
            found |= {one if one in NAMES else origin for one in modules}
    return found & NAMES


def graph():
    return {name_of(f): imports(name_of(f), f.read_text(), f.stem == "__init__") for f in MODULES}


def upward(edges):
    """Imports of a package by one that stands before it"""
    place = {name: index for index, name in enumerate(PACKAGES)}
    parts = [(a.split("."), b.split(".")) for a, targets in edges.items() for b in targets]
    return [
        f"{'.'.join(a)} imports {'.'.join(b)}"
        for a, b in parts
        if len(a) > 2 and len(b) > 1 and place[b[1]] > place[a[1]]
    ]


def test_the_packages_are_the_folders():
    alone = [file.stem for file in PACKAGE.glob("[!_]*.py")]
    assert sorted(PACKAGES) == sorted([*alone, *(file.parent.name for file in PACKAGE.glob("*/__init__.py"))])


def test_imports_have_no_circle_and_never_point_back():
    edges = graph()
    assert sum(map(len, edges.values())) > 100
    assert circle(edges) is None
    assert upward(edges) == []


@pytest.mark.parametrize(
    "text", ["from contact_fmus.{} import x", "if TYPE_CHECKING:\n    from contact_fmus.{} import x"]
)
def test_a_circle_or_an_import_that_points_back_is_found(text):
    edges = graph()
    back = imports("contact_fmus.fmu.files", text.format("fmu.contact_fmu"), package=False)
    assert circle({**edges, "contact_fmus.fmu.files": edges["contact_fmus.fmu.files"] | back})
    back = imports("contact_fmus.fmu.files", text.format("report.measure"), package=False)
    (found,) = upward({"contact_fmus.fmu.files": back})
    assert found == "contact_fmus.fmu.files imports contact_fmus.report.measure"


@pytest.mark.parametrize("file", sorted((ROOT / "tests").rglob("*.py")), ids=label)
def test_no_test_takes_times_and_only_what_hangs_is_ended(file):
    """`time.monotonic` is for waiting. What is to take too long in a test takes no more than a second."""
    text = file.read_text(encoding="utf-8")
    waits = re.findall(r"\b(?:timeout|patience)=([0-9.]+)", text)
    assert all(float(wait) <= 1.0 for wait in waits), "support.programs.PATIENCE is long enough"
    assert not re.search(r"time\.(?:perf_counter|process_time|time)\(", text)


def run(script, *arguments):
    return finished([script, *arguments])


def options_of(script):
    """What its own `case $1 in ... esac` takes; other scripts take what their help names (prologue.sh)"""
    text = script.read_text()
    if "case $1 in" not in text:
        return set(re.findall(r"^# +(--[a-z-]+)(?: [A-Z]+)*  ", text, re.MULTILINE))
    cases = re.findall(r"case \$1 in\n(.*?)\n *esac", text, re.DOTALL)
    patterns = re.findall(r"^ *(-[^)]*)\)", "\n".join(cases), re.MULTILINE)
    return {one for text in patterns for one in re.findall(r"(?<![\w-])-{1,2}[a-z][a-z-]*", text)}


def test_the_options_of_a_script_are_found():
    assert options_of(ROOT / "scripts" / "report.sh") == {"--peers", "--quick", "--output"}
    assert "--minutes" in options_of(ROOT / "scripts" / "fuzz.sh")


@pytest.mark.parametrize("option", ["-h", "--help"])
@pytest.mark.parametrize("script", SCRIPTS, ids=label)
def test_a_script_tells_what_it_does_and_each_of_its_options(script, option):
    told = run(script, option)
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith(f"scripts/{script.name}")
    described = set(re.findall(r"^ +(.*)$", told.stdout, re.M))
    missing = [
        one
        for one in [*options_of(script), "-h", "--help"]
        if not any(re.search(rf"(^|[ ,]){one}\b.*\w{{3}}", line) for line in described)
    ]
    assert missing == []


@pytest.mark.parametrize("script", SCRIPTS, ids=label)
def test_a_script_refuses_what_it_does_not_know(script):
    refused = run(script, "--no-such-option")
    assert refused.returncode == 2
    assert refused.stderr.startswith(f"{script.stem}: ")
    assert "--no-such-option" in refused.stderr


@pytest.mark.parametrize("script", SCRIPTS, ids=label)
def test_a_script_refuses_an_option_without_each_of_its_values(script):
    taking = re.findall(r"^# +(--[a-z-]+)((?: [A-Z]+)+)", script.read_text(), re.MULTILINE)
    for option, given in [(one, k) for one, values in taking for k in range(len(values.split()))]:
        refused = run(script, option, *["1"] * given)
        assert (refused.returncode, refused.stderr[: len(script.stem) + 2]) == (2, f"{script.stem}: ")
        assert option in refused.stderr


@pytest.mark.parametrize("name", ["report", "stability", "bench"])
def test_a_script_takes_the_options_of_its_command(name, capsys):
    with pytest.raises(SystemExit):
        main([name, "--help"])
    told = capsys.readouterr().out
    assert [one for one in options_of(ROOT / "scripts" / f"{name}.sh") if one not in told] == []


@pytest.mark.parametrize("script", SCRIPTS, ids=label)
def test_set_up_and_build_stand_in_the_prologue_alone(script):
    text = script.read_text()
    assert 'source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"\n' in text
    assert re.findall(r"^\s*(?:set -|root=|cmake --preset default -W|export PYTHONPATH)", text, re.M) == []


def test_the_package_lists_its_commands_and_refuses_others(capsys):
    assert main(["--help"]) == 0
    told = capsys.readouterr().out
    assert [name for name in COMMANDS if f"  {name} " not in told] == []
    assert (main(["nonsense"]), main([])) == (2, 2)
    assert "unknown command 'nonsense'" in capsys.readouterr().err
