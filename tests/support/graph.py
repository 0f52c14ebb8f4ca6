"""Which file of fmu_src needs which, by the symbols of its object files; circles in such graphs."""

import functools
import tempfile
from pathlib import Path

from support.programs import finished
from support.sources import SOURCE, compile_c

_kept = tempfile.TemporaryDirectory()


@functools.cache
def compiled(unit: Path, scene: str) -> Path:
    """Returns the unit's object file. Constant tables of pointers are read-only without -fPIC."""
    # Named by its place below fmu_src: files of two folders may have one name.
    name = "_".join(unit.relative_to(SOURCE).parts) if unit.is_relative_to(SOURCE) else unit.name
    made = Path(_kept.name) / f"{scene}_{name}.o"
    said = compile_c("gcc", unit, scene, "-O0", "-fno-pic", "-c", "-o", str(made))
    assert said == "", said
    return made


def symbols(unit: Path, scene: str) -> list[list[str]]:
    """Returns what nm says of the unit, in words."""
    return [line.split() for line in finished(["nm", compiled(unit, scene)], check=True).stdout.splitlines()]


def object_symbols(unit: Path, scene: str) -> tuple[set[str], set[str]]:
    """External symbols that the unit defines, and those it asks for"""
    rows = symbols(unit, scene)
    defined = {row[-1] for row in rows if row[-2] in "TDRBC"}
    return defined, {row[-1] for row in rows if row[-2] == "U"}


def file_graph(units: dict[str, tuple[set[str], set[str]]]) -> dict[str, set[str]]:
    """From symbols by unit: the units whose symbols each unit asks for"""
    owner = {symbol: name for name, (defined, _) in units.items() for symbol in defined}
    return {
        name: {owner[symbol] for symbol in asked if symbol in owner} - {name}
        for name, (_, asked) in units.items()
    }


def circle(edges: dict[str, set[str]]) -> list[str] | None:
    """Returns some path that ends where it began, or None."""
    done: set[str] = set()

    def visit(name, path):
        if name in path:
            return [*path[path.index(name) :], name]
        if name in done:
            return None
        found = next((way for to in sorted(edges[name]) if (way := visit(to, [*path, name]))), None)
        done.add(name)
        return found

    return next((way for name in sorted(edges) if (way := visit(name, []))), None)


def upward(edges: dict[str, set[str]], layers: tuple[str, ...]) -> list[str]:
    """Edges from a folder to one that comes after it"""

    def rank(name):
        return layers.index(name.split("/")[0])

    back = [(name, to) for name, needed in edges.items() for to in needed if rank(to) > rank(name)]
    return sorted(f"{name} -> {to}" for name, to in back)
