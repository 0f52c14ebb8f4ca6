"""The platforms that one FMU serves, and the joining of their FMUs into one"""

from __future__ import annotations

import struct
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from contact_fmus.building.smallest import shrink
from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.files import repository

# Names of FMI 2.0, each with its toolchain files in cmake/platforms. Two processors of macOS share a folder.
PLATFORMS = {
    "linux64": ("x86_64-linux",),
    "win64": ("x86_64-windows",),
    "darwin64": ("x86_64-darwin", "aarch64-darwin"),
    "aarch64-linux": ("aarch64-linux",),
}

# The head of a universal library, as mach-o/fat.h of macOS has it: all numbers big-endian.
FAT_MAGIC = 0xCAFEBABE
FAT_ALIGNMENT = 14  # of the parts, as a power of two: 16 KiB, the pages of Apple's processors


def toolchains(asked: str) -> list[str]:
    """Of "linux64,win64" or "all", without repetition; UserError for a platform that there is not"""
    names = [name.strip() for name in asked.split(",")] if asked != "all" else list(PLATFORMS)
    for name in names:
        if name not in PLATFORMS:
            raise UserError(f"--platforms: there is no '{name}' (allowed: all, {', '.join(PLATFORMS)})")
    return [toolchain for name in dict.fromkeys(names) for toolchain in PLATFORMS[name]]


def join(fmus: list[Path], joined: Path) -> None:
    """One FMU with the binaries of all; the rest, which must not depend on the platform, once"""
    members: dict[str, bytes] = {}
    for fmu in fmus:
        with zipfile.ZipFile(fmu) as archive:
            for name in archive.namelist():
                content = archive.read(name)
                if members.setdefault(name, content) != content:
                    if not name.startswith("binaries/darwin64/"):
                        raise RunFailure(f"{joined.name}: {name} differs from platform to platform")
                    members[name] = universal([members[name], content])
    with tempfile.TemporaryDirectory() as folder:
        for name, content in members.items():
            file = Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        packer = repository() / "cmake" / "pack_fmu.py"
        parts = [f"{path.name}={path}" for path in sorted(Path(folder).iterdir())]
        subprocess.run([sys.executable, "-B", str(packer), str(joined), *parts], check=True)
    shrink(joined)


def universal(libraries: list[bytes]) -> bytes:
    """Mach-O libraries of several processors as one, as `lipo -create` makes it"""
    head = struct.pack(">2I", FAT_MAGIC, len(libraries))
    parts = []
    position = 1 << FAT_ALIGNMENT
    for library in libraries:
        _magic, processor, variant = struct.unpack("<3I", library[:12])
        head += struct.pack(">5I", processor, variant, position, len(library), FAT_ALIGNMENT)
        parts.append((position, library))
        position += len(library) + -len(library) % (1 << FAT_ALIGNMENT)
    for begin, library in parts:
        head = head.ljust(begin, b"\0") + library
    return head
