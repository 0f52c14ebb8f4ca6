"""The release FMUs of scripts/package.sh, run where they are made for: `scripts/package.sh --check`

Not among the tests of every change: it needs wine64, qemu-user, mingw-w64's gcc and a foreign C library.
macOS cannot be run here; its libraries are inspected."""

import os
import shutil
import sys
import sysconfig
import zipfile
from xml.etree import ElementTree

import lief
import pytest
from fmpy.validation import validate_fmu

from support.fmi2.elf import exported, glibc_version, needed
from support.portable_host import difference, motion, numbers
from support.programs import PATIENCE, checked
from support.release import CASES, CHECKED, CHECKED_CASES, FOLDERS, LIBRARIES, RUN, fmu_of, library_in
from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD, ROOT

EVERY_LIBRARY = [(name, version) for name in CHECKED for version in FOLDERS]
RUNS = [(version, platform) for version, platforms in RUN.items() for platform in platforms]
MACOS = {2: ["darwin64"], 3: ["x86_64-darwin", "aarch64-darwin"]}


def has_cvode(name):
    return "set(SCENE_HAS_CVODE ON)" in (BUILD / "scenes" / name / "scene.cmake").read_text()


def has_several_contacts(name):
    return "#define SCENE_CONTACTS 1\n" not in (BUILD / "scenes" / name / "scene.h").read_text()


def functions_of_fmi(name, version):
    """What the ordinary build shows of them"""
    return exported(BUILD / "libraries" / ("fmi3" if version == 3 else "") / f"{name}.so")


@pytest.mark.parametrize("case", CHECKED_CASES)
@pytest.mark.parametrize(("version", "platform"), RUNS)
def test_every_platform_gives_the_motion_of_linux(version, platform, case, hosts, release, of_this_build):
    """FMI 3.0 too that of FMI 2.0"""
    name, values, end, bound = CASES[case]
    program, environment = hosts[version, platform]
    folder = release(name, version)
    text = motion(program, library_in(folder, name, platform), folder, values, end, environment)
    off = difference(text, of_this_build(case))
    print(f"\nFMI {version} {platform} {case}: {off:.1e}", file=sys.__stderr__)
    assert off <= bound
    if case in BENCHMARKS:
        assert numbers(text)[-1][1:4] == pytest.approx(BENCHMARKS[case].position, abs=1e-9)


@pytest.mark.parametrize(("name", "version"), EVERY_LIBRARY)
def test_linux_libraries_want_an_old_c_library_only(name, version, release):
    for platform in RUN[version]:
        if "win" not in platform:
            library = library_in(release(name, version), name, platform)
            assert glibc_version(library) <= (2, 17)
            assert needed(library) <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}
            assert exported(library) == functions_of_fmi(name, version)


@pytest.mark.parametrize(("name", "version"), EVERY_LIBRARY)
def test_windows_libraries_want_windows_only_and_show_the_functions_of_fmi(name, version, release):
    library = lief.parse(str(library_in(release(name, version), name, RUN[version][1])))
    assert {entry.name.lower() for entry in library.imports} == {"ucrtbase.dll"}
    assert {entry.name for entry in library.get_export().entries} == functions_of_fmi(name, version)


@pytest.mark.parametrize(("name", "version"), EVERY_LIBRARY)
def test_macos_libraries_have_both_processors_and_show_the_functions_of_fmi(name, version, release):
    """Untested otherwise: nothing here runs them. FMI 2.0 has both in one file, FMI 3.0 a file for each."""
    folder = release(name, version)
    files = [lief.MachO.parse(str(library_in(folder, name, one))) for one in MACOS[version]]
    parts = [file.at(i) for file in files for i in range(file.size)]  # which live as long as `files`
    assert [part.header.cpu_type.name for part in parts] == ["X86_64", "ARM64"]
    for part in parts:
        (wanted,) = (one.name for one in part.libraries if one.command.name != "ID_DYLIB")
        assert wanted == "/usr/lib/libSystem.B.dylib"
        assert list(part.build_version.minos)[:2] == [11, 0]
        shown = {symbol.name.removeprefix("_") for symbol in part.exported_symbols}
        shown -= {"__dso_handle", "_mh_dylib_header"}  # the linker's, in every library
        assert shown == functions_of_fmi(name, version)
        signed = any(command.command.name == "CODE_SIGNATURE" for command in part.commands)
        assert signed or part.header.cpu_type.name == "X86_64"  # Apple's processors run nothing unsigned


@pytest.mark.parametrize(("name", "version"), EVERY_LIBRARY)
def test_an_fmu_of_all_platforms_is_small_where_the_solver_is_pinned(name, version):
    """Where it is a choice, SUNDIALS is in it five times; many bodies need the general segment in any case"""
    size = fmu_of(name, version).stat().st_size
    print(f"\nFMI {version} {name}: {size / 1000:.0f} kB", file=sys.__stderr__)
    assert size <= 500_000 or has_cvode(name) or has_several_contacts(name)


@pytest.mark.parametrize(("name", "version"), EVERY_LIBRARY)
def test_the_archive_has_platforms_sources_and_licences(name, version):
    fmu = fmu_of(name, version)
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
        build = ElementTree.fromstring(archive.read("sources/buildDescription.xml"))
        about = ElementTree.fromstring(archive.read("modelDescription.xml"))
    binaries = {member.removeprefix("binaries/") for member in names if member.startswith("binaries/")}
    assert binaries == {f"{platform}/{name}.{ending}" for platform, ending in LIBRARIES[version].items()}
    licences = {"license.txt", "fmi-headers.txt"} | ({"sundials.txt"} if has_cvode(name) else set())
    assert {member.rpartition("/")[2] for member in names if "/licenses/" in member} == licences
    assert build.get("fmiVersion") == "3.0"  # of this file, in FMI 2.0 too
    (made,) = build.findall("BuildConfiguration")
    assert made.get("modelIdentifier") == name
    assert {one.get("modelIdentifier") for one in about.iter() if one.get("modelIdentifier")} == {name}
    sources = {f"sources/{one.get('name')}" for one in made.iter("SourceFile")}
    assert sources == {"sources/contact.c"} and sources <= names
    assert not validate_fmu(str(fmu))


@pytest.mark.parametrize("version", FOLDERS)
def test_the_same_sources_elsewhere_give_the_same_bytes(version, work):
    """Other folders for sources, SUNDIALS and build; the first scene with CVODE and the first without"""
    names = [name for name in CHECKED if has_cvode(name)][:1]
    names += [name for name in CHECKED if not has_cvode(name)][:1]
    clone = work / "somewhere" / "else"
    if not clone.is_dir():
        checked(["git", "clone", "-q", "--no-hardlinks", ROOT, clone])
    options = ["--platforms", "all", "--fmi", str(version), "-o", work / f"again-{version}"]
    source = os.environ.get("CONTACT_SUNDIALS_SOURCE")
    if source:
        other = work / "other-sundials"
        options += ["--sundials-source", other if other.is_dir() else shutil.copytree(source, other)]
    # -S: the package that is installed here would come before the clone's
    folders = os.pathsep.join([str(clone / "scripts"), sysconfig.get_path("purelib")])
    environment = {"PYTHONPATH": folders, "XDG_CACHE_HOME": str(work / "cache")}
    scenes = [clone / "modelDescription" / "scenes" / f"{name}.toml" for name in names]
    command = [sys.executable, "-S", "-m", "contact_fmus", "build", *scenes, *options]
    checked(command, timeout=PATIENCE, environment=environment)
    built = [file.read_text() for file in (work / "cache").rglob("build/CMakeCache.txt")]
    assert built and all(f"CMAKE_HOME_DIRECTORY:INTERNAL={clone}\n" in text for text in built)
    for name in names:
        again = work / f"again-{version}" / f"{name}.fmu"
        assert again.read_bytes() == fmu_of(name, version).read_bytes()
