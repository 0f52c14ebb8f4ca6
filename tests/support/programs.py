"""Modules of the tests run as programs, each a process of its own"""

import os
import subprocess
import sys

from support.sources import ROOT

# s: on a machine however busy, only a program that hangs takes so long.
PATIENCE = 3600


def python(module, *arguments):
    """Returns the command."""
    return [sys.executable, "-B", "-m", module, *map(str, arguments)]


def environment(**more):
    """This one, with the folders that modules are found in"""
    folders = os.pathsep.join(str(ROOT / name) for name in ("scripts", "tests"))
    return {**os.environ, "PYTHONPATH": folders, **more}


def finished(command, **options):
    """Runs a program to its end, and returns its status and what it said."""
    said = {"capture_output": True, "text": True, "timeout": PATIENCE, "check": False}
    return subprocess.run([str(word) for word in command], **(said | options))


def checked(command, cwd=None, timeout=PATIENCE, status=0, environment=None):
    """Returns what a program says. Its status must be `status`, or any where that is None."""
    whole = {**os.environ, **(environment or {})}
    run = finished(command, cwd=cwd, timeout=timeout, env=whole, stdin=subprocess.DEVNULL)
    assert status in (None, run.returncode), f"{command}: {run.stdout[-2000:]}{run.stderr[-2000:]}"
    return run.stdout + run.stderr
