#!/usr/bin/env python3
"""Writes value_references.txt: every value reference of every scene, which no later version may change.

    PYTHONPATH=tests python -m support.generator.freeze_references

It adds references of new variables and scenes, and refuses to change or drop a line, on which users rely."""

import re
import sys
from pathlib import Path

from support.generator.generated import SCENES, describe

FROZEN = Path(__file__).resolve().with_name("value_references.txt")


def read_frozen() -> dict[tuple[str, str], int]:
    """(scene, variable) -> value reference."""
    frozen = {}
    for line in FROZEN.read_text(encoding="utf-8").splitlines():
        scene, name, reference = line.split()
        frozen[scene, name] = int(reference)
    return frozen


def current() -> dict[tuple[str, str], int]:
    return {
        (scene, name): entry["reference"]
        for scene in SCENES
        for name, entry in describe(scene).items()
        if not re.match(r"\w+\[([3-9]|\d\d+)\]\.", name)  # a count changes no reference: two of each tell
    }


def main() -> int:
    old, new = read_frozen() if FROZEN.exists() else {}, current()
    for key, reference in old.items():
        if new.get(key) != reference:
            print(f"{key[0]} {key[1]}: {reference} is frozen, now {new.get(key)}", file=sys.stderr)
            return 1
    lines = sorted(f"{scene} {name} {reference}\n" for (scene, name), reference in new.items())
    FROZEN.write_text("".join(lines), encoding="utf-8")
    print(f"{len(new) - len(old)} added, {len(new)} in all")
    return 0


if __name__ == "__main__":
    sys.exit(main())
