"""One check's result"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

from .archive import WHAT

PASSED, FOUND, NOT_DONE = "passed", "found", "not done"


@dataclasses.dataclass
class Check:
    name: str
    outcome: str  # passed | found | not done
    findings: list[str]
    what: str = ""


def result(name: str, findings: Iterable[str]) -> Check:
    """`findings` may raise: then what it raises is the finding"""
    found = []
    try:
        found.extend(findings)
    except Exception as error:  # fmpy and zipfile raise what their parts raise
        found.append(" ".join(str(error).split()) or type(error).__name__)
    return Check(name, FOUND if found else PASSED, found, WHAT.get(name, ""))


def not_done(name: str, reason: str) -> Check:
    return Check(name, NOT_DONE, [reason], WHAT.get(name, ""))
