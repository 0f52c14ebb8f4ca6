"""Measures error against run time and writes the report of it (docs/report); scripts/report.sh runs it.

problems.py   what is solved, and the references
host.py       FMUs timed by the C program build/fmu_host
measure.py    the FMU's solvers over tolerances, communication steps and stiffness
rows.py       the rows of results.csv and peers.csv, and what optional parts leave for the page
tables.py, figures.py, machine.py, page.py   tables, pictures, versions, index.html and README.md
force_element.py
              the FMU beside an outer integrator; its parts are force_problems.py, outer_integrators.py,
              driven_contact.py, stable_steps.py, force_element_page.py
lasting.py    Radau IIA against exponential collocation (docs/lasting_contact.md), with radau.py and
              lasting_page.py
bench.py      ratios for developers (scripts/bench.sh), with bench_tables.py and bench_baseline.py
"""
