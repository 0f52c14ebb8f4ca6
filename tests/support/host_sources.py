"""Where the host's sources and the FMI headers are"""

import importlib.util
from pathlib import Path

SOURCES = sorted((Path(__file__).resolve().parents[2] / "scripts" / "tools" / "fmu_host").glob("*.c"))


def fmi_headers():
    return Path(importlib.util.find_spec("fmpy").origin).parent / "c-code"
