"""Runs experiments on the contact FMUs and compares them with closed forms.

experiment.py    what a scenario is, and what a run of it leaves (inputs.py: its inputs over time)
closed_forms.py  what theory says
claims.py        what a scenario claims, measured against what is expected (geometry.py recomputes)
turning_claims.py  the same of bodies that turn; turning_forms.py has their closed forms
motion.py        where the bodies of any scene are, for pictures and animations
scenario.py      reads a scenario file (scripts/scenarios/*.toml)
recording.py     steps an FMU through a scenario
runner.py        all of it for a list of scenarios; leave_out.py compares the FMUs' sizes
plots.py, page.py, tables.py   pictures, the HTML page, the terminal
command.py       the commands run, picture and leave-out
"""
