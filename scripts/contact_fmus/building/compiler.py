"""Finds a C compiler that works: the one asked for, that of the variable CC, or a usual one"""

from __future__ import annotations

import importlib.util
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from contact_fmus.errors import UserError

USUAL = ("gcc", "clang", "cc", "zig")
# What an FMU needs of a compiler: the C library's headers, which Debian's gcc does not bring.
TRIAL = "#include <math.h>\n#include <string.h>\ndouble half(double x) { return fabs(x) / 2.0; }\n"
ADVICE = "apt-get install gcc libc6-dev, or take zig's from PyPI: pip install 'contact-fmus[zig]'"


def find_compiler(asked: str | None) -> list[str]:
    """Program and fixed arguments, such as [".../ziglang/zig", "cc"]; UserError where none works"""
    tried = []
    for name in _names(asked):
        command = _command(name)
        if command is None:
            tried.append(f"{name}: not found")
            continue
        complaint = _complaint(command)
        if complaint is None:
            return command
        tried.append(f"{name}: {complaint}")
    raise UserError(f"no C compiler that works ({'; '.join(tried)}): {ADVICE}")


def _names(asked: str | None) -> Iterator[str]:
    chosen = asked or os.environ.get("CC")
    if chosen:
        yield chosen
    else:
        yield from USUAL


def _command(name: str) -> list[str] | None:
    if name == "zig":
        program = _zig()
        return [program, "cc"] if program else None
    program, *arguments = shlex.split(name)
    found = shutil.which(program)
    return [found, *arguments] if found else None


def _zig() -> str | None:
    """That of the Python package ziglang, else one on the path"""
    package = importlib.util.find_spec("ziglang")
    if package is not None and package.origin is not None:
        return str(Path(package.origin).parent / "zig")
    return shutil.which("zig")


def _complaint(command: list[str]) -> str | None:
    """The compiler's first error for a small file, None where it compiles"""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "trial.c"
        file.write_text(TRIAL, encoding="utf-8")
        run = subprocess.run(
            [*command, "-c", str(file), "-o", str(file.with_suffix(".o"))],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    if run.returncode == 0:
        return None
    lines = [line.partition("error: ")[2] for line in run.stderr.splitlines() if "error: " in line]
    return lines[0] if lines else f"ends with status {run.returncode}"
