"""FMI 3.0 FMUs are run, drawn, played and swept as those of FMI 2.0 are, and warnings are told"""

import csv
import json
import sys
from pathlib import Path

import fmpy
import numpy as np
import pandas
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.fmu.files import fmu_file, fmus_folder
from contact_fmus.importers.command import AGREE, IMPORTERS, Given, installed, tried
from contact_fmus.results import Result, notes_file
from support.programs import checked, environment
from support.sources import ROOT
from support.sweeps import read, run_here, write_study

BOTH = ("BouncingBall", "fmi3/BouncingBall")
OVERLAP = ("--set", "source.center=0,0,-1", "--stop", "0.1")  # the bodies begin deep in each other


def values(ask, *arguments):
    status, told, out = ask("run", *arguments, "--json")
    assert (status, told) == (0, ""), told
    return json.loads(out)["values"]


@pytest.mark.parametrize("name", ["BouncingBall", "SphereSphere", "BallInShell", "SphereCylinder"])
def test_a_run_by_fmi_3_has_the_bits_of_one_by_fmi_2(ask, name):
    options = ("--stop", "1", "--step", "0.01", "--set", "source.initial_velocity[1]=0.25")
    assert values(ask, f"fmi3/{name}", *options) == values(ask, name, *options)


def test_a_scene_with_given_motions_runs_by_both(ask):
    options = ("--set", "source.prescribed_displacement=0,0,-0.25", "--stop", "0.1")
    assert values(ask, "fmi3/ForceElement", *options) == values(ask, "ForceElement", *options)


@pytest.mark.parametrize("name", BOTH)
def test_model_exchange_comes_to_the_same_place(ask, name):
    options = ("--set", "source.center=0,0,1", "--stop", "1")
    here, there = values(ask, name, *options), values(ask, name, "--model-exchange", *options)
    assert there["contact.onsets"] == here["contact.onsets"] == 1
    assert there["source.position[3]"] == pytest.approx(here["source.position[3]"], abs=1e-6)
    _, told, _ = ask("run", name, "--model-exchange", "--set", "source.mass=-1")
    assert "source.mass = -1 refused" in told


def test_model_exchange_by_fmi_3_takes_a_part_of_an_array_and_items_by_name(ask, tmp_path):
    settings = ("--set", "source.center[3]=1.05", "--set", "contact.dashpot=unclamped", "--stop", "0.5")
    found = [
        values(ask, name, "--model-exchange", *settings, "--csv", "run.csv")
        for name in ("SphereSphere", "fmi3/SphereSphere")
    ]
    for name, value in found[0].items():
        assert found[1][name] == (pytest.approx(value, abs=1e-6) if isinstance(value, float) else value), name
    result = Result.read(tmp_path / "run.csv")
    assert result.parameters["source.center[3]"] == 1.05
    assert result.parameters["contact.dashpot"] == "unclamped"


@pytest.mark.parametrize("name", BOTH)
@pytest.mark.parametrize("command", ["plot", "animate"])
def test_pictures_and_animations_are_made_of_both(ask, command, name, tmp_path):
    status, told, out = ask(command, name, "--stop", "0.6", "-o", "page.html")
    assert (status, told, out) == (0, "", "page.html\n")
    assert (tmp_path / "page.html").stat().st_size > 10_000


def test_a_sweep_of_an_fmi_3_fmu_has_the_bits_of_one_of_fmi_2(tmp_path):
    found = [
        run_here(read(write_study(tmp_path, fmu=f'"{name}"')))[1]
        for name in ("SphereSphere", "fmi3/SphereSphere")
    ]
    assert found[0].values.tobytes() == found[1].values.tobytes()
    assert found[0].status.tolist() == found[1].status.tolist()


# --- warnings ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("how", [(), ("--model-exchange",)])
@pytest.mark.parametrize("name", BOTH)
def test_what_the_fmu_warns_of_is_told_once(ask, name, how):
    status, told, out = ask("run", name, *OVERLAP, *how)
    assert status == 0 and "energy.total" in out
    assert told.count("\n") == 1 and told.startswith("warning: BouncingBall at 0 s: contact.gap = -1.1 m")


@pytest.mark.parametrize("command", ["plot", "animate"])
def test_what_the_fmu_warns_of_is_told_beside_a_picture(ask, command):
    status, told, _ = ask(command, "BouncingBall", *OVERLAP, "-o", "page.html")
    assert status == 0 and told.count("\n") == 1 and "contact.gap = -1.1 m" in told, told


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("name", BOTH)
def test_a_sweep_counts_warnings_run_by_run(tmp_path, name, compiled):
    vary = {"source.center[3]": "[0.5, -1.0, 0.3, -2.0]"}
    text = {"fmu": f'"{name}"', "vary": vary, "outputs": {"height": '"source.position[3]"'}, "count": 0}
    file = write_study(tmp_path, **text)
    file.write_text(file.read_text().replace('"contact.method" = "penalty_dynamic"\n', ""))
    _, rows = run_here(read(file), compiled=compiled)
    assert rows.warnings.tolist() == [0, 1, 0, 1]
    assert rows.status.tolist() == [0] * 4 and rows.messages == {}


# --- one FMU from Python -------------------------------------------------------------------------------


def test_an_fmi_3_fmu_is_driven_by_names_as_one_of_fmi_2():
    told = []
    for name in ("SphereSphere", "fmi3/SphereSphere"):
        with ContactFmu(fmu_file(name)) as fmu:
            fmu.start({"source.center": [0.03, 0.04, 1.1], "source.initial_velocity[1]": 0.5}, tolerance=1e-9)
            fmu.step(0.5)
            state, here = fmu.save(), fmu["source.position"].tolist()
            with pytest.raises(FmuError, match=r"fixed after initialization"):
                fmu["source.mass"] = 2.0
            fmu.step(0.1)
            fmu.restore(bytes(state))
            assert fmu.time == 0.5 and fmu["source.position"].tolist() == here
            rates = [
                fmu.derivative("source.position").tolist(),
                fmu.derivative("source.position", 2).tolist(),
            ]
            told.append([here, fmu["contact.active"], fmu["contact.dashpot"], fmu["contact.onsets"], rates])
    assert told[0] == told[1]


def test_its_jacobian_is_the_same():
    found = []
    for name in ("ForceElement", "fmi3/ForceElement"):
        with ContactFmu(fmu_file(name)) as fmu:
            fmu.start({"source.prescribed_displacement": [0.0, 0.01, -0.25]})
            fmu.step(0.01)
            found.append(fmu.jacobian("contact.source_force", "source.prescribed_displacement"))
    assert np.any(found[0]) and np.array_equal(*found)


def test_fmi_3_says_once_that_it_knows_no_derivatives_of_inputs():
    with ContactFmu(fmu_file("fmi3/ForceElement")) as fmu:
        fmu.start()
        for _ in range(3):
            fmu.set_derivative("source.prescribed_displacement", [0.0, 0.0, -1.0])
            fmu.step(0.01)
        held = "source.prescribed_displacement: FMI 3.0 has no derivatives of inputs"
        assert [text.startswith(held) for text in fmu.warnings()] == [True]


# --- the table a run leaves ----------------------------------------------------------------------------


def test_a_csv_file_begins_with_its_names_and_its_notes_stand_beside_it(ask, tmp_path):
    assert ask("run", "BouncingBall", *OVERLAP, "--csv", "run.csv")[0] == 0
    table = pandas.read_csv(tmp_path / "run.csv")
    assert table.columns[0] == "time" and table["time"].iloc[-1] == 0.1
    with open(tmp_path / "run.csv", encoding="utf-8") as file:
        assert next(csv.reader(file))[:2] == ["time", "source.external_force[1]"]
    notes = json.loads(notes_file(tmp_path / "run.csv").read_text())
    assert notes["units"]["contact.gap"] == "m" and notes["parameters"]["source.center[3]"] == -1.0
    assert len(notes["warnings"]) == 1 and notes["fmu"].endswith("BouncingBall.fmu")
    again = Result.read(tmp_path / "run.csv")
    assert again.units["time"] == "s"
    assert (again.parameters, again.warnings) == (notes["parameters"], notes["warnings"])


def test_a_table_alone_is_a_result_too_and_broken_notes_are_named(ask, tmp_path):
    (tmp_path / "a.csv").write_text("time,x\n0,1\n1,2\n")
    assert Result.read(tmp_path / "a.csv").columns["x"].tolist() == [1.0, 2.0]
    (tmp_path / "a.csv.json").write_text("no JSON")
    status, told, _ = ask("plot", "a.csv", "--variables", "x")
    assert status == 2 and "a.csv.json: this is no JSON text" in told


# The files of FMI's cross check, for three FMUs by one command, in both versions

NAMES = ("BouncingBall", "BallInShell", "ForceElement")


@pytest.mark.parametrize("before, version", [("", "2.0"), ("fmi3/", "3.0")])
def test_one_command_writes_what_the_cross_check_asks_of_three_fmus(ask, tmp_path, before, version):
    status, told, out = ask("compatibility", *(before + name for name in NAMES), "-o", "all")
    assert (status, told) == (0, ""), told
    assert out.splitlines() == [f"all/{version}/{name}" for name in NAMES]
    for name in NAMES:
        folder = tmp_path / "all" / version / name
        ends = (".fmu", "_cc.csv", "_in.csv", "_ref.csv", "_ref.opt")
        assert {file.name for file in folder.iterdir()} == {"ReadMe.txt", *(name + end for end in ends)}
        pairs = (line.split(",") for line in (folder / f"{name}_ref.opt").read_text().splitlines())
        options = {key: float(value) for key, value in pairs}
        own, other = (pandas.read_csv(folder / f"{name}_{kind}.csv") for kind in ("ref", "cc"))
        assert (folder / f"{name}_ref.csv").read_text().startswith('"time","')
        assert list(own.columns) == list(other.columns)
        assert other["time"].iloc[-1] == own["time"].iloc[-1] == options["StopTime"]
        # fmpy adds its clock up, so that its steps end rounding beside those of the project's run.
        last = [table["contact.gap"].iloc[-1] for table in (own, other)]
        assert last[0] == pytest.approx(last[1], abs=1e-9)
        assert np.all(np.diff(pandas.read_csv(folder / f"{name}_in.csv")["time"]) >= 0.0)
        assert f"FMI {version}, Co-Simulation" in (folder / "ReadMe.txt").read_text()


def test_the_fmu_itself_is_beside_them(ask, tmp_path):
    status, told, _ = ask("compatibility", "BouncingBall", "-o", "one")
    assert (status, told) == (0, "")
    copy = tmp_path / "one" / "2.0" / "BouncingBall" / "BouncingBall.fmu"
    assert fmpy.read_model_description(str(copy)).modelName == "BouncingBall"


# `--choices integer`, a choice set to another item: importers compute what fmpy does with enumerations.

SCENE = "BallOnSphere"
CHOICE = {"contact.method": 1}  # penalty; the scene starts with 2, penalty_dynamic
PYTHON = Path(sys.executable)
ALWAYS = {"fmpy", "libcosim"}  # are in requirements.txt; others of Python are tried where they are installed


@pytest.fixture(scope="module")
def with_integers(tmp_path_factory, quick_compiler):
    folder = tmp_path_factory.mktemp("integer")
    scene = ROOT / "modelDescription" / "scenes" / f"{SCENE}.toml"
    command = [sys.executable, "-m", "contact_fmus", "build", str(scene), "--choices", "integer"]
    checked([*command, "-o", folder], environment=environment(CC=quick_compiler))
    return folder / f"{SCENE}.fmu"


def asked(settings):
    # The ball has met the sphere, and the laws have parted.
    return Given(1e-3, 1000, PYTHON, {}, settings)


def test_a_choice_set_as_an_integer_computes_what_the_enumeration_does(with_integers):
    fmpy = IMPORTERS[0]
    enumeration = fmus_folder() / f"{SCENE}.fmu"
    reference = tried(fmpy, enumeration, asked(CHOICE))
    assert reference.problem == ""
    assert tried(fmpy, enumeration, asked({})).difference(reference) > 1e-3, "the choice changes nothing"
    present = [importer for importer in IMPORTERS if installed(importer, PYTHON, {})]
    assert {importer.name for importer in present} >= ALWAYS
    for importer in present:
        found = tried(importer, with_integers, asked(CHOICE))
        assert (importer.name, found.problem) == (importer.name, "")
        assert found.difference(reference) <= AGREE, importer.name
