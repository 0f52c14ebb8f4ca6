"""Where the FMUs are, their contents unpacked, and the scenes that they were built from"""

import atexit
import json
import os
import shutil
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy

from contact_fmus.errors import UserError, similar

# Where the FMUs are, and their contents unpacked

KINDS = {"coSimulation": "co-simulation", "modelExchange": "model exchange"}
VERSIONS = ("2.", "3.")  # of FMI, that fmpy and this package know
FMI3 = "fmi3/"  # before the name of a shipped FMU: its FMI 3.0 build
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


def fmi3_folder() -> Path:
    """build/fmus-fmi3, beside build/fmus"""
    return fmus_folder().with_name(f"{fmus_folder().name}-fmi3")


def shipped_fmus() -> list[str]:
    """Their names; those of FMI 3.0 as fmi3/NAME"""
    names = sorted(file.stem for file in fmus_folder().glob("*.fmu"))
    return names + sorted(f"{FMI3}{file.stem}" for file in fmi3_folder().glob("*.fmu"))


def fmu_file(name: str) -> Path:
    """The shipped FMU of this name, of FMI 2.0, or of FMI 3.0 for fmi3/NAME"""
    folder = fmi3_folder() if name.startswith(FMI3) else fmus_folder()
    path = folder / f"{name.removeprefix(FMI3)}.fmu"
    if not path.is_file():
        known = shipped_fmus()
        if known:
            raise FileNotFoundError(f"{path} does not exist{similar(name, known)}: there are {', '.join(known)}")
        raise FileNotFoundError(
            f"{path} does not exist: build the FMUs first (cmake --preset default && "
            "cmake --build --preset default), or name their folder in CONTACT_FMUS"
        )
    return path


def file_or_shipped(name: str) -> Path:
    """The file of this name, which need not be there; where it is not, the shipped FMU of this name"""
    return fmu_file(name) if not Path(name).exists() and name in shipped_fmus() else Path(name)


def unpack(path: str | os.PathLike, fmi: str = "", kind: str = "coSimulation") -> tuple[Path, Any]:
    """Folder of the unpacked FMU and its description; unpacked once per process

    UserError where it is none of that version of FMI (without one: FMI 2.0 or 3.0), or not of that kind
    (without one: of any)."""
    file = Path(path).resolve()
    about = file.stat()
    key = (file, about.st_mtime_ns, about.st_size)
    if key not in _unpacked:
        folder = Path(tempfile.mkdtemp(prefix=f"{file.stem}-"))
        atexit.register(_remove_if_owner, folder, os.getpid())
        _unpacked[key] = (folder, _extract(path, folder))
    folder, description = _unpacked[key]
    version = description.fmiVersion
    there = not kind or getattr(description, kind) is not None
    if (fmi and version != fmi) or not version.startswith(VERSIONS) or not there:
        offered = [name for one, name in KINDS.items() if getattr(description, one) is not None]
        raise UserError(
            f"{path}: FMI {fmi or '2.0 or 3.0'} {KINDS.get(kind, '')} is needed, this is FMI {version}"
            f" with {' and '.join(offered) or 'neither kind of simulation'}"
        )
    return folder, description


def _extract(path: str | os.PathLike, folder: Path) -> Any:
    """The description of an FMU of any maker; UserError where it is something else"""
    if not zipfile.is_zipfile(path):
        raise UserError(f"{path}: this is no FMU: not a ZIP archive")
    try:
        fmpy.extract(path, folder)
        if not (folder / "modelDescription.xml").is_file():
            raise UserError(f"{path}: this is no FMU: it has no modelDescription.xml")
        return fmpy.read_model_description(folder)
    except (UserError, OSError):
        raise
    except Exception as error:  # fmpy has no class of its own for a bad archive or description
        text = " ".join(str(error).split())
        raise UserError(f"{path}: this is no valid FMU: {text}") from None


def _remove_if_owner(folder: Path, owner: int) -> None:
    """A forked child leaves its parent's files alone."""
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)


# The scene that an FMU was built from: its bodies, their shapes, its contacts and what it pins (docs/fmus.md)

MEMBER = "resources/scene.json"
FORMAT = 1


@dataclass(frozen=True)
class Body:
    name: str
    shape: str  # sphere, cylinder, plane, torus or compound
    parts: tuple = ()  # of a compound: name, radius, center in its frame


@dataclass(frozen=True)
class Contact:
    name: str
    source: str  # name of a body
    destination: str


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    bodies: tuple[Body, ...]
    contacts: tuple[Contact, ...]
    pinned: dict[str, Any]  # by variable; vectors are lists, enumerations item names


def has_scene(fmu: str | os.PathLike) -> bool:
    return (unpack(fmu, kind="")[0] / MEMBER).is_file()


def read_scene(fmu: str | os.PathLike) -> Scene:
    """UserError where the FMU carries none: one of another vendor, or built before FMUs carried theirs"""
    file = unpack(fmu, kind="")[0] / MEMBER
    if not file.is_file():
        raise UserError(f"{fmu}: no {MEMBER} inside, so nothing tells its bodies: build it again")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise UserError(f"{fmu}: {MEMBER} has format {content['format']!r}, known is {FORMAT}")
        return Scene(
            content["name"],
            content["title"],
            tuple(Body(body["name"], body["shape"], tuple(body.get("parts", ()))) for body in content["bodies"]),
            tuple(Contact(one["name"], one["source"], one["destination"]) for one in content["contacts"]),
            dict(content["pinned"]),
        )
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{fmu}: {MEMBER} is not what a viewer can read: {error!r}") from None
