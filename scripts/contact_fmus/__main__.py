"""python -m contact_fmus COMMAND [OPTION ...]"""

from __future__ import annotations

import importlib
import sys

# name: (module and function, what it does). Modules are imported when asked for: some take a while.
COMMANDS = {
    "run": ("scenarios.command:run", "run scenarios, check their claims, write plots and index.html"),
    "picture": ("scenarios.command:picture", "draw one scenario"),
    "leave-out": ("scenarios.command:leave_out", "compare the sizes and speeds of the FMUs"),
    "bench": ("bench.command:main", "ratios of run times for developers"),
    "measure": ("report.command:measure", "error against run time: results.csv and summary.json"),
    "force-element": ("coupling.study:main", "the FMU beside an outer integrator: force_element.json"),
    "peers": ("peers.command:main", "other simulators: peers.csv and peers.json"),
    "page": ("report.command:page", "draw the report's page from what is in the folder"),
    "lasting": ("lasting.study:main", "lasting stiff contact by Radau IIA and by this project's method"),
    "stability": ("stability.command:main", "the atlas of stiff and extreme scenes"),
    "mutate": ("mutation.command:main", "break the C code in small ways and list what no test notices"),
    "beyond": ("stability.beyond:main", "random scenes far beyond the atlas"),
}


def usage() -> str:
    """One line for each command"""
    lines = [f"  {name:14} {text}" for name, (_, text) in COMMANDS.items()]
    return "\n".join([__doc__, "", *lines, "", "python -m contact_fmus COMMAND --help: its options"])


def main(arguments: list[str] | None = None) -> int:
    """The command's status; 2 where there is no such command"""
    name, *rest = (sys.argv[1:] if arguments is None else arguments) or [""]
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name not in COMMANDS:
        print(f"unknown command '{name}'\n{usage()}", file=sys.stderr)
        return 2
    module, _, function = COMMANDS[name][0].partition(":")
    return getattr(importlib.import_module(f"contact_fmus.{module}"), function)(rest)


if __name__ == "__main__":
    sys.exit(main())
