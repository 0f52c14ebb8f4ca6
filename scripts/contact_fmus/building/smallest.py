"""The same ZIP in fewer bytes, still "deflate", which every importer reads

zopfli looks longer for a short form. An FMU with five libraries becomes a twentieth smaller; it takes ten
seconds, so that no other FMU goes through it.
"""

from __future__ import annotations

import importlib
import importlib.util
import struct
import zipfile
import zlib
from pathlib import Path

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
