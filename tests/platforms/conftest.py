"""What the checks of a release share: hosts for each platform, unpacked FMUs, the motion of this build"""

import pytest

from contact_fmus.building.cmake_build import find_compiler
from support.portable_host import HEADERS, SOURCES, motion, unpacked
from support.programs import checked
from support.release import CASES, MINGW, QUIET_WINE, RUN, WINE, fmu_of, library_in
from support.sources import BUILD


@pytest.fixture(scope="session")
def work(tmp_path_factory):
    return tmp_path_factory.mktemp("release")


@pytest.fixture(scope="session")
def release(work):
    """The folder of an FMU, by scene and version of FMI, unpacked once"""

    def folder(name, version=2):
        place = work / f"{name}-{version}"
        return place if place.is_dir() else unpacked(fmu_of(name, version), place)

    return folder


@pytest.fixture(scope="session")
def hosts(work):
    """The words that start the host for each platform's folder of libraries, and their environment"""
    made = {}
    foreign = ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"]
    wine = {**QUIET_WINE, "WINEPREFIX": str(work / "wine")}
    # mingw's gcc brings its runtime compiled; zig would first compile hundreds of files, which takes minutes.
    ways = (
        (["gcc"], ["-ldl"], [], {}),
        ([MINGW], ["-D__USE_MINGW_ANSI_STDIO=1"], [WINE], wine),  # numbers read and printed to the last digit
        ([*find_compiler("zig"), "--target=aarch64-linux-gnu.2.17"], ["-ldl"], foreign, {}),
    )
    for version, source in SOURCES.items():
        for platform, (compiler, options, before, environment) in zip(RUN[version], ways, strict=True):
            program = work / f"host{version}-{platform}{'.exe' if 'win' in platform else ''}"
            checked([*compiler, "-O2", "-s", f"-I{HEADERS}", source, *options, "-o", program])
            made[version, platform] = ([*before, program], environment)
    return made


@pytest.fixture(scope="session")
def of_this_build(hosts, work):
    """Motion by the library of the ordinary build, gcc's, in FMI 2.0"""
    found = {}

    def run(case):
        if case not in found:
            name, values, end, _ = CASES[case]
            folder = work / f"own-{name}"
            if not folder.is_dir():
                unpacked(BUILD / "fmus" / f"{name}.fmu", folder)
            program, _ = hosts[2, "linux64"]
            found[case] = motion(program, library_in(folder, name, "linux64"), folder, values, end)
        return found[case]

    return run
