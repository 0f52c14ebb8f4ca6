"""The code of an FMU built once more, with another compiler or other flags, by the build's own commands."""

import itertools
import os
import shlex
from collections.abc import Iterable
from pathlib import Path

from contact_fmus.fmu.files import fmus_folder
from support.fmi2 import raw
from support.programs import checked

BUILD = Path(os.environ.get("CONTACT_BUILD") or fmus_folder().parent).resolve()
# Both compilers optimize whole programs in ways of their own; without that the code is one unit all the same.
LEFT_OUT = ("-flto", "-fno-fat-lto", "-fwhole-program", "-O", "-M", "-g")


def _commands(scene: str) -> tuple[list[str], list[str]]:
    """Returns how ninja compiles the scene's one unit, and how it links the library."""
    told = checked(["ninja", "-C", BUILD, "-t", "commands", f"libraries/{scene}.so"]).splitlines()
    link = next(line for line in told if f"-o libraries/{scene}.so " in line)
    unit = next(word for word in shlex.split(link) if word.endswith(".c.o"))
    return _plain(next(line for line in told if f"-o {unit} " in line)), _plain(link)


def _plain(line: str) -> list[str]:
    """Returns the command without its compiler, its output and its flags of optimization."""
    words = [word for word in shlex.split(line) if word not in (":", "&&")]
    kept = []
    for before, word in itertools.pairwise(words):
        if before in ("-o", "-MT", "-MF") or word == "-o" or word.startswith(LEFT_OUT):
            continue
        kept.append(word)
    return kept


def build(scene: str, compiler: str, flags: Iterable[str], folder: Path) -> raw.Fmu:
    """Returns the FMU of the scene with its code from this compiler."""
    unit, library = folder / f"{scene}.o", folder / f"{scene}.so"
    compile_, link = _commands(scene)
    link = [str(unit) if word.endswith(".c.o") else word for word in link]
    for command in (
        [compiler, *flags, *compile_, "-w", "-o", str(unit)],
        [compiler, *flags, *link, "-o", str(library)],
    ):
        checked(command, cwd=BUILD)
    return raw.load(scene).with_library(library)
