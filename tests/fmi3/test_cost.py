"""What an instance and a communication step cost, in instructions and in time of the processor, which do not
know how busy the machine is. No time of a clock on the wall is taken."""

import re
from pathlib import Path

import fmpy
import pytest

from contact_fmus.bench.instructions import TUNABLES
from support.portable_host import HEADERS, unpacked
from support.programs import checked
from support.sources import BUILD

PAIRS = ("SphereSphere", "SphereCylinder", "SpherePlane", "BallOnSphere")
LIVES = 20  # batches of cost_host.c
STEPS = 500
# Processors that FMUs run on make at least one instruction in a nanosecond.
LONGEST_LIFE = 50e-6  # s
MOST_INSTRUCTIONS = 50_000


@pytest.fixture(scope="module")
def cost(tmp_path_factory):
    """Of an FMU and a version: CPU time of a life [s], its instructions, instructions of STEPS steps"""
    folder = tmp_path_factory.mktemp("cost")
    host = folder / "cost_host"
    options = ["-std=c11", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror", "-O1", f"-I{HEADERS}"]
    checked(["gcc", *options, Path(__file__).with_name("cost_host.c"), "-ldl", "-o", host])

    def counted(function, command):
        out = folder / "counts"
        options = ["--quiet", "--tool=callgrind", f"--toggle-collect={function}"]
        environment = {"GLIBC_TUNABLES": TUNABLES}
        checked(
            ["valgrind", *options, f"--callgrind-out-file={out}", *command],
            timeout=60,
            environment=environment,
        )
        return int(re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)[1])

    def of(name, version):
        place = folder / f"{name}{version}"
        if not place.exists():
            unpacked(BUILD / ("fmus" if version == 2 else "fmus-fmi3") / f"{name}.fmu", place)
        about = fmpy.read_model_description(str(place))
        (library,) = place.glob("binaries/*/*.so")
        centre = "source.center[1]" if version == 2 else "source.center"
        (away,) = [v.valueReference for v in about.modelVariables if v.name == centre]
        resources = (place / "resources").as_uri() if version == 2 else f"{place / 'resources'}/"
        token = about.guid if version == 2 else about.instantiationToken
        command = [str(host), str(library), token, resources, str(version)]
        seconds = float(checked([*command, "lives", "200"]))
        lives = counted("life", [*command, "lives", "1"])
        return seconds, lives / LIVES, counted("step", [*command, "steps", str(STEPS), str(away)])

    return of


@pytest.fixture(scope="module", params=PAIRS)
def costs(request, cost):
    """By version of FMI"""
    return {version: cost(request.param, version) for version in (2, 3)}


@pytest.mark.parametrize("version", [2, 3])
def test_an_instance_is_made_initialized_and_freed_in_50_microseconds(costs, version):
    seconds, instructions, _ = costs[version]
    assert 0.0 < seconds < LONGEST_LIFE
    assert 1000 < instructions < MOST_INSTRUCTIONS


def test_a_step_in_flight_by_fmi_3_takes_at_most_1_5_of_one_by_fmi_2(costs):
    assert costs[2][2] > 50 * STEPS
    assert costs[3][2] < 1.5 * costs[2][2]
