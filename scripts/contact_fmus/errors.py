"""Expected errors: the command line prints their text as one sentence and ends with their status.

raise UserError("run: no FMU 'Sphere' (similar: SphereSphere)")
"""

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

# Statuses of the command `contact-fmus`
DONE = 0
CLAIM_FAILED = 1  # a claim does not hold, or a check found something
BAD_REQUEST = 2  # the request makes no sense: a name, a value, a file
RUN_FAILED = 3  # an FMU, a compiler or another program refused or failed on the way
INTERRUPTED = 130  # Ctrl-C: 128 + SIGINT, as shells have it
OUTPUT_CLOSED = 141  # who read the output went away: 128 + SIGPIPE


class UserError(Exception):
    """A request that makes no sense; the text says what, where, and what is allowed"""

    exit_status = BAD_REQUEST


class RunFailure(UserError):
    """A sensible request that failed on the way: an FMU refused, a compiler ended with an error"""

    exit_status = RUN_FAILED


def similar(word: str, known: Iterable[str]) -> str:
    """(did you mean 'penalty'?), or nothing where no known word is near"""
    near = difflib.get_close_matches(word, list(known), n=3)
    if not near:
        return ""
    return f" (did you mean {' or '.join(repr(one) for one in near)}?)"


def read_toml(file: Path) -> dict[str, Any]:
    """A scenario or a study; UserError where there is no such file, or something else in it"""
    try:
        return tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise UserError(f"{file}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UserError(f"{file}: this is no text, but binary: a TOML file in UTF-8 is needed") from None
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{file}: this is no TOML file: {error}") from None
