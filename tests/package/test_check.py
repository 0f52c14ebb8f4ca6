"""`contact-fmus check` finds what is broken in an FMU of any maker, by FMI 2.0 and 3.0, and survives it"""

import json
import os
import re
import sys
from pathlib import Path

import pytest

from support.foreign import BROKEN, PLATFORM, XML, foreign_fmu, library, packed
from support.programs import PATIENCE, finished
from support.sources import ROOT

VERSIONS = (2, 3)
NOT_LONG = 1.0  # s, where a hang is to be found


def checked(ask, *arguments):
    status, told, out = ask("check", *arguments, "--json")
    assert told == "", told
    return status, {one["name"]: one for one in json.loads(out)["checks"]}


@pytest.mark.parametrize("version", VERSIONS)
def test_a_sound_fmu_of_another_maker_passes_every_check(ask, tmp_path, version):
    status, checks = checked(ask, foreign_fmu(tmp_path, version))
    assert {name: one["findings"] for name, one in checks.items() if one["outcome"] != "passed"} == {}
    assert status == 0 and {"exports", "run", "state"} <= set(checks)


@pytest.mark.parametrize("name", ["BouncingBall", "fmi3/BouncingBall", "ForceElement", "fmi3/ForceElement"])
def test_a_shipped_fmu_passes_by_both_kinds_of_simulation(ask, name):
    status, checks = checked(ask, name)
    assert {name: one["findings"] for name, one in checks.items() if one["outcome"] != "passed"} == {}
    assert status == 0 and {"exports", "run", "exchange", "state"} <= set(checks)


def test_a_validator_s_complaints_are_told_without_its_other_words(ask, tmp_path, monkeypatch):
    program = tmp_path / "fmuCheck"
    program.write_text("#!/bin/sh\necho '[INFO] a run'; echo '[ERROR] a fault'; echo 0.0,1.0\n")
    program.chmod(0o755)
    monkeypatch.setenv("FMUCHECK", str(program))
    status, checks = checked(ask, "ForceElement")
    assert (status, checks["fmuCheck"]["findings"]) == (1, ["[ERROR] a fault"])


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("fault", BROKEN)
def test_a_broken_fmu_is_found_out(ask, tmp_path, fault, version):
    make, check, words = BROKEN[fault]
    hangs = "hang" in fault
    status, checks = checked(ask, make(tmp_path, version), "--patience", NOT_LONG if hangs else PATIENCE)
    found = " ".join(checks[check]["findings"])
    assert status == 1 and checks[check]["outcome"] == "found", checks
    assert words in found and len(found) < 400 and "Traceback" not in found, found


def elsewhere(folder, version):
    """An FMU for Windows only"""
    places = {2: "win64", 3: "x86_64-windows"}
    return packed(
        folder,
        {"modelDescription.xml": XML[version], f"binaries/{places[version]}/Other.dll": b"MZ" + bytes(100)},
    )


@pytest.mark.parametrize("version", VERSIONS)
def test_a_check_that_cannot_be_done_fails_unless_it_may_be_missing(ask, tmp_path, version):
    file = elsewhere(tmp_path, version)
    status, checks = checked(ask, file)
    undone = {name for name, one in checks.items() if one["outcome"] == "not done"}
    assert (status, undone) == (1, {"exports", "run", "state"})
    assert f"no binary for {PLATFORM[version]}" in checks["run"]["findings"][0]
    assert checked(ask, file, "--allow-missing", "exports", "run")[0] == 1
    assert checked(ask, file, "--allow-missing", "exports", "run", "--allow-missing", "state")[0] == 0
    assert checked(ask, file, "--allow-missing", "all")[0] == 0


def test_a_check_that_is_not_known_is_named(ask, tmp_path):
    status, told, _ = ask("check", foreign_fmu(tmp_path), "--allow-missing", "runs")
    assert status == 2 and "there is no check 'runs' (did you mean 'run'?)" in told


def test_a_scene_that_cannot_run_is_told_in_the_sentence_of_initialization(ask, tmp_path):
    """What the command tells where it runs the same FMU, and no number of a status"""
    status, checks = checked(ask, BROKEN["a refused start"][0](tmp_path, 2))
    assert status == 1 and checks["run"]["findings"] == ["the axis of an infinite body has no inertia"]


def test_several_fmus_are_a_line_of_json_each_and_a_file_holds_them_all(ask, tmp_path):
    file = foreign_fmu(tmp_path)
    status, _, out = ask("check", file, "BouncingBall", "--json", "--output", "report.json")
    lines = [json.loads(line) for line in out.splitlines()]
    assert status == 0 and [one["fmu"] for one in lines] == [str(file), "BouncingBall"]
    assert json.loads((tmp_path / "report.json").read_text()) == lines


# --- the action of GitHub ------------------------------------------------------------------------------


def action(folder, **inputs):
    """The action's steps as GitHub's runner runs them: status, stdout, its outputs, the summary"""
    from yaml import safe_load

    described = safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
    assert set(inputs) <= set(described["inputs"])
    given = {name: one.get("default", "") for name, one in described["inputs"].items()} | inputs
    files = {name: folder / name for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
    (folder / "bin").mkdir()
    python = folder / "bin" / "python"
    python.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    python.chmod(0o755)
    environment = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
    environment |= {"GITHUB_ACTION_PATH": str(ROOT), "RUNNER_TEMP": str(folder)}
    environment |= {name: str(file) for name, file in files.items()}
    said, status = "", 0
    for step in described["runs"]["steps"]:
        if "run" not in step or step.get("id") == "install":  # what an environment of the tests has already
            continue
        values = {
            name: given[text.removeprefix("${{ inputs.").removesuffix(" }}")]
            for name, text in step.get("env", {}).items()
        }
        assert "${{" not in step["run"], "inputs reach a script by its environment only"
        done = finished(["bash", "-eo", "pipefail", "-c", step["run"]], env=environment | values, cwd=folder)
        said, status = said + done.stdout + done.stderr, status or done.returncode
    texts = {name: file.read_text() if file.exists() else "" for name, file in files.items()}
    outputs = dict(line.split("=", 1) for line in texts["GITHUB_OUTPUT"].splitlines())
    return status, said, outputs, texts["GITHUB_STEP_SUMMARY"]


def test_the_action_passes_sound_fmus_and_tells_where_its_report_is(tmp_path):
    (tmp_path / "fmus").mkdir()
    foreign_fmu(tmp_path / "fmus")
    status, said, outputs, summary = action(tmp_path, fmus="fmus/*.fmu")
    assert status == 0, said
    assert "::error" not in said and outputs["passed"] == "true"
    (report,) = json.loads(Path(outputs["json"]).read_text())
    assert report["fmu"] == "fmus/Other.fmu"
    assert "| fmus/Other.fmu | run | passed |  |" in summary


def test_the_action_fails_on_a_broken_fmu_and_annotates_it(tmp_path):
    BROKEN["a number that is none"][0](tmp_path, 3)
    status, said, outputs, summary = action(tmp_path, fmus="Other.fmu")
    assert status == 1 and outputs["passed"] == "false", said
    assert "::error file=Other.fmu,title=run::m[1,2] is not finite at 0.0 s" in said
    assert "| Other.fmu | run | found | m[1,2] is not finite at 0.0 s |" in summary


@pytest.mark.parametrize("strictness, status, level", [("strict", 1, "error"), ("lenient", 0, "warning")])
def test_the_action_s_strictness_decides_about_what_could_not_be_checked(tmp_path, strictness, status, level):
    elsewhere(tmp_path, 2)
    done, said, _, _ = action(tmp_path, fmus="Other.fmu", strictness=strictness)
    assert done == status and f"::{level} file=Other.fmu,title=run::the FMU has no binary" in said, said


def test_the_action_without_an_fmu_says_so(tmp_path):
    status, said, _, _ = action(tmp_path, fmus="nothing/*.fmu")
    assert status != 0 and "no FMU is named by 'nothing/*.fmu'" in said


def test_the_install_step_names_what_the_package_needs(tmp_path):
    import tomllib

    needs = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    text = (ROOT / "action.yml").read_text(encoding="utf-8")
    for one in ("fmpy", "jinja2", "lxml", "numpy", "platformdirs", "rich"):
        assert any(need.startswith(one) for need in needs)
        (pin,) = re.findall(rf"{one}==\S+", text)
        assert pin in (ROOT / "requirements.txt").read_text(encoding="utf-8").splitlines()


def test_the_library_of_a_foreign_fmu_is_of_the_version_asked_for(tmp_path):
    assert b"fmi3DoStep" in library(tmp_path, 3) and b"fmi2DoStep" in library(tmp_path, 2)
