"""Shared by all Python tests: FMUs opened once a session and reset for each use, FMUs of scenes with several
contacts."""

import contextlib
import fcntl
import os
import sys
from pathlib import Path

import lark
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file
from support.checks import DASHPOTS, FMU, METHODS
from support.programs import finished

ROOT = Path(__file__).resolve().parents[1]
SCENES = ("BallInCorner", "Chain", "Islands", "ThreeBalls", "TripodReversed", "TwoBars", "TwoPairs")


@pytest.fixture(scope="session")
def fmu_path():
    return fmu_file


# A test that takes one of these runs with each, unless it says which.
@pytest.fixture(params=METHODS)
def method(request):
    return request.param


@pytest.fixture(params=DASHPOTS)
def dashpot(request):
    return request.param


@pytest.fixture(params=FMU)
def shape(request):
    return request.param


@contextlib.contextmanager
def instances(path_of):
    """FMU by name, one instance each; `run` and `start` of support/checks.py reset it."""
    made = {}
    with contextlib.ExitStack() as stack:

        def get(name):
            if name not in made:
                made[name] = stack.enter_context(ContactFmu(path_of(name), instance_name=name))
            return made[name]

        yield get


@pytest.fixture(scope="session")
def opened(fmu_path):
    with instances(fmu_path) as get:
        yield get


@pytest.fixture(scope="session")
def opened_several(built):
    """As `opened`, of the FMUs of tests/physics/scenes."""
    with instances(built.get) as get:
        yield get


@pytest.fixture(scope="session")
def names_parsed_once():
    """fmpy parses the names of variables slowly, and FMUs have the same ones."""
    parse, known = lark.Lark.parse, {}

    def parsed(self, text, *more, **options):
        if text not in known:
            known[text] = parse(self, text, *more, **options)
        return known[text]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lark.Lark, "parse", parsed)
        yield


def build(folder):
    """Their bits are those of Release, and they are built sooner."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    scenes = ";".join(str(ROOT / "tests" / "physics" / "scenes" / f"{name}.toml") for name in SCENES)
    options = [f"-DCONTACT_SCENES={scenes}", f"-DPython3_EXECUTABLE={sys.executable}"]
    options += ["-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS_DEBUG=-O1", "-DCONTACT_FMI3=OFF"]
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
    for command in ([*configure, *options], ["cmake", "--build", str(folder)]):
        made = finished(command, env=environment)
        assert made.returncode == 0, made.stdout + made.stderr


@pytest.fixture(scope="session")
def built(tmp_path_factory, worker_id):
    """The FMUs of SCENES, by name, built once by whichever process needs them first."""
    folder = tmp_path_factory.getbasetemp()
    folder = (folder if worker_id == "master" else folder.parent) / "scenes"
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.exists():
            build(folder)
    return {name: folder / "fmus" / f"{name}.fmu" for name in SCENES}
