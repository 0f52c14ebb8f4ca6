"""Measures error against run time and writes the report of it (docs/report).

host.py   FMUs timed by the C program build/fmu_host
"""
