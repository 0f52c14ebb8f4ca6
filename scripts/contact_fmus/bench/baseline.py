"""The FMUs of another commit, built in a worktree of its own that is taken away afterwards"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from contact_fmus.fmu.files import repository

FMUS = ("SphereSphere", "SphereCylinder")


@contextmanager
def built(commit: str) -> Iterator[Path]:
    """The folder of the FMUs; RuntimeError with what git, CMake or the compiler said where there are none"""
    with tempfile.TemporaryDirectory(prefix="baseline-") as folder:
        tree = Path(folder) / "tree"
        run("git", "-C", repository(), "worktree", "add", "--detach", tree, commit)
        try:
            run("cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja", *options())
            run("cmake", "--build", tree / "build", "--target", *(f"{name}_fmu" for name in FMUS))
            yield tree / "build" / "fmus"
        finally:
            run("git", "-C", repository(), "worktree", "remove", "--force", tree)


def options() -> list[str]:
    """As the preset "default" builds"""
    values = {"CMAKE_BUILD_TYPE": "Release", "CMAKE_C_COMPILER": "gcc", "BUILD_TESTING": "OFF"}
    values["Python3_EXECUTABLE"] = sys.executable
    return [f"-D{name}={value}" for name, value in values.items()]


def run(*command: object) -> None:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
