"""Packs files into an FMU: python pack_fmu.py X.fmu modelDescription.xml=/path documentation=/folder ...

The same files give the same bytes: the description first and then by name, one fixed time, fixed permissions.
A folder is packed with everything below it.
"""

import sys
import zipfile
from pathlib import Path

# The earliest time a ZIP can hold; a real one would make every build differ.
FIXED_TIME = (1980, 1, 1, 0, 0, 0)


def members(arguments):
    """Yields (name inside the FMU, file) for each NAME=PATH argument, folders expanded."""
    for argument in arguments:
        name, _, path = argument.partition("=")
        path = Path(path)
        if path.is_dir():
            for file in sorted(path.rglob("*")):
                if file.is_file():
                    yield f"{name}/{file.relative_to(path).as_posix()}", file
        else:
            yield name, path


def pack(fmu, arguments):
    """Writes the FMU; modelDescription.xml comes first, so that a reader of a stream meets it early."""
    files = dict(members(arguments))
    fmu.parent.mkdir(parents=True, exist_ok=True)
    unfinished = fmu.with_suffix(".unfinished")
    with zipfile.ZipFile(unfinished, "w") as archive:
        for name in sorted(files, key=lambda name: (name != "modelDescription.xml", name)):
            info = zipfile.ZipInfo(name, FIXED_TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # Unix, whatever the machine: the permissions below count
            info.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(info, files[name].read_bytes(), compresslevel=9)
    unfinished.replace(fmu)


if __name__ == "__main__":
    try:
        pack(Path(sys.argv[1]), sys.argv[2:])
    except OSError as error:
        sys.exit(f"pack_fmu: {error}")
