"""Runs experiments on the contact FMUs and compares them with closed forms.

fmu.py           one FMU instance, by variable names (fmu_files.py, variables.py)
scenario.py      reads a scenario file (scripts/scenarios/*.toml), inputs.py its inputs over time
recording.py     steps an FMU through a scenario and keeps what it saw
closed_forms.py  what theory says
claims.py        what a scenario claims, measured against what is expected (geometry.py recomputes)
runner.py        all of it for a list of scenarios; leave_out.py compares the FMUs' sizes
plots.py, report.py, tables.py   pictures, the HTML page, the terminal
"""
