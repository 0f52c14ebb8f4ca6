"""The platforms that one FMU serves, and the joining of their FMUs into one"""

import importlib
import importlib.util
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
# Version 2.0 of the format: folders and deflate. Unix: the permissions below count.
VERSION, UNIX = 20, 3
# A member's head, its entry in the list at the end, and the end: 4.3.7, 4.3.12 and 4.3.16 of PKWARE's
# APPNOTE.TXT
MEMBER, ENTRY, END = "<4s5H3L2H", "<4s6H3L5H2L", "<4s4H2LH"
# zlib's two bytes before and four after what a ZIP wants (RFC 1950)
ZLIB_HEAD, ZLIB_TAIL = 2, 4


def shrink(archive: Path) -> None:
    """Written again where zopfli is installed; otherwise it stays as it is"""
    if importlib.util.find_spec("zopfli") is None:
        return
    with zipfile.ZipFile(archive) as old:
        members = [(info, old.read(info)) for info in old.infolist()]
    body, entries = b"", b""
    for info, content in members:
        head, entry, data = _packed(info, content, len(body))
        body += head + data
        entries += entry
    end = struct.pack(END, b"PK\5\6", 0, 0, len(members), len(members), len(entries), len(body), 0)
    archive.write_bytes(body + entries + end)


def _packed(info: zipfile.ZipInfo, content: bytes, position: int) -> tuple[bytes, bytes, bytes]:
    """Head, entry in the list, and data; the names of an FMU are ASCII, its files far below 4 GB"""
    squeezed = importlib.import_module("zopfli.zlib").compress(content, numiterations=ITERATIONS)
    data = squeezed[ZLIB_HEAD:-ZLIB_TAIL]
    method = zipfile.ZIP_DEFLATED
    if len(data) >= len(content):
        data, method = content, zipfile.ZIP_STORED
    name = info.filename.encode("ascii")
    year, month, day, hour, minute, second = info.date_time
    date, time = (year - 1980) << 9 | month << 5 | day, hour << 11 | minute << 5 | second // 2
    about = (0, method, time, date, zlib.crc32(content), len(data), len(content), len(name), 0)
    head = struct.pack(MEMBER, b"PK\3\4", VERSION, *about) + name
    place = (0, 0, 0, info.external_attr, position)
    return head, struct.pack(ENTRY, b"PK\1\2", UNIX << 8 | VERSION, VERSION, *about, *place) + name, data


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
