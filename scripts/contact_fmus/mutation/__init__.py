"""Breaks the C code in small ways and lists what no test notices (scripts/mutate.sh)"""
