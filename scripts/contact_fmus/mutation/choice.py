"""Which of all changes are tried: as many of each file as it has, in an order that a seed decides.

A longer list begins with the shorter one of the same seed.
"""

from __future__ import annotations

import random
from pathlib import Path
from typing import NamedTuple

from .operators import Change, changes_of


class Mutant(NamedTuple):
    file: str  # relative to fmu_src
    change: Change
    line: int
    old: str  # the lines that change, without indentation
    new: str

    @property
    def key(self) -> tuple[str, str, str, str]:
        return (self.file, str(self.line), self.old, self.new)

    def apply(self, source: str) -> str:
        return source[: self.change.start] + self.change.text + source[self.change.end :]


def mutants_of(folder: Path, file: str) -> list[Mutant]:
    source = (folder / file).read_text(encoding="utf-8")
    return [_mutant(file, source, change) for change in changes_of(source)]


def _mutant(file: str, source: str, change: Change) -> Mutant:
    start = source.rfind("\n", 0, change.start) + 1
    end = source.find("\n", change.end)
    lines = source[start:end]
    changed = source[start : change.start] + change.text + source[change.end : end]
    return Mutant(file, change, source.count("\n", 0, change.start) + 1, _flat(lines), _flat(changed))


def _flat(text: str) -> str:
    return " ".join(text.split()) or ";"


def chosen(folder: Path, seed: int, only: str = "") -> list[Mutant]:
    """All changes, of files whose name has `only`, in the order in which they are tried"""
    files = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.[ch]"))
    places = []
    for file in files:
        if only not in file:
            continue
        mutants = mutants_of(folder, file)
        order = random.Random(f"{seed} {file}")
        order.shuffle(mutants)
        begin = order.random()
        # The first of each file come first, in the order of `begin`; then all files advance alike.
        places += [
            ((rank + begin) / len(mutants) if rank else begin / 1e6, file, one)
            for rank, one in enumerate(mutants)
        ]
    return [one for _, _, one in sorted(places, key=lambda place: place[:2])]
