"""The command fuzz: fuzzers look for calls, saved states and scene files that break a claim"""
