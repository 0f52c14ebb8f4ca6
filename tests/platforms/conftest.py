"""What the checks of a release share: hosts for each platform, unpacked FMUs, the motion of this build"""

import pytest

from contact_fmus.building.compiler import find_compiler
from support.portable_host import HEADERS, SOURCE, motion, unpacked
from support.programs import checked
from support.release import CASES, MINGW, QUIET_WINE, WINE, fmu_of, library_in
from support.sources import BUILD


@pytest.fixture(scope="session")
def work(tmp_path_factory):
    return tmp_path_factory.mktemp("release")


@pytest.fixture(scope="session")
def release(work):
    return lambda name: work / name if (work / name).is_dir() else unpacked(fmu_of(name), work / name)


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
