"""Writes hertz_references.json: where the scenes of hertz_scenes.py end by the reference of hertz.py.

PYTHONPATH=tests:scripts python -m support.reference.make_hertz_references
"""

import json
from pathlib import Path

from support.reference import hertz
from support.scenes.hertz_scenes import FACTORS, SEEDS, benchmark, pair_of, random_hertz_scene

FILE = Path(__file__).with_name("hertz_references.json")


def entry(values, end):
    """Positions and velocities of both bodies, how many times the regime changes, dissipated energy."""
    state, events = hertz.run(*pair_of(values), end)
    return {"state": [float(x) for x in state[:12]], "events": len(events), "dissipated": float(state[12])}


def main():
    scenes = {name: benchmark(name) for name in FACTORS}
    scenes |= {str(seed): random_hertz_scene(seed) for seed in SEEDS}
    made = {}
    for name, (_, values, end) in scenes.items():
        made[name] = entry(values, end)
        print(name, made[name]["events"], flush=True)
        FILE.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
