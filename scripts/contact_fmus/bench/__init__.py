"""The benchmark problems and what developers compare (scripts/bench.sh)"""
