"""Results of any scene over time: recorded densely around contacts, drawn as picture or page.

experiment.py   what is to be run: an FMU with settings, or a scenario
record.py       runs it, with more points around each contact
contacts.py     when bodies touched, from a result
source.py       what a user names (result, FMU, scenario) made a run
panels.py       which variables are drawn together; picture.py: as a picture; page.py, payload.py: as a page
figures.py      a result drawn in one call; command.py: the command plot
"""
