"""The wheel of this build, installed into an environment of its own, far from the clone"""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from contact_fmus.__main__ import main
from support.programs import PATIENCE, finished
from support.sources import BUILD, ROOT


@pytest.fixture(scope="session")
def far_from_clone(quick_compiler):
    """The environment without what points to the clone"""
    dropped = ("PYTHONPATH", "CONTACT_BUILD", "CONTACT_FMUS")
    return {name: value for name, value in os.environ.items() if name not in dropped} | {"CC": quick_compiler}


@pytest.fixture(scope="session")
def wheel(far_from_clone, tmp_path_factory):
    """Built without network and without compiling: the FMUs are those of the build under test"""
    folder = tmp_path_factory.mktemp("wheel")
    options = [f"cmake.define.CONTACT_PREBUILT={BUILD}", f"build-dir={folder / 'build'}"]
    settings = [part for option in options for part in ("--config-setting", option)]
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder]
    run = finished([*command, *settings, ROOT], env=far_from_clone)
    assert run.returncode == 0, run.stdout + run.stderr
    (file,) = folder.glob("*.whl")
    return file


@pytest.fixture(scope="session")
def installed(wheel, far_from_clone, tmp_path_factory):
    """Folder of the programs of an environment with the wheel; what it depends on is that of .venv"""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    python = folder / "bin" / "python"
    site = Path(sysconfig.get_path("purelib", vars={"base": str(folder), "platbase": str(folder)}))
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    subprocess.run([*install, "--no-deps", "--no-index", wheel], check=True, env=far_from_clone)
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return folder / "bin"


@pytest.fixture
def ask(tmp_path, monkeypatch, capsys):
    """The command in this process, in an empty folder: its status, stderr and stdout"""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        try:
            status = main([str(one) for one in arguments])
        except SystemExit as ended:  # argparse
            status = ended.code
        told = capsys.readouterr()
        return status, told.err, told.out

    return call


@pytest.fixture
def command(installed, far_from_clone, tmp_path):
    """contact-fmus as a user calls it, in an empty folder"""

    def call(*arguments, cwd=tmp_path, timeout=PATIENCE, **variables):
        run = finished(
            [installed / "contact-fmus", *map(str, arguments)],
            cwd=cwd,
            timeout=timeout,
            stdin=subprocess.DEVNULL,
            env=far_from_clone | variables,
        )
        assert "Traceback" not in run.stderr, run.stderr
        return run

    return call
