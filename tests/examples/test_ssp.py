"""The example with SSP: its system is valid, fmpy's importer runs it, and docs/ssp.md has today's figures"""

import importlib
import sys

import pytest
from fmpy.ssp.ssd import read_ssd

from contact_fmus.fmu.files import fmus_folder
from support.checks import check_relative
from support.programs import checked
from support.sources import ROOT

FOLDER = ROOT / "examples" / "ssp"
NAMES = ("make_ssp", "master", "run_ssp")
SIZE = 2e-3  # s


@pytest.fixture(scope="module")
def modules():
    sys.path.insert(0, str(FOLDER))
    yield {name: importlib.import_module(name) for name in NAMES}
    sys.path.remove(str(FOLDER))
    for name in NAMES:
        del sys.modules[name]


@pytest.fixture(scope="module")
def ssp(tmp_path_factory):
    file = tmp_path_factory.mktemp("ssp") / "tube.ssp"
    checked([sys.executable, FOLDER / "make_ssp.py", fmus_folder(), file])
    return str(file)


def test_the_system_is_valid_and_wires_what_the_fmus_have(ssp):
    system = read_ssd(ssp, validate=True).system
    assert {one.name for one in system.elements} == {"Carriage", "Tube"}
    wired = {(one.startElement, one.endElement) for one in system.connections}
    assert wired == {("Carriage", "Tube"), ("Tube", "Carriage")}


def test_the_page_has_the_figures_of_a_run_and_each_way_is_better_than_the_one_before(ssp, modules):
    ((_, errors, results),) = modules["run_ssp"].rows(ssp, [SIZE])
    files = (ROOT / "docs/ssp.md", FOLDER / "page.md")
    pages = [path.read_text(encoding="utf-8").splitlines() for path in files]
    lines = pages[0]
    shown, meant = ([line for line in page if line and not line.startswith(("|", "{"))] for page in pages)
    assert shown == meant
    told = [[float(one) for one in line.strip("|").split("|")] for line in lines if line.startswith("| 2 |")]
    assert len(told) == 2
    for value, found in zip(told[0][1:], errors.values(), strict=True):
        check_relative("error, mm", value, 1e3 * found, 0.05)  # two digits
    names = list(modules["run_ssp"].WAYS)
    for value, name in zip(told[1][1:4], names[2:], strict=True):
        check_relative("mismatch, N", value, results[name].mismatch, 0.05)
    assert told[1][4:] == [results[name].taken_back for name in names[2:]]
    assert errors["fmpy"] > errors["and derivatives"] > errors["and variable steps"]
    assert errors["and variable steps"] > 10 * errors["with directional derivatives"]
    assert results["and repeated steps"].mismatch > 100 * results["with directional derivatives"].mismatch


def test_a_run_whose_every_step_is_taken_back_has_the_same_bits(ssp, modules):
    master = modules["master"]

    class Hesitant(master.System):
        def advance(self, size):
            saved = self.save()
            super().advance(size / 3)
            self.restore(saved)
            self.free(saved)
            super().advance(size)

    ends = []
    for kind in (master.System, Hesitant):
        system = kind(ssp, master.Ways(derivatives=True))
        while system.time < 0.25:
            system.step(SIZE)
        ends.append((system.tube.get("source.position[3]"), system.carriage.get("source.displacement[3]")))
        assert system.tube.get("contact.onsets") == 1
        system.close()
    assert system.taken_back > 100
    assert ends[0] == ends[1]
