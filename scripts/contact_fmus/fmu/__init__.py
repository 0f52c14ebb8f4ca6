"""One FMU by the names of its variables (contact_fmu.py), and FMUs timed by a C program (host.py)"""
