"""Where the FMUs are, and their contents unpacked"""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import fmpy

_unpacked: dict[tuple[Path, int, int], tuple[Path, Any]] = {}


def repository() -> Path:
    return Path(__file__).resolve().parents[3]


def fmus_folder() -> Path:
    """build/fmus of this repository, or the folder the environment variable CONTACT_FMUS names"""
    return Path(os.environ.get("CONTACT_FMUS") or repository() / "build" / "fmus")


def fmu_file(name: str) -> Path:
    path = fmus_folder() / f"{name}.fmu"
    if not path.is_file():
        raise FileNotFoundError(
            f"{path} does not exist: build the FMUs first (cmake --preset default && "
            "cmake --build --preset default), or name their folder in CONTACT_FMUS"
        )
    return path


def unpack(path: str | os.PathLike) -> tuple[Path, Any]:
    """Folder of the unpacked FMU and its model description; unpacked once per process and file version"""
    file = Path(path).resolve()
    about = file.stat()
    key = (file, about.st_mtime_ns, about.st_size)
    if key not in _unpacked:
        folder = Path(tempfile.mkdtemp(prefix=f"{file.stem}-"))
        atexit.register(_remove_if_owner, folder, os.getpid())
        fmpy.extract(file, folder)
        _unpacked[key] = (folder, fmpy.read_model_description(folder))
    return _unpacked[key]


def _remove_if_owner(folder: Path, owner: int) -> None:
    """A forked child leaves its parent's files alone."""
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)
