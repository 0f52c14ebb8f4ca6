"""The release FMUs of scripts/package.sh, and what is run of them: tests/platforms/check_*.py"""

import os
from pathlib import Path

from support.scenes.benchmarks import BENCHMARKS
from support.sources import BUILD, SCENES

RELEASE = Path(os.environ.get("CONTACT_RELEASE", BUILD / "release"))
# (scene, start values, end, largest difference from Linux, relative above 1): all benchmarks, and all
# scenes as they start. The bounds hold what the last digits of another libm become (docs/platforms.md).
CASES = {name: (case.fmu, case.configuration, case.end, 1e-9) for name, case in BENCHMARKS.items()}
CASES |= {name: (name, {}, 2.0, 1e-9) for name in SCENES}
METHODS = ("cvode_bdf", "cvode_adams")
CVODE = {f"P2 {method}": {**BENCHMARKS["P2"].configuration, "solver.method": method} for method in METHODS}
CASES |= {name: ("SphereSphere", values, 1.5, 1e-9) for name, values in CVODE.items()}
LIBRARIES = {"linux64": "so", "win64": "dll", "aarch64-linux": "so", "darwin64": "dylib"}
QUIET_WINE = {"DISPLAY": "", "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
# Where Debian has it; it is on no path.
WINE = Path("/usr/lib/wine/wine64")
MINGW = "x86_64-w64-mingw32-gcc"


def fmu_of(name):
    return RELEASE / "fmus" / f"{name}.fmu"


def library_in(folder, name, platform):
    return folder / "binaries" / platform / f"{name}.{LIBRARIES[platform]}"
