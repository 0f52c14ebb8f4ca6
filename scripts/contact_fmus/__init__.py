"""Contact FMUs from Python: run them, compare them with theory, measure them, show the results.

A package uses those above it in this list, never the other way round:

fmu         one FMU by the names of its variables; the C program that times FMUs
pages       what all pages of results share
scenarios   experiments (scripts/scenarios/*.toml) and what they claim
bench       benchmark problems, ratios of run times for developers
report      error against run time (docs/report)
peers, coupling, lasting
            other simulators; the FMU as a force element; lasting contact by two methods
stability   the atlas of stiff and extreme scenes (docs/stability)

`python -m contact_fmus --help` lists the commands.
"""
