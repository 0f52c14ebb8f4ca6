"""FMUs of every kind in the importers of requirements.txt, each in a process of its own, in any folder."""

import shutil
import sys
from pathlib import Path

import pytest

from contact_fmus.errors import UserError
from contact_fmus.importers.command import AGREE, IMPORTERS, Given, Trial, page, table, tried
from support.fmi2.raw import KINDS
from support.programs import finished
from support.sources import ROOT

# One of each kind, and one that rolls
SCENES = (*KINDS, "Turntable")
FMPY, LIBCOSIM = (next(one for one in IMPORTERS if one.name == name) for name in ("fmpy", "libcosim"))
STEP, COUNT = 1e-3, 600  # a ball that falls has struck by then
GIVEN = Given(STEP, COUNT, Path(sys.executable), {})

# fmpy as users call it, twice at once, with a reset between; it prints the end of each run.
SIMULATE = """
import sys
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu
path = sys.argv[1]
about, folder = read_model_description(path), extract(path)
fmus = [instantiate_fmu(folder, about, "CoSimulation") for _ in range(2)]
ends = []
for _ in range(2):
    for fmu in fmus:
        arguments = dict(fmu_instance=fmu, model_description=about, stop_time=0.1, output_interval=0.01)
        ends.append(simulate_fmu(folder, **arguments)[-1].tolist())
        fmu.reset()
assert all(end == ends[0] for end in ends), ends
"""


# The friction on a body that rolls is mu F_n/v_0 times its slip, the difference of two speeds, each of which
# rounds: by so much [N] it differs between importers whose times differ by a rounding. From mu F_n [N],
# v_0 and the speeds [m/s]:
ROUNDING = 2.2e-16
FRICTION_ROUNDS_BY = {"Turntable": 4 * ROUNDING * 4.9 / 1e-5 * 1.5}


@pytest.mark.parametrize("scene", SCENES)
def test_libcosim_ends_where_fmpy_does(fmu_path, scene):
    here, there = (tried(importer, Path(fmu_path(scene)), GIVEN) for importer in (FMPY, LIBCOSIM))
    assert (here.problem, there.problem) == ("", "")
    assert len(here.values) > 10
    assert there.difference(here) <= AGREE + FRICTION_ROUNDS_BY.get(scene, 0.0)


@pytest.mark.parametrize("scene", SCENES)
def test_fmpy_runs_it_from_a_folder_with_blanks_and_umlauts_in_silence(fmu_path, tmp_path, scene):
    folder = tmp_path / "Bälle und Röhren ç"
    folder.mkdir()
    path = shutil.copy(fmu_path(scene), folder / f"{scene} 2.fmu")
    run = finished([sys.executable, "-c", SIMULATE, path])
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


def test_an_fmu_that_cannot_run_is_refused_with_the_reason(tmp_path):
    broken = tmp_path / "Broken.fmu"
    shutil.copy(ROOT / "modelDescription" / "variables.toml", broken)
    with pytest.raises(UserError, match="this is no FMU: not a ZIP archive"):
        tried(FMPY, broken, GIVEN)


def test_a_setting_that_is_no_choice_of_the_fmu_is_refused(fmu_path):
    for name in ("contact.no_method", "contact.gap"):
        asked = Given(STEP, COUNT, Path(sys.executable), {}, {name: 1})
        with pytest.raises(UserError, match=f"there is no Integer or Enumeration '{name}'"):
            tried(FMPY, Path(fmu_path("BallOnSphere")), asked)


def test_other_numbers_are_told():
    """An importer that says nothing is wrong, of an FMU that stayed at its start"""
    reference = Trial(FMPY, "Ball", "1", {"contact.gap": 0.5, "source.position[3]": 2.0})
    still = Trial(LIBCOSIM, "Ball", "1", {"contact.gap": 0.5, "source.position[3]": 3.0})
    assert still.difference(reference) == 0.5
    for name in still.values:
        lost = Trial(LIBCOSIM, "Ball", "1", {**reference.values, name: float("nan")})
        assert lost.difference(reference) > 1.0
    assert reference.difference(Trial(FMPY, "Ball", problem="refused")) == float("inf")
    text = page({2: table([reference, still], [FMPY, LIBCOSIM])}, STEP, COUNT)
    assert "| FMU | fmpy 1 (PyPI) | libcosim 1 (PyPI) | fmuloader (PyPI) | ecos (PyPI) |" in text
    assert "| Ball | reference | 5e-01 **differs** | not installed | not installed |" in text
