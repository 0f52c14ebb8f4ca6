"""Every example runs as its folder's README says, and what it prints is right"""

import ast
import importlib.util
import math
import os
import re
import sys

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file, fmus_folder
from support.checks import check_close
from support.programs import PATIENCE, checked, environment, finished, python
from support.reference.turning import follow
from support.sources import ROOT

EXAMPLES = ROOT / "examples"


def said(script, *arguments, folder):
    """What a script prints; run in a folder of its own, without the project's modules"""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, str(EXAMPLES / script), *map(str, arguments)]
    done = finished(command, cwd=folder, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_the_fmpy_script_finds_the_impacts(tmp_path):
    text = said("fmpy_script.py", fmu_file("BallOnSphere"), folder=tmp_path)
    times = [float(line.split()[0]) for line in text.splitlines()[1:-1]]
    with ContactFmu(fmu_file("BallOnSphere")) as fmu:
        values = {"contact.dashpot": "unclamped", "contact.viscous_penalty_factor": 200.0}
        fmu.start({"source.center": [0.03, 0.04, 1.1], **values}, tolerance=1e-10)
        fmu.step(1.5)
        assert fmu["contact.onsets"] == len(times) == 2
        check_close("second onset", times[1], fmu["contact.last_onset_time"], 1e-6)
        check_close("height", float(re.search(r"(\S+) m$", text)[1]), fmu["source.position"][2], 1e-5)
    # Head-on it would fall until 0.6 m; here it meets the sphere a little later, on its shoulder.
    assert (2 * 0.5 / 9.81) ** 0.5 < times[0] < 1.01 * (2 * 0.502 / 9.81) ** 0.5


def test_the_integrator_around_the_force_element_keeps_the_energy(tmp_path):
    text = said("multibody_integrator.py", fmu_file("ForceElement"), folder=tmp_path)
    assert "2 impacts" in text
    assert float(re.search(r"strays by (\S+) J", text)[1]) < 1e-6


@pytest.fixture
def example():
    """The module of an example, by its name"""
    loaded = []

    def load(name):
        spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module  # dataclasses look it up
        loaded.append(name)
        spec.loader.exec_module(module)
        return module

    yield load
    for name in loaded:
        del sys.modules[name]


def test_without_its_spring_it_moves_as_the_fmu_that_integrates_by_itself(example):
    integrator = example("multibody_integrator")
    contact = integrator.ContactForce(str(fmu_file("ForceElement")))
    motion = integrator.move(integrator.Ball(contact, stiffness=0.0), 0.6)
    contact.close()
    with ContactFmu(fmu_file("SphereCylinder")) as fmu:
        values = {"contact.method": "penalty", "contact.penalty_factor": integrator.PENALTY}
        place = {"source.center": integrator.START, "destination.axis": [0.0, 1.0, 0.0]}
        fmu.start(place | values, tolerance=1e-12)
        fmu.step(0.6)
        assert fmu["contact.onsets"] == 1
        check_close("displacement", motion.y[:3, -1], fmu["source.displacement"], 1e-6)


def test_a_hand_written_integrator_moves_both_bodies_as_the_reference(example):
    """Around TurningForceElement, by an independent integration of both"""
    example = example("turning_integrator")
    end = 0.06  # s: the ball has come, slid and left
    contact = example.ContactLoads(str(fmu_file("TurningForceElement")))
    state = example.move(contact, end)
    contact.close()
    moments = example.inertia(example.CYLINDER)
    values = {
        "source.radius": 0.1, "source.mass": 1.0, "source.center": example.BALL["center"],
        "source.rotation": "free", "source.initial_velocity": example.VELOCITY,
        "source.initial_angular_velocity": example.SPIN, "destination.radius": 0.5, "destination.mass": 20.0,
        "destination.motion": "free", "destination.rotation": "free", "gravity": [0.0, 0.0, 0.0],
        "destination.inertia_control": "user_defined", "destination.axial_inertia": moments[2],
        "destination.transverse_inertia": moments[0], "contact.location": "outside",
        "contact.friction": "regularized",
        **{name: value for name, value in example.LAW.items() if name != "contact.slip_velocity_control"},
        "contact.slip_velocity_control": "user_defined",
    }  # fmt: skip
    right = follow(values, "cylinder", end)
    assert right["contact.onsets"] == 1
    for body, part in (("source", state[:13]), ("destination", state[13:])):
        check_close(f"{body}.position", part[:3], right[f"{body}.position"], 1e-6)
        check_close(f"{body}.velocity", part[3:6], right[f"{body}.velocity"], 2e-5)
        check_close(f"{body}.angular_velocity", part[10:], right[f"{body}.angular_velocity"], 2e-4)
    strayed = np.max(np.abs(example.momenta(state) - example.momenta(example.begin())))
    check_close("momenta", strayed, 0.0, 1e-12)


def test_the_notebook_runs(monkeypatch):
    monkeypatch.setenv("CONTACT_FMUS", str(fmus_folder().resolve()))
    monkeypatch.setenv("MPLBACKEND", "agg")
    notebook = nbformat.read(EXAMPLES / "bounces.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "kept without outputs"
    NotebookClient(notebook, timeout=PATIENCE, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    texts = ["".join(o.get("text", "") for o in cell.get("outputs", ())) for cell in notebook.cells]
    drift, bounces = map(ast.literal_eval, texts[7].splitlines())
    assert set(drift) == {"non_adhesive", "unclamped", "approach_only"}
    assert max(drift.values()) < 1e-6 and min(bounces.values()) >= 2
    assert texts[9].split()[2] == "True"


def test_the_sweep_finds_the_restitution_of_a_damped_oscillator(tmp_path):
    """Unclamped, a contact lasts half a turn: exp(-pi z / sqrt(1 - z^2)) is left, z the damping ratio"""
    study = EXAMPLES / "sweep" / "restitution.toml"
    checked(python("contact_fmus", "sweep", study, "-o", tmp_path, "--workers", 1), environment=environment())
    text = said("sweep/read_results.py", tmp_path / "results.parquet", folder=tmp_path)
    names, _, *rows = (line.split() for line in text.splitlines())
    column = names.index("unclamped")
    assert len(rows) == 40
    for ratio, *found in rows:
        z = float(ratio)
        expected = math.exp(-math.pi * z / math.sqrt(1.0 - z * z))
        # the ratio is printed with four digits: half of the last one, times the slope
        allowed = 2e-4 / (1.0 - z * z) ** 1.5
        check_close(f"restitution at {ratio}", float(found[column - 1]), expected, allowed)


@pytest.fixture(scope="module")
def marble(tmp_path_factory, quick_python):
    """The FMU of the scene of one's own, built as its script says but sooner, in a folder of its own"""
    folder = tmp_path_factory.mktemp("marble")
    scene = EXAMPLES / "own_scene" / "MarbleOnPipe.toml"
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug"]
    configure += ["-DCMAKE_C_FLAGS_DEBUG=-O0", "-DCONTACT_FMI3=OFF"]
    configure += [f"-DCONTACT_EXTRA_SCENES={scene}", "-DBUILD_TESTING=OFF"]
    configure += [f"-DPython3_EXECUTABLE={quick_python}"]
    gone = folder / "fmus" / "Gone.fmu"
    gone.parent.mkdir()
    gone.write_text("of a scene that the build had before")
    for command in (configure, ["cmake", "--build", str(folder), "--target", "MarbleOnPipe_fmu"]):
        checked(command, environment={"LD_PRELOAD": ""})
    assert not gone.exists(), "the FMU of a scene that is gone"
    return folder / "fmus" / "MarbleOnPipe.fmu"


def test_a_scene_of_ones_own_is_built_and_driven(marble, tmp_path):
    text = said("own_scene/run_marble.py", marble, folder=tmp_path)
    place = [float(number) for number in re.search(r"\[(.*)\]", text)[1].split()]
    # No friction: along the pipe it is a body of 5 g that 0.01 N pushes for half a second.
    pushed = 0.5 * (0.01 / 0.005) * 0.5**2
    check_close("along", place[1], pushed + (0.01 / 0.005) * 0.5 * 0.5, 1e-5)
    assert place[0] == 0.0 and 0.055 < place[2] < 0.3
    assert int(re.search(r"and (\d+) bounces", text)[1]) >= 1


def test_the_guide_to_scene_files_shows_the_same_scene():
    guide = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    shown = re.search(r"```toml\n(.*?)```", guide, re.DOTALL)[1]
    scene = (EXAMPLES / "own_scene" / "MarbleOnPipe.toml").read_text(encoding="utf-8")
    assert scene.partition("\n")[2] == shown


def test_the_readme_names_every_example():
    links = re.findall(r"\]\(([^)]+)\)", (EXAMPLES / "README.md").read_text(encoding="utf-8"))
    assert all((EXAMPLES / link).exists() for link in links)
    named = {link.partition("/")[0] for link in links if not link.startswith("..")}
    assert {path.name for path in EXAMPLES.iterdir()} - {".ipynb_checkpoints"} == named | {"README.md"}
