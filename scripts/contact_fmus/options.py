"""The commands and their options, which commands.toml lists"""

import argparse
import functools
import math
import tomllib
from pathlib import Path
from typing import Any, NoReturn

from .errors import UserError


def number(text: str) -> float:
    """A finite number greater than 0"""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a finite number greater than 0")
    return value


def choice(text: str) -> tuple[str, int]:
    """NAME=N"""
    name, _, value = text.partition("=")
    try:
        return name, int(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} (allowed: NAME=N, N a whole number)") from None


TYPES = {"path": Path, "int": int, "float": float, "number": number, "choice": choice}


@functools.cache
def commands() -> dict[str, dict[str, Any]]:
    return tomllib.loads(Path(__file__).with_name("commands.toml").read_text(encoding="utf-8"))


def parse(command: str, arguments: list[str] | None, **words: str) -> argparse.Namespace:
    """`words` replace their names in braces. UserError where the arguments make no sense."""

    def refuse(text: str) -> NoReturn:
        raise UserError(f"{text} (contact-fmus {command} --help lists the options)")

    about = commands()[command]
    made = argparse.ArgumentParser(
        prog=f"contact-fmus {command}",
        description=about["description"].format(**words),
        epilog=about.get("epilog"),
        formatter_class=argparse.RawDescriptionHelpFormatter
        if "\n" in about["description"] + about.get("epilog", "")
        else argparse.HelpFormatter,
    )
    for names, given in about.get("options", {}).items():
        read: dict[str, Any] = {"type": TYPES.get, "help": lambda text: text.format(**words)}
        option = {key: read[key](value) if key in read else value for key, value in given.items()}
        if "folder" in option:
            from .fmu.files import results_folder  # brings fmpy

            option |= {"type": Path, "default": results_folder(option.pop("folder"))}
        made.add_argument(*names.split(), **option)
    made.error = refuse  # type: ignore[method-assign]
    return made.parse_args(arguments)
