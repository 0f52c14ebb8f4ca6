"""The layout of a serialized state, written down a second time so that tests can forge one."""

import struct

_HEADER = struct.Struct("<IIII Q dd II")
FIELDS = ("magic", "version", "scene", "checksum", "size", "start_time", "stop_time", "set_up", "phase")
HEADER_SIZE = _HEADER.size
PHASES = {"instantiated": 1, "initialization": 2, "complete": 4, "terminated": 8, "error": 16, "fatal": 32}


def header(blob: bytes) -> dict:
    return dict(zip(FIELDS, _HEADER.unpack_from(blob), strict=True))


def checksum(blob: bytes) -> int:
    """FNV-1a, by words of 32 bits, of everything behind the checksum"""
    value = 2166136261
    for (word,) in struct.iter_unpack("<I", blob[16:]):
        value = ((value ^ word) * 16777619) & 0xFFFFFFFF
    return value


def forge(blob: bytes, **changes) -> bytes:
    """The blob with other header fields and, unless that is one of them, the checksum that fits"""
    fields = header(blob) | changes
    forged = _HEADER.pack(*fields.values()) + blob[HEADER_SIZE:]
    if "checksum" not in changes:
        forged = forged[:12] + struct.pack("<I", checksum(forged)) + forged[16:]
    return forged
