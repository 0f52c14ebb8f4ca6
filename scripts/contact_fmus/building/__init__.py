"""FMUs from scene files (build), and scene files to start from (new)"""
