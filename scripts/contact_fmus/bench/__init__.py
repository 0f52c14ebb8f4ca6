"""The benchmark problems and what developers compare (scripts/bench.sh).

problems.py   what is solved, and the references
settings.py   method, tolerance and communication steps
ratios.py     run times of two cases that take turns; best.py: CVODE's best against event_driven's
instructions.py
              instruction counts and their bounds
baseline.py   the FMUs of another commit; tables.py: the terminal; command.py: the command bench
"""
