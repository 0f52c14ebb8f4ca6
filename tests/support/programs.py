"""Modules of the tests run as programs, each a process of its own"""

import os
import subprocess
import sys

from support.sources import ROOT

# s: on a machine however busy, only a program that hangs takes so long.
PATIENCE = 3600


def python(module, *arguments):
    """The command"""
    return [sys.executable, "-B", "-m", module, *map(str, arguments)]


def environment(**more):
    """This one, with the folders that modules are found in"""
    folders = os.pathsep.join(str(ROOT / name) for name in ("scripts", "tests"))
    return {**os.environ, "PYTHONPATH": folders, **more}


def checked(command, cwd=None, timeout=PATIENCE, status=0, environment=None):
    """What a program says; its status must be `status`, or any where that is None"""
    run = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        timeout=timeout,
        capture_output=True,
        text=True,
        env={**os.environ, **(environment or {})},
        stdin=subprocess.DEVNULL,
    )
    assert status in (None, run.returncode), f"{command}: {run.stdout[-2000:]}{run.stderr[-2000:]}"
    return run.stdout + run.stderr
