"""The report's problems solved by other simulators, each with its own means, step sizes and tolerances"""
