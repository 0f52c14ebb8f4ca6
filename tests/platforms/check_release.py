"""The release FMUs of scripts/package.sh, run where they are made for: `scripts/package.sh --check`

Not among the tests of every change: it needs wine64, qemu-user, mingw-w64's gcc and a foreign C library.
macOS cannot be run here; its libraries are inspected.
"""

import os
import shutil
import sys
import zipfile

import lief
import pytest
from fmpy.validation import validate_fmu

from support.fmi2.elf import exported, glibc_version, needed
from support.portable_host import difference, motion, numbers
from support.programs import checked
from support.release import CASES, LIBRARIES, RELEASE, fmu_of, library_in
from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD, ROOT, SCENES

PLATFORMS3 = {f"{one}-{two}" for one in ("x86_64", "aarch64") for two in ("linux", "darwin")} | {
    "x86_64-windows"
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("platform", ["linux64", "win64", "aarch64-linux"])
def test_every_platform_gives_the_motion_of_linux(
    platform, case, hosts, release, of_this_build, record_property
):
    name, values, end, bound = CASES[case]
    program, environment = hosts[platform]
    folder = release(name)
    text = motion(program, library_in(folder, name, platform), folder, values, end, environment)
    off = difference(text, of_this_build(case))
    print(f"\n{platform} {case}: {off:.1e}", file=sys.__stderr__)
    assert off <= bound
    if case in BENCHMARKS:
        assert numbers(text)[-1][1:4] == pytest.approx(BENCHMARKS[case].position, abs=1e-9)


def test_linux_libraries_want_an_old_c_library_only(release):
    for name in SCENES:
        for platform in ("linux64", "aarch64-linux"):
            library = library_in(release(name), name, platform)
            assert glibc_version(library) <= (2, 17)
            assert needed(library) <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}
            assert exported(library) == exported(BUILD / "libraries" / f"{name}.so")


def test_windows_libraries_want_windows_only_and_show_the_functions_of_fmi(release):
    for name in SCENES:
        library = lief.parse(str(library_in(release(name), name, "win64")))
        assert {entry.name.lower() for entry in library.imports} == {"ucrtbase.dll"}
        shown = {entry.name for entry in library.get_export().entries}
        assert shown == exported(BUILD / "libraries" / f"{name}.so")


def test_macos_libraries_have_both_processors_and_show_the_functions_of_fmi(release):
    """Untested otherwise: nothing here runs them"""
    for name in SCENES:
        both = lief.MachO.parse(str(library_in(release(name), name, "darwin64")))  # the parts live as long
        parts = [both.at(i) for i in range(both.size)]
        assert {part.header.cpu_type.name for part in parts} == {"X86_64", "ARM64"}
        for part in parts:
            assert [one.name for one in part.libraries if one.command.name != "ID_DYLIB"] == [
                "/usr/lib/libSystem.B.dylib"
            ]
            assert list(part.build_version.minos)[:2] == [11, 0]
            shown = {symbol.name.removeprefix("_") for symbol in part.exported_symbols}
            shown -= {"__dso_handle", "_mh_dylib_header"}  # the linker's, in every library
            assert shown == exported(BUILD / "libraries" / f"{name}.so")
            signed = any(command.command.name == "CODE_SIGNATURE" for command in part.commands)
            assert signed or part.header.cpu_type.name == "X86_64"  # Apple's processors run nothing unsigned


def test_four_platforms_of_a_pinned_scene_are_small():
    assert fmu_of("PinnedEvent").stat().st_size <= 500_000


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("folder", ["fmus", "fmus-fmi3"])
def test_the_archive_has_platforms_sources_and_licences(folder, name):
    fmu = RELEASE / folder / f"{name}.fmu"
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
    places = set(LIBRARIES) if folder == "fmus" else PLATFORMS3
    assert {member.split("/")[1] for member in names if member.startswith("binaries/")} == places
    assert {
        "sources/contact.c",
        "sources/buildDescription.xml",
        "documentation/licenses/license.txt",
    } <= names
    assert not validate_fmu(str(fmu))


def test_the_same_sources_elsewhere_give_the_same_bytes(work):
    """Another folder for sources and build, two scenes, one with SUNDIALS"""
    clone = work / "somewhere" / "else"
    checked(["git", "clone", "-q", "--no-hardlinks", ROOT, clone])
    scenes = [
        clone / "modelDescription" / "scenes" / f"{name}.toml" for name in ("BallOnSphere", "ForceElement")
    ]
    source = os.environ.get("CONTACT_SUNDIALS_SOURCE")
    options = []
    if source:
        options = ["--sundials-source", shutil.copytree(source, work / "other-sundials")]
    environment = {"PYTHONPATH": str(clone / "scripts"), "XDG_CACHE_HOME": str(work / "cache")}
    command = [
        sys.executable,
        "-m",
        "contact_fmus",
        "build",
        *scenes,
        "--platforms",
        "all",
        "-o",
        work / "again",
    ]
    checked([*command, *options], timeout=3600, environment=environment)
    for scene in scenes:
        again = work / "again" / f"{scene.stem}.fmu"
        assert again.read_bytes() == fmu_of(scene.stem).read_bytes()
