"""`--choices integer`, a choice set to another item: importers compute what fmpy does with enumerations."""

import subprocess
import sys
from pathlib import Path

import pytest

from contact_fmus.fmu.files import fmus_folder
from contact_fmus.importers.command import AGREE, IMPORTERS, Given, installed, tried
from support.sources import ROOT

SCENE = "BallOnSphere"
CHOICE = {"contact.method": 1}  # penalty; the scene starts with 2, penalty_dynamic
PYTHON = Path(sys.executable)
ALWAYS = {"fmpy", "libcosim"}  # are in requirements.txt; others of Python are tried where they are installed


@pytest.fixture(scope="module")
def with_integers(tmp_path_factory):
    folder = tmp_path_factory.mktemp("integer")
    scene = ROOT / "modelDescription" / "scenes" / f"{SCENE}.toml"
    command = [sys.executable, "-m", "contact_fmus", "build", str(scene), "--choices", "integer"]
    run = subprocess.run([*command, "-o", str(folder)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
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
