"""The release FMUs of scripts/package.sh, and what is run of them: tests/platforms/check_*.py"""

import os
from pathlib import Path

from support.fmi2.raw import ALL
from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD

RELEASE = Path(os.environ.get("CONTACT_RELEASE", BUILD / "release"))
# The scenes whose FMUs are looked at: all, or those of the files named in CONTACT_CHECKED
NAMED = {Path(file).stem for file in os.environ.get("CONTACT_CHECKED", "").split()}
CHECKED = [name for name in ALL if not NAMED or name in NAMED]
# (scene, start values, end, largest difference from Linux, relative above 1): all benchmarks, and all
# scenes as they start. The bounds hold what the last digits of another libm become (docs/platforms.md).
CASES = {name: (case.fmu, case.configuration, case.end, 1e-9) for name, case in BENCHMARKS.items()}
CASES |= {name: (name, {}, 2.0, 1e-9) for name in ALL}
# Last digits change the lengths of steps, and the force has an error of 2e-6 at the default tolerance.
CASES["PinJoint"] = ("PinJoint", {}, 2.0, 1e-5)
METHODS = ("cvode_bdf", "cvode_adams")
CVODE = {f"P2 {method}": {**BENCHMARKS["P2"].configuration, "solver.method": method} for method in METHODS}
CASES |= {name: ("SphereSphere", values, 1.5, 1e-9) for name, values in CVODE.items()}
# A force element stands still from its start values on: here its bodies move, turn and rub in every step.
DRIVEN = {"source.prescribed_displacement": [0.0, 0.0, 0.1], "source.prescribed_velocity": [-0.01, 0.3, 0.2]}
DRIVEN |= {"source.prescribed_angular_velocity": [2.0, -3.0, 1.0]}
DRIVEN |= {"destination.prescribed_angular_velocity": [0.5, 0.4, -0.3]}
DRIVEN |= {"destination.prescribed_axis": [0.01, 0.02, 1.0]}
for friction in ("regularized", "elastic"):
    values = {**DRIVEN, "contact.friction": friction}
    CASES[f"TurningForceElement {friction}"] = ("TurningForceElement", values, 2.0, 1e-9)


def cases_of(scenes):
    return {label: case for label, case in CASES.items() if case[0] in scenes}


def few_cases_of(scenes):
    """For what takes long: the benchmarks, or where the scenes have none all that needs no CVODE"""
    cases = cases_of(scenes)
    return [case for case in cases if case in BENCHMARKS] or [case for case in cases if case not in CVODE]


CHECKED_CASES = cases_of(CHECKED)
FEW_CASES = few_cases_of(CHECKED)
# How the library in each platform's folder ends. FMI 2.0 has one folder for both processors of macOS.
ENDINGS = {"linux64": "so", "win64": "dll", "aarch64-linux": "so", "darwin64": "dylib"}
ENDINGS3 = {"x86_64-linux": "so", "x86_64-windows": "dll", "aarch64-linux": "so", "x86_64-darwin": "dylib"}
ENDINGS3 |= {"aarch64-darwin": "dylib"}
LIBRARIES = {2: ENDINGS, 3: ENDINGS3}
FOLDERS = {2: "fmus", 3: "fmus-fmi3"}
# Platforms that something here runs
RUN = {2: ("linux64", "win64", "aarch64-linux"), 3: ("x86_64-linux", "x86_64-windows", "aarch64-linux")}
QUIET_WINE = {"DISPLAY": "", "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
# Where Debian has it; it is on no path.
WINE = Path("/usr/lib/wine/wine64")
MINGW = "x86_64-w64-mingw32-gcc"


def fmu_of(name, version=2):
    return RELEASE / FOLDERS[version] / f"{name}.fmu"


def library_in(folder, name, platform):
    ending = (ENDINGS | ENDINGS3)[platform]
    return folder / "binaries" / platform / f"{name}.{ending}"
