"""Modules of the tests run as programs, each a process of its own"""

import os
import sys

from support.sources import ROOT


def python(module, *arguments):
    """The command"""
    return [sys.executable, "-B", "-m", module, *map(str, arguments)]


def environment(**more):
    """This one, with the folders that modules are found in"""
    folders = os.pathsep.join(str(ROOT / name) for name in ("scripts", "tests"))
    return {**os.environ, "PYTHONPATH": folders, **more}
