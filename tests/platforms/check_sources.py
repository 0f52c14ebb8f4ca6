"""The sources in the release FMUs, by other compilers and in a bare Debian: `scripts/package.sh --check`"""

import os
import shutil
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from contact_fmus.building.cmake_build import find_compiler
from support import portable_host
from support.programs import PATIENCE, checked
from support.release import CASES, CHECKED, CHECKED_CASES, CVODE, FEW_CASES, FOLDERS, MINGW, fmu_of

BESIDE = Path(__file__).parent
WARNINGS = ["-Wall", "-Wextra", "-pedantic", "-Werror"]


@pytest.mark.parametrize("case", [case for case in CHECKED_CASES if case not in CVODE])
def test_mingw_builds_the_sources_and_gives_the_motion_of_linux(case, hosts, release, of_this_build):
    """Its own libm, and msvcrt.dll"""
    name, values, end, bound = CASES[case]
    folder = release(name)
    library = folder / "mingw.dll"
    if not library.exists():
        options = ["-std=c11", *WARNINGS, "-O2", "-shared", "-static-libgcc"]
        checked([MINGW, *options, "-o", library, "contact.c"], cwd=folder / "sources")
    program, environment = hosts[2, "win64"]
    text = portable_host.motion(program, library, folder, values, end, environment)
    off = portable_host.difference(text, of_this_build(case))
    print(f"\nmingw {case}: {off:.1e}", file=sys.__stderr__)
    assert off <= bound


@pytest.mark.parametrize("version", FOLDERS)
@pytest.mark.parametrize("name", CHECKED)
def test_all_that_is_called_is_there_without_an_optimizer_too(name, version, release):
    """Which would leave calls out that no scene of its kind makes"""
    options = ["-std=c11", *WARNINGS, "-O0", "-shared", "-fPIC", "-Wl,-z,defs", "-o", os.devnull]
    checked(["gcc", *options, "contact.c", "-lm"], cwd=release(name, version) / "sources")


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
            portable_host.unpacked(fmu, folder)
        return folder

    return compiled


@pytest.mark.parametrize("case", FEW_CASES)
def test_fmpy_compiles_the_sources(case, compiled_by_fmpy, of_this_build):
    """fmpy's project links no libm, which Python itself has: the host is fmpy"""
    name, configuration, end, bound = CASES[case]
    folder = compiled_by_fmpy(name)
    description = fmpy.read_model_description(str(folder))
    values = {variable.name: value for variable, value in portable_host.settings(description, configuration)}
    names = portable_host.outputs(description)
    about = {"start_values": values, "output": names, "stop_time": end}
    rows = fmpy.simulate_fmu(str(folder), output_interval=end / portable_host.STEPS, **about)
    expected = portable_host.numbers(of_this_build(case))[-1][1:]
    assert [rows[name][-1] for name in names] == pytest.approx(expected, rel=bound, abs=bound)


def compile_as_msvc(file, compiled, folder):
    """clang in the mode of Microsoft's compiler; mingw-w64's headers stand in for Microsoft's"""
    headers = Path(find_compiler("zig")[0]).parent / "lib" / "libc" / "include"
    folders = [headers / one for one in ("x86_64-windows-gnu", "generic-mingw", "any-windows-any")]
    command = ["clang", "--target=x86_64-pc-windows-msvc", "-std=c11", "-O2", *WARNINGS]
    command += ["-nostdlibinc", "-D_UCRT", "-include", BESIDE / "msvc_headers.h"]
    command += [word for one in folders for word in ("-isystem", one)]
    return checked([*command, "-c", file, "-o", compiled], cwd=folder, status=1 if "wrong" in file else 0)


@pytest.mark.parametrize("name", CHECKED)
def test_clang_in_the_mode_of_msvc_has_no_complaint_about_the_sources(name, release):
    sources = release(name) / "sources"
    wrong = sources / "wrong.c"
    wrong.write_text('#include "contact.c"\nint *wrong = 1.5;\n')
    assert "wrong.c:2" in compile_as_msvc("wrong.c", os.devnull, sources)
    wrong.unlink()
    assert compile_as_msvc("contact.c", os.devnull, sources) == ""


@pytest.mark.parametrize("case", [case for case in CHECKED_CASES if case not in CVODE])
def test_clang_in_the_mode_of_msvc_gives_the_motion_of_linux(case, hosts, release, of_this_build):
    """With mingw-w64's libm"""
    name, values, end, bound = CASES[case]
    folder = release(name)
    library = folder / "msvc.dll"
    if not library.exists():
        compile_as_msvc("contact.c", folder / "msvc.obj", folder / "sources")
        parts = [folder / "msvc.obj", BESIDE / "msvc_runtime.c"]
        checked([MINGW, "-shared", "-static-libgcc", "-o", library, *parts])
    program, environment = hosts[2, "win64"]
    text = portable_host.motion(program, library, folder, values, end, environment)
    off = portable_host.difference(text, of_this_build(case))
    print(f"\nmsvc {case}: {off:.1e}", file=sys.__stderr__)
    assert off <= bound


@pytest.fixture(scope="session")
def bare_root(work):
    """A Debian 12 that has only a C compiler"""
    root = work / "root"
    include = "--include=gcc,libc6-dev"
    checked(["debootstrap", "--variant=minbase", include, "bookworm", root], timeout=PATIENCE)
    yield root
    shutil.rmtree(root)


@pytest.mark.parametrize("case", FEW_CASES)
def test_a_bare_debian_with_a_c_compiler_builds_and_runs_the_sources(case, bare_root, release, of_this_build):
    name, values, end, bound = CASES[case]
    folder = bare_root / "build" / name
    if not folder.is_dir():
        shutil.copytree(release(name) / "sources", folder)
        shutil.copytree(portable_host.HEADERS, bare_root / "build" / "headers", dirs_exist_ok=True)
        for file in (portable_host.SOURCE, portable_host.SOURCE.with_name("host_library.h")):
            shutil.copy(file, bare_root / "build")
        inside = ["chroot", bare_root, "cc", "-std=c11", "-O2"]
        checked([*inside, "-shared", "-fPIC", "-o", f"/build/{name}/a.so", f"/build/{name}/contact.c", "-lm"])
        checked([*inside, "-I/build/headers", "/build/host.c", "-ldl", "-o", "/build/host"])
    host = ["chroot", bare_root, "/build/host"]
    text = portable_host.motion(host, f"/build/{name}/a.so", release(name), values, end)
    assert portable_host.difference(text, of_this_build(case)) <= bound
