"""Measures error against run time and writes the report of it (docs/report); scripts/report.sh runs it.

rows.py       the rows of results.csv and peers.csv, and what optional parts leave for the page
measure.py    the FMU's solvers over tolerances, communication steps and stiffness
tables.py, figures.py, page.py   tables, pictures, index.html and README.md
command.py    the commands measure and page
"""
