"""Checks that only read the file: archive, description, and the kind of every binary"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fmpy.validation import validate_fmu

WHAT = {
    "archive": "names and checksums in the ZIP archive",
    "description": "XML schema, names, model structure, start values, units (fmpy)",
    "binaries": "a library of the described name and kind for each platform",
    "exports": "the standard's functions in this platform's library",
    "run": "a short run by Co-Simulation: finite numbers, no error",
    "exchange": "a short run by Model Exchange: finite numbers, no error",
    "state": "a state that is saved and restored: outputs as they were",
}
# Where FMI keeps the binaries of a platform (2.0.5 section 2.3, 3.0.2 section 2.5.1.4.1), the ending of their
# names, and how such a file begins: ELF says its machine in bytes 18 and 19, a PE file is told by MZ alone.
PLATFORMS = {
    "linux64": (".so", b"\x7fELF", b"\x3e\x00"),
    "linux32": (".so", b"\x7fELF", b"\x03\x00"),
    "aarch64-linux": (".so", b"\x7fELF", b"\xb7\x00"),
    "x86_64-linux": (".so", b"\x7fELF", b"\x3e\x00"),
    "x86-linux": (".so", b"\x7fELF", b"\x03\x00"),
    "win64": (".dll", b"MZ", b""),
    "win32": (".dll", b"MZ", b""),
    "x86_64-windows": (".dll", b"MZ", b""),
    "x86-windows": (".dll", b"MZ", b""),
    "darwin64": (".dylib", b"", b""),  # Mach-O, thin or universal: several beginnings
    "x86_64-darwin": (".dylib", b"", b""),
    "aarch64-darwin": (".dylib", b"", b""),
}
MACH_O = (b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe", b"\xca\xfe\xba\xbf")


def archive(file: Path) -> Iterator[str]:
    """Damaged members, names that other systems cannot read, names that would leave the folder"""
    with zipfile.ZipFile(file) as members:
        damaged = members.testzip()
        if damaged is not None:
            yield f"{damaged} is damaged: its checksum does not agree"
        for member in members.infolist():
            if "\\" in member.orig_filename:
                yield f"{member.orig_filename}: a backslash in a name; FMI wants forward slashes"
            if member.filename.startswith("/") or ".." in member.filename.split("/"):
                yield f"{member.filename}: a name that leaves the FMU's folder"
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                yield f"{member.filename}: packed by a method that FMI does not allow, only store and deflate"


def description(file: Path) -> Iterator[str]:
    """fmpy's validation: XML schema, names, model structure, start values, causality, units"""
    for problem in validate_fmu(str(file)):
        yield " ".join(problem.split())


def binaries(folder: Path, about: Any) -> Iterator[str]:
    """Each platform's binaries: one of the described name, and of the platform's kind"""
    kinds = (about.coSimulation, about.modelExchange, getattr(about, "scheduledExecution", None))
    identifiers = {kind.modelIdentifier for kind in kinds if kind is not None}
    found = sorted(path for path in (folder / "binaries").glob("*") if path.is_dir())
    if not found and not (folder / "sources").is_dir():
        yield "there are neither binaries nor sources"
    for platform in found:
        if platform.name not in PLATFORMS:
            continue  # a platform that this list does not know is no fault
        for identifier in sorted(identifiers):
            yield from _binary(platform, identifier)


def _binary(platform: Path, identifier: str) -> Iterator[str]:
    ending, begin, machine = PLATFORMS[platform.name]
    library = platform / f"{identifier}{ending}"
    name = f"binaries/{platform.name}/{library.name}"
    if not library.is_file():
        yield f"{name} is missing: the description says modelIdentifier {identifier}"
        return
    head = library.read_bytes()[:20]
    if ending == ".dylib":
        fits = head.startswith(MACH_O)
    else:
        fits = head.startswith(begin) and head[18:20].startswith(machine)
    if not fits:
        yield f"{name} is no library for {platform.name}: it begins with {head[:4].hex(' ')}"
