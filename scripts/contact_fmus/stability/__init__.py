"""The stability atlas: stiff and extreme scenes with every solver, against answers known beforehand"""
