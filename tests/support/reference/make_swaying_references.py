"""Writes swaying_references.json, the true motions that test_approach_only.py compares with:

PYTHONPATH=tests .venv/bin/python -m support.reference.make_swaying_references     (some minutes on two cores)
"""

import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from support.reference.swaying_load import integrate, random_scene

FILE = Path(__file__).with_name("swaying_references.json")
SCENES = 36


def end_of(scene):
    """In a hollow about two swings; on top of a solid body until the ball may have left it"""
    return 1.5 if scene.inside else 0.5


def row(seed):
    scene = random_scene(seed)
    motion = integrate(scene, end_of(scene))
    return {
        "seed": seed,
        "events": motion.events,
        "onsets": motion.onsets,
        "position": [float(x) for x in motion.position],
    }


def main():
    with ProcessPoolExecutor() as pool:
        rows = list(pool.map(row, range(SCENES)))
    lines = ",\n".join("  " + json.dumps(one) for one in rows)
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
