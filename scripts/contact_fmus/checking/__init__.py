"""The command check: what is wrong with an FMU file, of this project or of another maker"""
