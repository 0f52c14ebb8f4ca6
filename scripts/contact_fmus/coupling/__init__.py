"""The FMU as a force element beside an outer integrator: error against communication step, the stable step"""
