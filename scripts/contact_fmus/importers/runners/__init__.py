"""One script for each importer, run by the Python that has it: SCRIPT FMU STEP COUNT NAME=REFERENCE ...

It prints one line of JSON, {"version": ..., "values": {NAME: value}}: Real outputs after COUNT steps of STEP
seconds.
"""
