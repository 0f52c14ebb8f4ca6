"""The benchmark problems, settings to solve them, ratios of run times and instruction counts"""
