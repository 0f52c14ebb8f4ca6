"""The platforms that one FMU serves, and the joining of their FMUs into one"""

import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib
from pathlib import Path

from contact_fmus.errors import RunFailure, UserError
from contact_fmus.fmu.files import repository

# Packs a ZIP again in fewer bytes, by "deflate" as before, which every importer reads
#
# zopfli looks longer for a short form. An FMU with five libraries becomes a twentieth smaller; it takes ten
# seconds, so that no other FMU goes through it.

# More rounds than these five saved a ten-thousandth of PinnedEvent.
ITERATIONS = 5
# zlib's two bytes before and four after what a ZIP wants (RFC 1950)
ZLIB_FRAME = 6


def shrink(archive: Path) -> None:
    """Written again where zopflipy is installed; otherwise it stays as it is"""
    try:
        from zopfli import ZipFile
    except ImportError:
        return
    with zipfile.ZipFile(archive) as old:
        members = [(info, old.read(info)) for info in old.infolist()]
    with ZipFile(archive, "w", zipfile.ZIP_DEFLATED, iterations=ITERATIONS) as new:
        for info, content in members:
            shorter = len(zlib.compress(content)) - ZLIB_FRAME < len(content)
            info.compress_type = zipfile.ZIP_DEFLATED if shorter else zipfile.ZIP_STORED
            with new.open(info, "w") as member:
                member.write(content)


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
    """The toolchains of "linux64,win64" or "all", each once; UserError for an unknown platform"""
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
    page, head, body = 1 << FAT_ALIGNMENT, struct.pack(">2I", FAT_MAGIC, len(libraries)), b""
    for library in libraries:
        body = body.ljust(-(-len(body) // page) * page, b"\0")
        processor = struct.unpack("<2I", library[4:12])  # and its variant, behind the magic number
        head += struct.pack(">5I", *processor, page + len(body), len(library), FAT_ALIGNMENT)
        body += library
    return head.ljust(page, b"\0") + body
