"""What references that integrate slowly have found of scenes, in kept_references.json.

A missing scene is computed when a test asks for it, one in sixteen of the others too. To keep new ones:

    CONTACT_KEEP=1 PYTHONPATH=scripts:tests .venv/bin/python -m pytest tests/physics tests/examples
"""

import atexit
import json
import os
from functools import cache
from hashlib import sha256
from pathlib import Path

import numpy as np

FILE = Path(__file__).with_name("kept_references.json")
KEEPING = "CONTACT_KEEP" in os.environ
made = {}


@cache
def stored():
    return {} if KEEPING else json.loads(FILE.read_text(encoding="utf-8"))


def kept(scene, find):
    """Returns what `find` returns: numbers, texts, arrays, lists and dicts. `scene` is all it knows."""
    key = sha256(json.dumps(scene, default=plain, sort_keys=True).encode()).hexdigest()[:20]
    before = stored().get(key)
    if key not in made and (before is None or key.startswith("0")):
        made[key] = json.loads(json.dumps(find(), default=plain))
        assert before is None or alike(made[key], before), f"{FILE.name} has something else of {scene}"
    return with_arrays(made.get(key, before))


def plain(value):
    """For JSON: an array, or a number of numpy"""
    return value.astype(float).tolist() if isinstance(value, np.ndarray) else float(value)


def with_arrays(value):
    if isinstance(value, dict):
        return {name: with_arrays(one) for name, one in value.items()}
    if not isinstance(value, list):
        return value
    items = [with_arrays(one) for one in value]
    numbers = all(isinstance(one, np.ndarray | int | float) for one in items)
    return np.array(items) if numbers and len({np.shape(one) for one in items}) <= 1 else items


def alike(one, other):
    """The same but for what another machine rounds otherwise"""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[name], other[name]) for name in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    return one == other or bool(np.isclose(one, other, rtol=1e-6, atol=1e-9))


@atexit.register
def write():
    if KEEPING and made:
        rows = ",\n".join(f"{json.dumps(key)}: {json.dumps(row)}" for key, row in sorted(made.items()))
        FILE.write_text(f"{{\n{rows}\n}}\n", encoding="utf-8")
