"""Contact FMUs from Python: run them, compare them with theory, measure them, show the results.

Each package says what it holds in its first line; tests/architecture/test_scripts.py has their order, in which one
uses those before it, never the other way round.

`contact-fmus --help` lists the commands.

    from contact_fmus import ContactFmu, fmu_file
"""

import importlib
from typing import Any

# Names of the package itself; their modules are imported when asked for, since fmpy takes half a second.
NAMES = {
    "ContactFmu": "fmu.contact_fmu",
    "FmuError": "fmu.contact_fmu",
    "Result": "results",
    "UserError": "errors",
    "fmu_file": "fmu.files",
    "fmus_folder": "fmu.files",
}
__all__ = list(NAMES)


def __getattr__(name: str) -> Any:
    if name not in NAMES:
        raise AttributeError(f"module 'contact_fmus' has no attribute '{name}'")
    return getattr(importlib.import_module(f"contact_fmus.{NAMES[name]}"), name)
