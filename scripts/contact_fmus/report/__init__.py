"""Measures error against run time and writes the report of it (docs/report); scripts/report.sh runs it"""
