"""FMUs of scenes with several contacts, built for the tests."""

import fcntl
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCENES = ("BallInCorner", "ThreeBalls", "TwoPairs")


def build(folder):
    """Their bits are those of Release, and they are built sooner."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    extra = ";".join(str(ROOT / "tests" / "physics" / "scenes" / f"{name}.toml") for name in SCENES)
    options = [f"-DCONTACT_EXTRA_SCENES={extra}", f"-DPython3_EXECUTABLE={sys.executable}"]
    options += ["-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS_DEBUG=-O1", "-DCONTACT_FMI3=OFF"]
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
    targets = [f"{name}_fmu" for name in SCENES]
    (folder / "fmus").mkdir(parents=True)
    (folder / "fmus" / "Gone.fmu").write_text("of a scene that the build had before")
    for command in ([*configure, *options], ["cmake", "--build", str(folder), "--target", *targets]):
        made = subprocess.run(command, capture_output=True, text=True, env=environment)
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
