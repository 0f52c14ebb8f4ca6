"""What is asked of a sweep's picture, known to make sense before the first run"""

from __future__ import annotations

from pathlib import Path

from contact_fmus.errors import UserError, similar

from .study import Study

SUFFIXES = (".png", ".svg", ".pdf")


def picture_file(asked: str, folder: Path) -> Path:
    """`asked` may be empty"""
    file = Path(asked) if asked else folder / "plot.png"
    if file.suffix not in SUFFIXES:
        near = similar(file.suffix, SUFFIXES)
        raise UserError(f"--plot {file}: '{file.suffix}' is none of the formats {', '.join(SUFFIXES)}{near}")
    if file.is_dir():
        raise UserError(f"--plot {file}: this is a folder")
    return file


def columns_of(study: Study, x: str | None, y: str | None, color: str | None) -> list[str]:
    """Across, up and, for a map, the colour; UserError where there is no such column"""
    parameters = [column for one in study.parameters for column in one.columns]
    outputs = [one.name for one in study.outputs]
    x = x or parameters[0]
    if color is not None and y is None:
        if len(parameters) < 2:
            raise UserError("--color: a map wants two parameters, and only one varies; say --y")
        y = next(one for one in parameters if one != x)
    names = [x, y or outputs[0], *([color] if color else [])]
    for option, name in zip(("--x", "--y", "--color"), names, strict=False):
        if name not in parameters + outputs + ["run"]:
            allowed = ", ".join(["run", *parameters, *outputs])
            hint = similar(name, parameters + outputs)
            raise UserError(f"{option} {name}: no such column{hint}; {allowed}")
    return names
