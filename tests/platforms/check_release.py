"""The release FMUs of scripts/package.sh, run where they are made for: `scripts/package.sh --check`

Not among the tests of every change: it needs wine64, qemu-user, mingw-w64's gcc and a foreign C library.
macOS cannot be run here; its libraries are inspected.
"""

import os
import shutil
import sys
import zipfile
from pathlib import Path

import fmpy
import lief
import pytest
from fmpy.validation import validate_fmu

from contact_fmus.building.compiler import find_compiler
from support.fmi2.elf import exported, glibc_version, needed
from support.portable_host import HEADERS, SOURCE, difference, motion, numbers, settings, unpacked
from support.programs import checked
from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD, ROOT, SCENES

RELEASE = Path(os.environ.get("CONTACT_RELEASE", BUILD / "release"))
EXAMPLES = ("BallOnSphere", "BallInShell", "BallOffRoller", "PinnedEvent")
EXAMPLES += ("BouncingBall", "SpherePlane", "HertzImpact")
# (scene, start values, end, largest difference from Linux, relative above 1): all benchmarks, and examples
# as they start. The bounds hold what the last digits of another libm become (docs/platforms.md).
CASES = {name: (case.fmu, case.configuration, case.end, 1e-9) for name, case in BENCHMARKS.items()}
CASES |= {name: (name, {}, 2.0, 1e-9) for name in EXAMPLES}
METHODS = ("cvode_bdf", "cvode_adams")
CVODE = {f"P2 {method}": {**BENCHMARKS["P2"].configuration, "solver.method": method} for method in METHODS}
CASES |= {name: ("SphereSphere", values, 1.5, 1e-9) for name, values in CVODE.items()}
LIBRARIES = {"linux64": "so", "win64": "dll", "aarch64-linux": "so", "darwin64": "dylib"}
PLATFORMS3 = {f"{one}-{two}" for one in ("x86_64", "aarch64") for two in ("linux", "darwin")} | {
    "x86_64-windows"
}
QUIET_WINE = {"DISPLAY": "", "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
# Where Debian has it; it is on no path.
WINE = Path("/usr/lib/wine/wine64")
MINGW = "x86_64-w64-mingw32-gcc"


@pytest.fixture(scope="session")
def work(tmp_path_factory):
    return tmp_path_factory.mktemp("release")


@pytest.fixture(scope="session")
def release(work):
    return lambda name: work / name if (work / name).is_dir() else unpacked(fmu_of(name), work / name)


def fmu_of(name):
    return RELEASE / "fmus" / f"{name}.fmu"


def library_in(folder, name, platform):
    return folder / "binaries" / platform / f"{name}.{LIBRARIES[platform]}"


@pytest.fixture(scope="session")
def hosts(work):
    """The words that start host.c's program for each platform, and their environment"""
    made = {}
    # mingw's gcc brings its runtime compiled; zig would first compile hundreds of files, which takes minutes.
    for platform, compiler, options in (
        ("linux64", ["gcc"], ["-ldl"]),
        ("win64", [MINGW], ["-D__USE_MINGW_ANSI_STDIO=1"]),  # numbers read and printed to the last digit
        ("aarch64-linux", [*find_compiler("zig"), "--target=aarch64-linux-gnu.2.17"], ["-ldl"]),
    ):
        made[platform] = work / f"host-{platform}{'.exe' if platform == 'win64' else ''}"
        checked([*compiler, "-O2", "-s", f"-I{HEADERS}", SOURCE, *options, "-o", made[platform]])
    foreign = ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"]
    return {
        "linux64": ([made["linux64"]], {}),
        "win64": ([WINE, made["win64"]], {**QUIET_WINE, "WINEPREFIX": str(work / "wine")}),
        "aarch64-linux": ([*foreign, made["aarch64-linux"]], {}),
    }


@pytest.fixture(scope="session")
def of_this_build(hosts, work):
    """Motion by the library of the ordinary build, gcc's"""
    found = {}

    def run(case):
        if case not in found:
            name, values, end, _ = CASES[case]
            folder = work / f"own-{name}"
            if not folder.is_dir():
                unpacked(BUILD / "fmus" / f"{name}.fmu", folder)
            found[case] = motion(
                hosts["linux64"][0], library_in(folder, name, "linux64"), folder, values, end
            )
        return found[case]

    return run


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


@pytest.mark.parametrize("case", BENCHMARKS)
def test_mingw_builds_the_sources_and_gives_the_motion_of_linux(case, hosts, release, of_this_build):
    name, values, end, bound = CASES[case]
    folder = release(name)
    library = folder / "mingw.dll"
    if not library.exists():
        options = ["-std=c11", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-static-libgcc"]
        checked([MINGW, *options, "-o", library, "contact.c"], cwd=folder / "sources")
    program, environment = hosts["win64"]
    text = motion(program, library, folder, values, end, environment)
    off = difference(text, of_this_build(case))
    print(f"\nmingw {case}: {off:.1e}", file=sys.__stderr__)
    assert off <= bound


@pytest.fixture(scope="session")
def compiled_by_fmpy(work):
    """The library that `fmpy compile` makes of the sources, without those that were there"""

    def compiled(name):
        folder = work / f"fmpy-{name}"
        if not folder.is_dir():
            fmu = work / f"{name}.fmu"
            with zipfile.ZipFile(fmu_of(name)) as old, zipfile.ZipFile(fmu, "w") as new:
                for member in old.namelist():
                    if not member.startswith("binaries/"):
                        new.writestr(member, old.read(member))
            checked([sys.executable, "-m", "fmpy", "compile", fmu])
            unpacked(fmu, folder)
        return folder

    return compiled


@pytest.mark.parametrize("case", BENCHMARKS)
def test_fmpy_compiles_the_sources(case, compiled_by_fmpy):
    """fmpy's project links no libm, which Python itself has: the host is fmpy"""
    benchmark = BENCHMARKS[case]
    folder = compiled_by_fmpy(benchmark.fmu)
    pairs = settings(fmpy.read_model_description(str(folder)), benchmark.configuration)
    values = {variable.name: value for variable, value in pairs}
    names = [f"source.position[{axis}]" for axis in (1, 2, 3)]
    about = {"start_values": values, "output": names, "stop_time": benchmark.end}
    rows = fmpy.simulate_fmu(str(folder), output_interval=benchmark.end / 37, **about)
    assert [rows[name][-1] for name in names] == pytest.approx(benchmark.position, abs=1e-9)


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


def test_clang_in_the_mode_of_msvc_has_no_complaint_about_the_sources(release):
    """mingw's headers stand in for Microsoft's, and are not all to the liking of this mode"""
    headers = Path(find_compiler("zig")[0]).parent / "lib" / "libc" / "include"
    folders = [headers / one for one in ("x86_64-windows-gnu", "generic-mingw", "any-windows-any")]
    command = ["clang", "--target=x86_64-pc-windows-msvc", "-fsyntax-only", "-std=c11", "-Wall", "-Wextra"]
    command += ["-pedantic", "-ferror-limit=0", "-nostdlibinc", "-D_UCRT"]
    command += [word for folder in folders for word in ("-isystem", folder)]
    for name in ("SphereSphere", "PinnedEvent", "ForceElement"):
        sources = release(name) / "sources"
        wrong = sources / "wrong.c"
        wrong.write_text('#include "contact.c"\nint *wrong = 1.5;\n')
        assert [line for line in complaints([*command, "wrong.c"], sources) if line.startswith("wrong.c:2")]
        wrong.unlink()
        assert complaints([*command, "contact.c"], sources) == []


def complaints(command, folder):
    """Of files in the folder, not of headers elsewhere"""
    text = checked(command, cwd=folder, status=None)
    lines = [line for line in text.splitlines() if ": error:" in line or ": warning:" in line]
    return [line for line in lines if not line.startswith("/")]


@pytest.fixture(scope="session")
def bare_root(work):
    """A Debian 12 that has only a C compiler"""
    root = work / "root"
    include = "--include=gcc,libc6-dev"
    checked(["debootstrap", "--variant=minbase", include, "bookworm", root], timeout=900)
    yield root
    shutil.rmtree(root)


@pytest.mark.parametrize("case", BENCHMARKS)
def test_a_bare_debian_with_a_c_compiler_builds_and_runs_the_sources(case, bare_root, release):
    name, values, end, _ = CASES[case]
    folder = bare_root / "build" / name
    if not folder.is_dir():
        shutil.copytree(release(name) / "sources", folder)
        shutil.copytree(HEADERS, bare_root / "build" / "headers", dirs_exist_ok=True)
        shutil.copy(SOURCE, bare_root / "build")
        inside = ["chroot", bare_root, "cc", "-std=c11", "-O2"]
        checked([*inside, "-shared", "-fPIC", "-o", f"/build/{name}/a.so", f"/build/{name}/contact.c", "-lm"])
        checked([*inside, "-I/build/headers", "/build/host.c", "-ldl", "-o", "/build/host"])
    text = motion(["chroot", bare_root, "/build/host"], f"/build/{name}/a.so", release(name), values, end)
    assert numbers(text)[-1][1:4] == pytest.approx(BENCHMARKS[case].position, abs=1e-9)


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
