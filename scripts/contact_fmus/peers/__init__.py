"""The report's problems solved by other simulators, each with its own means, step sizes and tolerances.

case.py       what a peer's module and the runner say to each other
problems.py   the problems in a peer's terms
worker.py     a process for each peer, and the clock
*_peer.py     one module for each peer, which says in what its force law is the same or only similar
run.py        all of them on all problems; command.py writes what they gave
"""
