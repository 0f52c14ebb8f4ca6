"""A result drawn in one call, as `contact-fmus run --plot` does"""

from __future__ import annotations

from pathlib import Path

from contact_fmus.errors import UserError, similar
from contact_fmus.fmu.scene import has_scene, read_scene
from contact_fmus.results import Result

from . import page, picture
from .panels import usual
from .source import Run

SUFFIXES = (*picture.SUFFIXES, ".html")


def draw(result: Result, file: str | Path) -> None:
    """Gaps, forces, positions and energies over time; what it is, the file's name says"""
    output = checked(Path(file))
    write = page.write_page if output.suffix == ".html" else picture.draw
    title = _title(result, output)
    write(title, [Run(title, "", result)], usual(result), output)


def checked(output: Path) -> Path:
    """UserError where the file's name is none that can be written"""
    if output.suffix not in SUFFIXES:
        near = similar(output.suffix, SUFFIXES)
        raise UserError(f"{output}: '{output.suffix}' is none of the formats {', '.join(SUFFIXES)}{near}")
    if output.is_dir():
        raise UserError(f"{output}: this is a folder")
    return output


def _title(result: Result, output: Path) -> str:
    if result.fmu is None:
        return output.stem
    fmu = Path(result.fmu)
    return read_scene(fmu).title if fmu.is_file() and has_scene(fmu) else fmu.stem
