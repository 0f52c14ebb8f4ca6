"""Writes bench/law_references.json: where the source of each problem of bench/problems.py's law_benchmarks is
at the end, by the reference of hertz.py.

PYTHONPATH=tests:scripts python -m support.reference.make_law_references [NAME ...]

Without names all of them; five minutes."""

import json
import sys

import numpy as np

from contact_fmus.bench.problems import LAW_REFERENCES, law_benchmarks
from support.reference import hertz

# Sliding on the cap and over the rim: finer steps would follow the rounding of positions, and be too many.
COARSER = dict.fromkeys(("P3 rim", "P3b rim"), np.longdouble("1e-14"))


def main(names):
    made = json.loads(LAW_REFERENCES.read_text(encoding="utf-8"))
    for name in names or law_benchmarks():
        problem = law_benchmarks()[name]
        coarser = COARSER.get(name, hertz.TOLERANCE)
        state, events = hertz.follow(problem.fmu, problem.start, problem.stop, coarser)
        made[name] = [float(x) for x in state[:3]]
        print(name, len(events), made[name], flush=True)
    ordered = {name: made[name] for name in law_benchmarks()}
    LAW_REFERENCES.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
