"""One script for each importer, run by the Python that has it: SCRIPT FMU STEP COUNT SET ... GET ...

GET is NAME=REFERENCE of a Real output, SET is NAME=REFERENCE:=VALUE of an Integer set before the start.

It prints one line of JSON, {"version": ..., "values": {NAME: value}}: Real outputs after COUNT steps of STEP
seconds.
"""
