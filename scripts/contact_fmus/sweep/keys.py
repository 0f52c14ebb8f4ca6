"""The keys of a study file, taken one by one; what is wrong is said in one sentence"""

from __future__ import annotations

import math
from typing import Any

from contact_fmus.errors import UserError, similar


def number(value: Any, where: str) -> float:
    """A finite number; text such as "50 mm" is none"""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{where}: a number is wanted (SI units, no quotation marks), not {value!r}")
    if not math.isfinite(value):
        raise UserError(f"{where}: a finite number is wanted, not {value!r}")
    return float(value)


def whole(value: Any, where: str, least: int, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise UserError(f"{where}: a whole number from {least} to {most} is wanted, not {value!r}")
    return value


def text(value: Any, where: str) -> str:
    if not isinstance(value, str) or not value:
        raise UserError(f"{where}: a text in quotation marks is wanted, not {value!r}")
    return value


def one_of(value: Any, where: str, allowed: tuple[str, ...]) -> str:
    if value not in allowed:
        raise UserError(
            f"{where}: one of {', '.join(allowed)} is wanted, not {value!r}{similar(str(value), allowed)}"
        )
    return value


class Table:
    """A table of a TOML file of which every key is to be taken"""

    def __init__(self, content: Any, where: str, allowed: tuple[str, ...]):
        if not isinstance(content, dict):
            raise UserError(f"{where}: a table is wanted, not {content!r}")
        for key in content:
            if key not in allowed:
                said = f"{where}: there is no key {key!r}; allowed: {', '.join(allowed)}"
                raise UserError(said + similar(key, allowed))
        self.content = content
        self.where = where

    def __contains__(self, key: str) -> bool:
        return key in self.content

    def place(self, key: str) -> str:
        return f"{self.where}: {key}"

    def get(self, key: str, default: Any = None) -> Any:
        return self.content.get(key, default)

    def number(self, key: str, default: float | None = None) -> float:
        if key not in self.content and default is not None:
            return default
        return number(self.needed(key), self.place(key))

    def positive(self, key: str, default: float | None = None) -> float:
        value = self.number(key, default)
        if value <= 0:
            raise UserError(f"{self.place(key)}: a number above 0 is wanted, not {value!r}")
        return value

    def needed(self, key: str) -> Any:
        if key not in self.content:
            raise UserError(f"{self.where}: the key {key} is missing")
        return self.content[key]

    def pair(self, key: str) -> tuple[float, float]:
        """[a, b] with a < b"""
        value, where = self.needed(key), self.place(key)
        if not isinstance(value, list) or len(value) != 2:
            raise UserError(f"{where}: two numbers, [from, to], are wanted, not {value!r}")
        low, high = (number(one, where) for one in value)
        if not low < high:
            raise UserError(f"{where}: the first number has to be below the second, not {value!r}")
        return low, high
