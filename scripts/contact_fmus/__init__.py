"""Contact FMUs from Python: run them, compare them with theory, measure them, show the results.

A package uses those above it in this list, never the other way round:

errors      expected errors, the command's statuses
fmu         one FMU by the names of its variables; the C program that times FMUs
results     values of a run over time, and their file
pages       what all pages of results share
scenarios   experiments (scripts/scenarios/*.toml) and what they claim
plot        results of any scene over time, as picture or page
animate     results of any scene in three dimensions, as a page
sweep       studies of many runs: parameters, batches on dask, rows as Parquet
bench       benchmark problems, ratios of run times for developers
report      error against run time (docs/report)
peers, coupling
            other simulators; the FMU as a force element
stability   the atlas of stiff and extreme scenes (docs/stability)
building    FMUs from scenes, and scenes to start from
running     an FMU or a scenario through time
checking    what is wrong with an FMU file
whole_report
            all parts of docs/report

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
