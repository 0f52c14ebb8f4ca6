"""What an instance and a communication step cost, in instructions: a busy machine has the same"""

import re
from pathlib import Path

import fmpy
import pytest

from contact_fmus.bench.instructions import TUNABLES
from support.portable_host import HEADERS, unpacked
from support.programs import PATIENCE, checked
from support.sources import BUILD

PAIRS = ("SphereSphere", "SphereCylinder", "SpherePlane", "BallOnSphere")
LIVES = 20
STEPS = 500
# 50 us of a processor that makes one instruction in a nanosecond, as those that FMUs run on do at least
MOST_INSTRUCTIONS = 50_000


@pytest.fixture(scope="module")
def cost(tmp_path_factory):
    """Of an FMU and a version: instructions of a life, and of STEPS steps"""
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
            timeout=PATIENCE,
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
        lives = counted("life", [*command, "lives", str(LIVES)])
        return lives / LIVES, counted("step", [*command, "steps", str(STEPS), str(away)])

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
