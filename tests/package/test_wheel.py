"""The wheel far from any clone: what it carries, and a scene from `new` to `run`"""

import importlib
import json
import re
import subprocess
import sys
import tomllib
import zipfile
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from contact_fmus import Result
from contact_fmus.fmu.contact_fmu import ContactFmu
from support.programs import finished
from support.sources import BUILD, ROOT

SHIPPED = sorted(path.stem for path in (ROOT / "modelDescription" / "scenes").glob("*.toml"))


def test_the_wheel_carries_what_building_and_running_need(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        fmu = archive.read("contact_fmus/share/build/fmus/SphereSphere.fmu")
    assert fmu == (BUILD / "fmus" / "SphereSphere.fmu").read_bytes()
    sources = [path.relative_to(ROOT) for path in (ROOT / "fmu_src").rglob("*.[ch]")]
    wanted = [*sources, "CMakeLists.txt", "LICENSE", "modelDescription/variables.toml", "cmake/pack_fmu.py"]
    wanted += [f"build/fmus/{name}.fmu" for name in SHIPPED]
    wanted += [
        "docs/sweep.md", "sundials/lib/libsundials_cvode.a", "sundials/include/cvode/cvode.h",
        "sundials/sundials.txt",
    ]  # fmt: skip
    assert [name for name in wanted if f"contact_fmus/share/{name}" not in names] == []
    assert [name for name in names if "__pycache__" in name or "/tests/" in name] == []


def test_every_command_is_one_of_the_wheel_and_every_dependency_is_pinned_for_tests():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    pins = (ROOT / "requirements.txt").read_text().lower()
    wanted = [*project["project"]["dependencies"], *project["project"]["optional-dependencies"]["dev"]]
    assert [one for one in wanted if f"\n{one.partition('>')[0]}==" not in pins] == []
    assert [one for one in project["build-system"]["requires"] if f"\n{one}\n" not in pins] == []


def test_an_editable_package_is_built_without_npm(tmp_path, monkeypatch):
    """As the demo's is: the clone can be given three.js later."""
    fake = SimpleNamespace(build=SimpleNamespace(build_editable=lambda wheel, *_: wheel))
    monkeypatch.setitem(sys.modules, "scikit_build_core", fake)
    monkeypatch.syspath_prepend(ROOT / "scripts")
    backend = importlib.import_module("build_backend")
    monkeypatch.setattr(backend, "BUNDLE", tmp_path / "three.bundle.js")
    monkeypatch.setattr(backend, "_node", lambda: None)
    monkeypatch.setenv("PATH", "")
    assert backend.build_editable(tmp_path) == tmp_path and not backend.BUNDLE.exists()
    with pytest.raises(SystemExit, match="needs npm"):
        backend.build_wheel(tmp_path)


def test_the_demo_asks_for_cvode_without_what_libsundials_depends_on():
    text = (ROOT / "scripts" / "setup.sh").read_text()
    demo, tests = text.partition("[[ $purpose == demo ]] || packages")[::2]
    assert "libsundials-dev" not in demo and "\n    libsundials-dev " in tests
    assert "${PROJECT_BINARY_DIR}/debian-sundials" in (ROOT / "cmake/ContactSundials.cmake").read_text()


def test_the_package_is_imported_by_its_names_and_quickly(installed, far_from_clone, tmp_path):
    text = (
        "import sys, contact_fmus; assert 'fmpy' not in sys.modules\n"
        "from contact_fmus import ContactFmu, fmu_file\n"
        "with ContactFmu(fmu_file('SphereSphere')) as fmu:\n"
        "    fmu.start(); fmu.step(0.5)\n"
        "    print(fmu_file('SphereSphere'), repr(float(fmu['source.position'][2])))"
    )
    run = finished([installed / "python", "-c", text], cwd=tmp_path, check=True, env=far_from_clone)
    file, position = run.stdout.split()
    assert str(ROOT) not in file and str(installed.parent) in file
    with ContactFmu(BUILD / "fmus" / "SphereSphere.fmu") as fmu:
        fmu.start()
        fmu.step(0.5)
        assert float(position) == fmu["source.position"][2]


def test_version_and_help(command):
    told = command("--version")
    assert (told.returncode, told.stdout) == (0, "contact-fmus 0.1.0\n")
    assert "  build " in command("--help").stdout


def test_a_shipped_fmu_runs_by_name_and_its_file_says_what_was_computed(command, tmp_path):
    options = "--set contact.dashpot=unclamped --stop 1 --csv out.csv"
    run = command("run", "SphereSphere", *options.split())
    assert (run.returncode, run.stderr) == (0, "")
    result = Result.read(tmp_path / "out.csv")
    assert result.time[[0, -1]].tolist() == [0.0, 1.0]
    # A row for each communication point, and one on either side of each onset and release
    assert len(result.time) == 1001 + 2 * np.count_nonzero(np.diff(result.columns["contact.active"]))
    assert result.units["contact.gap"] == "m" and result.parameters["contact.dashpot"] == "unclamped"
    # Before it falls half a metre the ball is in free fall from 1.1 m.
    falling = result.time < 0.31
    expected = 1.1 - 0.5 * 9.81 * result.time[falling] ** 2
    assert np.max(np.abs(result.vector("source.position")[falling, 2] - expected)) < 1e-12
    assert result.columns["contact.onsets"][-1] >= 1


def test_a_new_scene_is_built_checked_and_run(command, tmp_path):
    assert command("new", "Bouncing", "--shape", "cylinder").returncode == 0
    built = command("build", "Bouncing.toml", "--json", XDG_CACHE_HOME=str(tmp_path / "cache"))
    assert built.returncode == 0, built.stderr
    assert json.loads(built.stdout)["fmu"] == "Bouncing.fmu"
    checked = command("check", "Bouncing.fmu", "--json")
    assert checked.returncode == 0, checked.stdout
    passed = [one["name"] for one in json.loads(checked.stdout)["checks"] if one["outcome"] == "passed"]
    assert passed[:5] == ["archive", "description", "binaries", "exports", "run"]
    values = json.loads(command("run", "Bouncing.fmu", "--json").stdout)["values"]
    # From 0.4 m above the cylinder: energy stays within what the dashpot takes, and it has bounced.
    assert values["contact.onsets"] >= 2 and values["ball.position[3]"] > 0.59


@pytest.mark.parametrize("inside", [[], ["--inside"]])
def test_every_new_scene_would_bounce(shape, inside, command, tmp_path):
    """As its values on the universal FMU do; only one is built above"""
    assert (
        command("new", "Any", "--shape", shape, *inside, "--pinned", "contact.dashpot=unclamped").returncode
        == 0
    )
    scene = tomllib.loads((tmp_path / "Any.toml").read_text())
    assert scene["pinned"]["contact.dashpot"] == "unclamped"
    pair = {scene["contact"][0][end]: end for end in ("source", "destination")}
    values = {
        f"{pair.get(body, body)}.{name}": value
        for (body, _, name), value in (
            (key.partition("."), value) for key, value in (scene["start"] | scene["pinned"]).items()
        )
    }
    with ContactFmu(BUILD / "fmus" / f"Sphere{shape.capitalize()}.fmu") as fmu:
        fmu.start(values)
        fmu.step(scene["experiment"]["stop_time"])
        assert fmu["contact.onsets"] >= 2


def test_a_scenario_needs_no_claim(command, tmp_path):
    text = 'title = "fall"\nfmu = "SphereSphere"\nexperiment = { stop_time = 0.5, steps = 50 }\n'
    (tmp_path / "fall.toml").write_text(text)
    run = command("run", "fall.toml", "--json", "--set", "source.center=0,0,9")
    assert run.returncode == 0 and json.loads(run.stdout)["time"] == 0.5
    fallen = json.loads(run.stdout)["values"]["source.position[3]"]
    assert abs(fallen - (9.0 - 0.5 * 9.81 * 0.25)) < 1e-9


def test_the_wheel_carries_the_fmus_of_fmi_3_and_what_bench_runs(installed, command):
    two, three = (
        json.loads(command("run", name, "--stop", "1", "--json").stdout)["values"]
        for name in ("SphereSphere", "fmi3/SphereSphere")
    )
    assert two == three
    text = "from contact_fmus.fmu.host import host_file; print(host_file().is_file())"
    assert finished([installed / "python", "-c", text], check=True).stdout == "True\n"


def test_a_reader_that_goes_away_is_no_fault(installed, far_from_clone):
    arguments = [installed / "contact-fmus", "run", "SphereSphere", "--csv", "/dev/stdout"]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(arguments, env=far_from_clone, **streams) as run:
        run.stdout.readline()
        run.stdout.close()
        assert run.stderr.read() == b""
    assert run.returncode == 141


def test_without_fmus_the_message_says_what_to_do(command, tmp_path):
    run = command("run", "SphereSphere", CONTACT_FMUS=str(tmp_path))
    assert run.returncode == 2 and "none is built" in run.stderr


# recipe/recipe.yaml says of the conda package what pyproject.toml and the build say

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
TEXT = (ROOT / "recipe" / "recipe.yaml").read_text()
RECIPE = yaml.safe_load(TEXT)


def names(requirements):
    return {re.match(r"[\w-]+", one)[0] for one in requirements}


def test_the_recipe_has_the_version_and_the_sundials_of_the_build():
    version = re.search(r"contact_fmus VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert RECIPE["context"]["version"] == version
    commit = re.search(
        r"contact_sundials_commit (\w+)\) # v([0-9.]+)", (ROOT / "cmake/ContactSundials.cmake").read_text()
    )
    assert (RECIPE["source"][1]["rev"], RECIPE["context"]["sundials"]) == commit.groups()


def test_the_recipe_wants_what_the_package_wants():
    python = f"python {PROJECT['project']['requires-python']}"
    wanted = {python, *(one.replace(">=", " >=") for one in PROJECT["project"]["dependencies"])}
    assert set(RECIPE["requirements"]["run"]) == wanted
    building = {one for part in ("build", "host") for one in RECIPE["requirements"][part]}
    assert names(PROJECT["build-system"]["requires"]) <= names(one for one in building if "$" not in one)
    assert RECIPE["about"]["license"] == PROJECT["project"]["license"]
    assert all((ROOT / file).is_file() for file in RECIPE["about"]["license_file"])
