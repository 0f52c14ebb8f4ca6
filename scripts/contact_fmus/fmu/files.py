"""Where the FMUs are, and their contents unpacked"""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import fmpy

from contact_fmus.errors import UserError, similar

_unpacked: dict[tuple[Path, int, int], tuple[Path, Any]] = {}


PACKAGE = Path(__file__).resolve().parents[1]


def repository() -> Path:
    """This project's tree: the clone around the package, or the copy of it inside an installed package"""
    share = PACKAGE / "share"  # cmake/ContactPackage.cmake fills it
    return share if share.is_dir() else PACKAGE.parents[1]


def is_clone() -> bool:
    """False for an installed package, whose folders are not to be written to"""
    return not (PACKAGE / "share").is_dir()


def results_folder(name: str) -> Path:
    """Where a command writes what it makes: in a clone its own folder, else one in the working directory"""
    return repository() / name if is_clone() else Path("contact-fmus") / name


def fmus_folder() -> Path:
    """build/fmus of this repository, or the folder the environment variable CONTACT_FMUS names"""
    return Path(os.environ.get("CONTACT_FMUS") or repository() / "build" / "fmus")


def fmu_file(name: str) -> Path:
    path = fmus_folder() / f"{name}.fmu"
    if not path.is_file():
        known = sorted(file.stem for file in fmus_folder().glob("*.fmu"))
        if known:
            raise FileNotFoundError(
                f"{path} does not exist{similar(name, known)}: there are {', '.join(known)}"
            )
        raise FileNotFoundError(
            f"{path} does not exist: build the FMUs first (cmake --preset default && "
            "cmake --build --preset default), or name their folder in CONTACT_FMUS"
        )
    return path


def unpack(path: str | os.PathLike, fmi: str = "2.0") -> tuple[Path, Any]:
    """Folder of the unpacked FMU of that version of FMI and its description; unpacked once per process"""
    file = Path(path).resolve()
    about = file.stat()
    key = (file, about.st_mtime_ns, about.st_size)
    if key not in _unpacked:
        folder = Path(tempfile.mkdtemp(prefix=f"{file.stem}-"))
        atexit.register(_remove_if_owner, folder, os.getpid())
        _unpacked[key] = (folder, _extract(path, folder, fmi))
    return _unpacked[key]


def _extract(path: str | os.PathLike, folder: Path, fmi: str) -> Any:
    """The description of a co-simulation FMU, of any maker; UserError where it is something else"""
    if not zipfile.is_zipfile(path):
        raise UserError(f"{path}: this is no FMU: not a ZIP archive")
    try:
        fmpy.extract(path, folder)
        if not (folder / "modelDescription.xml").is_file():
            raise UserError(f"{path}: this is no FMU: it has no modelDescription.xml")
        description = fmpy.read_model_description(folder)
    except (UserError, OSError):
        raise
    except Exception as error:  # fmpy has no class of its own for a bad archive or description
        text = " ".join(str(error).split())
        raise UserError(f"{path}: this is no valid FMU: {text}") from None
    if description.fmiVersion != fmi or description.coSimulation is None:
        kinds = [("co-simulation", description.coSimulation), ("model exchange", description.modelExchange)]
        offered = (
            " and ".join(name for name, kind in kinds if kind is not None) or "neither kind of simulation"
        )
        raise UserError(
            f"{path}: FMI {fmi} co-simulation is needed, this is FMI {description.fmiVersion} with {offered}"
        )
    return description


def _remove_if_owner(folder: Path, owner: int) -> None:
    """A forked child leaves its parent's files alone."""
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)
