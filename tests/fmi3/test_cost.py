"""What an instance and a communication step cost, in instructions: a busy machine has the same"""

import re

import pytest

from contact_fmus.bench.instructions import TUNABLES
from support.portable_host import HEADERS, PLATFORM_TESTS, SOURCES, host_arguments, unpacked
from support.programs import PATIENCE, checked
from support.sources import BUILD

PAIRS = ("SphereSphere", "SphereCylinder", "SpherePlane", "BallOnSphere")
STEP, STEPS = 1e-3, 500  # s
AWAY = {"source.center": [1e6, 0.0, 0.0]}  # m: nothing to do in a step
# 50 us of a processor that makes one instruction in a nanosecond, as those that FMUs run on do at least
MOST_INSTRUCTIONS = 50_000
LIFE = {
    2: ("Instantiate", "SetupExperiment", "EnterInitializationMode", "ExitInitializationMode",
        "FreeInstance"),
    3: ("InstantiateCoSimulation", "EnterInitializationMode", "ExitInitializationMode", "FreeInstance"),
}  # fmt: skip


@pytest.fixture(scope="module")
def cost(tmp_path_factory):
    """Of an FMU and a version: instructions of a life, and of STEPS steps"""
    folder = tmp_path_factory.mktemp("cost")
    for version, source in SOURCES.items():
        options = ["-std=c11", "-D_POSIX_C_SOURCE=200809L", "-O1", f"-I{HEADERS}", f"-I{PLATFORM_TESTS}"]
        checked(["gcc", *options, source, "-ldl", "-o", folder / f"host{version}"])

    def counted(functions, command):
        out = folder / "counts"
        options = ["--quiet", "--tool=callgrind", *(f"--toggle-collect={function}" for function in functions)]
        environment = {"GLIBC_TUNABLES": TUNABLES, "LD_BIND_NOW": "1"}  # without finding functions
        watched = ["valgrind", *options, f"--callgrind-out-file={out}", *command]
        checked(watched, timeout=PATIENCE, environment=environment)
        return int(re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)[1])

    def of(name, version):
        fmus = BUILD / ("fmus" if version == 2 else "fmus-fmi3")
        place = unpacked(fmus / f"{name}.fmu", folder / f"{name}{version}")
        (library,) = place.glob("binaries/*/*.so")

        def command(values, steps):
            guid, _, _, *words = host_arguments(place, values, 0.0)
            return [str(folder / f"host{version}"), str(library), guid, str(STEP * steps), str(steps), *words]

        life = [f"fmi{version}{function}" for function in LIFE[version]]
        return counted(life, command({}, 1)), counted([f"fmi{version}DoStep"], command(AWAY, STEPS))

    return of


@pytest.fixture(scope="module", params=PAIRS)
def costs(request, cost):
    """By version of FMI"""
    return {version: cost(request.param, version) for version in (2, 3)}


@pytest.mark.parametrize("version", [2, 3])
def test_an_instance_is_made_initialized_and_freed_in_50_000_instructions(costs, version):
    instructions, _ = costs[version]
    assert 1000 < instructions < MOST_INSTRUCTIONS


def test_a_step_in_flight_by_fmi_3_takes_at_most_1_5_of_one_by_fmi_2(costs):
    assert costs[2][1] > 50 * STEPS
    assert costs[3][1] < 1.5 * costs[2][1]
