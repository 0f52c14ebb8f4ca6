"""Every FMU is a valid FMI 2.0 FMU, by independent judges, and its library asks nothing of the machine.

The judges: fmpy with the schema of the standard, and VDMCheck2 with its two models. A judge that never
objects proves nothing, so each is also shown a description with a fault it has to find: fmpy where a
damaged copy of a shipped FMU is checked, in tests/package/test_bad_requests.py."""

import re
import socket
import struct
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from support.fmi2 import elf, vdmcheck
from support.fmi2.raw import KINDS, SCENES
from support.sources import ROOT

FMPY = Path(fmpy.__file__).parent

# The FMUs run where glibc is this old or newer, because of pow. Debian 11 and Ubuntu 20.04 have 2.31.
GLIBC = (2, 29)

every_fmu = pytest.mark.parametrize("scene", SCENES)


@pytest.fixture(scope="session")
def vdm_folder():
    return vdmcheck.prepare()


@pytest.fixture
def description(fmu_path):
    return lambda scene: zipfile.ZipFile(fmu_path(scene)).read("modelDescription.xml")


@pytest.fixture
def library(fmu_path, tmp_path):
    """The library inside the FMU, as a user gets it."""
    return lambda scene: zipfile.ZipFile(fmu_path(scene)).extract(f"binaries/linux64/{scene}.so", tmp_path)


def packed(folder, description):
    """An FMU of the description alone."""
    with zipfile.ZipFile(folder / "broken.fmu", "w") as fmu:
        fmu.writestr("modelDescription.xml", description)
    return folder / "broken.fmu"


# --- the description ---------------------------------------------------------------------------------


@every_fmu
def test_fmpy_reports_nothing(fmu_path, scene, names_parsed_once):
    assert validate_fmu(str(fmu_path(scene))) == []


@pytest.mark.parametrize("model", vdmcheck.MODELS)
@pytest.mark.parametrize("scene", KINDS)
def test_vdmcheck_reports_nothing(fmu_path, vdm_folder, scene, model):
    """The others' descriptions have no entry that is not in one of these."""
    assert vdmcheck.check(fmu_path(scene), model, vdm_folder) == []


# What is wrong, what to write for what, what the complaint has to name, and which models see it.
FAULTS = [
    (rb'(name="source\.radius".*?) start="[^"]*"', rb'\1 start="1e200"', "start 1.0E200 is not within",
        ["static-model"]),
    (rb'declaredType="Length"', b'declaredType="Lenght"', '"Lenght"', vdmcheck.MODELS),
    (rb'name="source\.radius"', b'name="destination.radius"', "not unique", vdmcheck.MODELS),
    (rb'(name="contact\.gap".*?)"continuous"', rb'\1"fixed"', '"contact.gap"', vdmcheck.MODELS),
    (rb"(<Outputs>\s*)<Unknown[^>]*>", rb"\1", "Outputs section does not match", vdmcheck.MODELS),
]  # fmt: skip


@pytest.mark.parametrize("model", vdmcheck.MODELS)
def test_vdmcheck_finds_every_fault(description, vdm_folder, tmp_path, model):
    broken = description("ForceElement")
    for pattern, replacement, _, _ in FAULTS:
        broken, count = re.subn(pattern, replacement, broken, count=1, flags=re.DOTALL)
        assert count == 1, pattern
    said = "\n".join(vdmcheck.check(packed(tmp_path, broken), model, vdm_folder))
    assert [words for _, _, words, models in FAULTS if model in models and words not in said] == []


# --- the archive -------------------------------------------------------------------------------------


@every_fmu
def test_the_archive_holds_what_the_standard_lists_and_nothing_else(fmu_path, scene):
    with zipfile.ZipFile(fmu_path(scene)) as fmu:
        names = fmu.namelist()
        assert fmu.testzip() is None
    assert len(names) == len(set(names))
    required = {
        "modelDescription.xml", "model.png", f"binaries/linux64/{scene}.so", "documentation/index.html",
        "resources/scene.json", "terminalsAndIcons/terminalsAndIcons.xml", "terminalsAndIcons/icon.png",
        "terminalsAndIcons/icon.svg",
    }  # fmt: skip
    assert required <= set(names)
    sources = {name for name in names if name.startswith("sources/")}
    assert {"sources/buildDescription.xml", "sources/contact.c", "sources/scene.h"} <= sources
    folder = "extra/org.fmi-standard.fmi-ls-ref/"
    reference = {name for name in names if name.startswith(folder)}
    assert f"{folder}fmi-ls-manifest.xml" in reference
    others = {one for one in names if not one.startswith("documentation/")} - required - sources - reference
    assert others == set()
    licenses = {Path(name).name for name in names if name.startswith("documentation/licenses/")}
    assert licenses & {"license.txt", "license.html"}, "FMI 2.0.5, 2.3: the entry point to the licences"


@every_fmu
def test_the_archive_is_portable_and_reproducible(fmu_path, scene):
    with zipfile.ZipFile(fmu_path(scene)) as fmu:
        members = fmu.infolist()
    assert members[0].filename == "modelDescription.xml"
    for member in members:
        assert member.compress_type in (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED)
        assert re.fullmatch(r"[A-Za-z0-9_./-]+", member.orig_filename), member.orig_filename
        assert not member.filename.startswith(("/", "../"))
        assert member.date_time == (1980, 1, 1, 0, 0, 0), "a time would make every build differ"


def test_packing_the_same_files_gives_the_same_bytes(fmu_path, tmp_path):
    pack_fmu = ROOT / "cmake" / "pack_fmu.py"
    original = fmu_path("SphereSphere")
    with zipfile.ZipFile(original) as fmu:
        fmu.extractall(tmp_path / "members")
    again = tmp_path / "again.fmu"
    files = [path for path in (tmp_path / "members").rglob("*") if path.is_file()]
    arguments = [f"{path.relative_to(tmp_path / 'members').as_posix()}={path}" for path in reversed(files)]
    elf.run(sys.executable, pack_fmu, again, *arguments)
    assert again.read_bytes() == original.read_bytes()


@every_fmu
def test_the_documentation_stands_alone(fmu_path, scene):
    """Every picture and every page it leads to is inside the FMU or an address of the web."""
    with zipfile.ZipFile(fmu_path(scene)) as fmu:
        names = set(fmu.namelist())
        page = etree.HTML(fmu.read("documentation/index.html"))
    targets = page.xpath("//@href | //@src")
    assert targets
    for target in targets:
        if not target.startswith(("#", "https://", "data:")):
            resolved = (Path("/documentation") / target.partition("#")[0]).as_posix()
            assert str(Path(resolved).resolve()).lstrip("/") in names, target


@every_fmu
def test_the_icon_is_a_picture(fmu_path, scene):
    data = zipfile.ZipFile(fmu_path(scene)).read("model.png")
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", data[16:24])
    assert min(width, height) >= 100


@every_fmu
def test_sundials_and_its_licence_go_together(fmu_path, library, scene):
    licensed = any("sundials" in name.lower() for name in zipfile.ZipFile(fmu_path(scene)).namelist())
    inside = "CVODE" in elf.text(library(scene))
    assert licensed == inside


# --- the library -------------------------------------------------------------------------------------


@every_fmu
def test_the_library_needs_only_libc_and_libm(library, scene):
    assert elf.needed(library(scene)) <= {"libc.so.6", "libm.so.6"}


@every_fmu
def test_the_library_runs_on_old_systems(library, scene):
    assert elf.glibc_version(library(scene)) <= GLIBC


@every_fmu
def test_the_library_exports_the_functions_of_the_standard_and_nothing_else(library, scene):
    header = (FMPY / "c-code" / "fmi2Functions.h").read_text()
    kinds = re.split(r"/\*+\s*(?=Common Functions|Functions for FMI2 for)", header)
    # The header has the macros for Co-Simulation first and the declarations later.
    wanted = set()
    for part in kinds:
        if part.startswith(("Common Functions", "Functions for FMI2 for")):
            wanted |= set(re.findall(r"FMI2_Export\s+\w+\s+(fmi2\w+);", part))
    assert {"fmi2GetVersion", "fmi2DoStep", "fmi2GetStringStatus", "fmi2GetDerivatives"} <= wanted
    assert elf.exported(library(scene)) == wanted


@every_fmu
def test_nothing_tells_of_the_machine_that_built_it(fmu_path, scene):
    """No path below a home, a temporary folder or this checkout, and not the name of the host."""
    host = socket.gethostname()
    traces = [rb"/(?:home|root|tmp|Users|builds?)/\w", re.escape(str(ROOT)).encode()]
    if len(host) > 4:
        traces.append(re.escape(host).encode())
    with zipfile.ZipFile(fmu_path(scene)) as fmu:
        for name in fmu.namelist():
            for trace in traces:
                found = re.search(trace, fmu.read(name))
                assert found is None, f"{name}: {found.group()}"
