"""The layout of a serialized state, written again so that tests can forge one, and ways into any state."""

import struct
from ctypes import byref

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, OK

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
    """Returns the blob with other header fields and, unless given, the checksum that fits."""
    fields = header(blob) | changes
    forged = _HEADER.pack(*fields.values()) + blob[HEADER_SIZE:]
    if "checksum" not in changes:
        forged = forged[:12] + struct.pack("<I", checksum(forged)) + forged[16:]
    return forged


NAMES = {"instantiated": "instantiated", "initialization": "initialization mode", "complete": "step mode"}
NAMES |= {"failed": "step mode", "step": "step mode", "event": "event mode"}
NAMES |= {"continuous": "continuous-time mode", "terminated": "terminated", "error": "error"}
NAMES |= {"fatal": "fatal"}


def bring_to(instance: raw.Instance, state: str) -> None:
    """From instantiated to a state of the table; `error` and `fatal`, out of reach else, by a forged state"""
    if state == "failed":
        fail_a_step(instance)
        return
    instance.ok("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    if state == "instantiated":
        return
    instance.ok("EnterInitializationMode")
    if state == "initialization":
        return
    instance.ok("ExitInitializationMode")
    instance.ok("DoStep", 0.0, 0.01, 1)
    if state == "terminated":
        instance.ok("Terminate")
    elif state in ("error", "fatal"):
        status, handle = instance.deserialize(forge(instance.save(), phase=PHASES[state]))
        assert (status, instance.call("SetFMUstate", handle)) == (OK, OK), instance.texts()
        instance.call("FreeFMUstate", byref(handle))


def fail_a_step(instance: raw.Instance) -> None:
    """Makes a step that the solver cannot finish in one internal step: a ball dropped on the other body."""
    drop = {"solver.method": 2, "solver.max_internal_steps": 1}
    if instance.fmu.name not in ("HertzImpact", "TippingRoller"):  # which hit as they start
        drop |= {"source.center[1]": 1.1, "gravity[1]": -9.81}
    instance.initialize({name: value for name, value in drop.items() if name in instance.fmu.variables})
    assert instance.call("DoStep", 0.0, 1.0, 1) == DISCARD, instance.texts()
    del instance.messages[:]
