"""The machine and the versions a report was made with; nothing that names a host, a user or a folder"""

from __future__ import annotations

import os
import platform
import re
import subprocess
from importlib import metadata
from pathlib import Path

from contact_fmus.fmu.files import repository
from contact_fmus.fmu.host import host_file

PACKAGES = ("fmpy", "numpy", "scipy", "matplotlib")


def versions() -> dict[str, str]:
    cache = _cmake_cache(host_file().parent / "CMakeCache.txt")
    build = cache.get("CMAKE_BUILD_TYPE", "")
    found = {
        "processor": f"{_processor()}, {os.cpu_count()} cores, {platform.machine()}",
        "system": _system(),
        "compiler": f"{_first_line(cache.get('CMAKE_C_COMPILER', 'cc'), '--version')}, {build}",
        "SUNDIALS": _sundials(cache),
        "FMUs": _project(),
        "Python": platform.python_version(),
    }
    return found | {name: metadata.version(name) for name in PACKAGES}


def _processor() -> str:
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    match = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return match[1].strip() if match else "unknown processor"


def _system() -> str:
    release = platform.freedesktop_os_release()
    return release.get("PRETTY_NAME", platform.system())


def _first_line(*command: str) -> str:
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    return run.stdout.partition("\n")[0].strip() or Path(command[0]).name


def _cmake_cache(file: Path) -> dict[str, str]:
    if not file.is_file():  # an installed package has programs without their build
        return {}
    lines = file.read_text(encoding="utf-8").splitlines()
    return {match[1]: match[2] for line in lines if (match := re.match(r"([\w-]+):\w+=(.*)", line))}


def _sundials(cache: dict[str, str]) -> str:
    """The installed one says its version in its CMake package; else the build has fetched one."""
    file = Path(cache.get("SUNDIALS_DIR", "")) / "SUNDIALSConfigVersion.cmake"
    if cache.get("CONTACT_SUNDIALS_FIT") == "TRUE" or file.is_file():
        match = re.search(r'PACKAGE_VERSION "([\d.]+)"', file.read_text(encoding="utf-8"))
        if match:
            return match[1]
    text = (repository() / "cmake" / "ContactSundials.cmake").read_text(encoding="utf-8")
    match = re.search(r"# v([\d.]+)", text)
    return f"{match[1]}, built with the FMUs" if match else "unknown"


def _project() -> str:
    text = (repository() / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"project\(\w+ VERSION ([\d.]+)", text)
    return match[1] if match else "unknown"
