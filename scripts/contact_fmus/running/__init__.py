"""The command run: an FMU, by file or name, or a scenario, through time; what it leaves is a Result"""
