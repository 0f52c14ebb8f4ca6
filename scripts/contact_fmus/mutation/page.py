"""docs/mutation.md from the results and the reasons kept by hand"""

from __future__ import annotations

import collections
import tomllib
from pathlib import Path

from .campaign import CAUGHT, EQUIVALENT, INVALID, MISSED, PENDING

HEAD = """# What the tests notice

`scripts/mutate.sh` breaks the C code in small ways, one at a time: an operator, a constant, a condition, a
sign, a statement left out, another value returned. A change is *caught* when a test fails, crashes or
exceeds its time, *equivalent* when the compiler makes the same code of it or when it cannot be told from
outside, and *not caught* when no test notices what could be noticed. Reasons are kept by hand in
`scripts/contact_fmus/mutation/reasons.toml`.
"""


def read_reasons(file: Path) -> dict[tuple[str, str, str], dict]:
    rows = tomllib.loads(file.read_text(encoding="utf-8")).get("reason", []) if file.is_file() else []
    return {(row["file"], row["old"], row["new"]): row for row in rows}


def write_page(rows: list[dict], seed: int, reasons_file: Path, page: Path) -> int:
    """Returns how many changes are neither caught nor explained"""
    reasons = read_reasons(reasons_file)
    valid = [row for row in rows if row["outcome"] != INVALID]
    left = [row for row in valid if row["outcome"] in (MISSED, PENDING)]
    why = [(row, reasons.get((row["file"], row["old"], row["new"]))) for row in left]
    explained = [(row, reason) for row, reason in why if reason and reason["outcome"] == EQUIVALENT]
    missed = [(row, reason) for row, reason in why if not reason or reason["outcome"] != EQUIVALENT]
    lines = [HEAD, f"{len(valid)} changes that compile, seed {seed}:", ""]
    lines += _table(["", "changes"], _counts(valid, len(explained), len(missed)))
    lines += ["", "## By folder", ""]
    lines += _table(
        ["folder", "changes", "caught", "equivalent", "not caught"], _folders(valid, explained, missed)
    )
    lines += ["", "## Not caught", ""]
    lines += _table(["where", "change", "reason"], [_line(*one) for one in missed])
    lines += ["", "## Equivalent, by hand", ""]
    lines += _table(["where", "change", "reason"], [_line(*one) for one in explained])
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return sum(reason is None for _, reason in missed)


def _counts(valid: list[dict], explained: int, missed: int) -> list[list[str]]:
    caught = collections.Counter(f"{row['by']}, {row['how']}" for row in valid if row["outcome"] == CAUGHT)
    same = sum(row["outcome"] == EQUIVALENT for row in valid)
    rows = [["caught", str(sum(caught.values()))]]
    rows += [[f"— {name}", str(count)] for name, count in sorted(caught.items())]
    rows += [["equivalent, the same machine code", str(same)], ["equivalent, by hand", str(explained)]]
    return [*rows, ["not caught", str(missed)]]


def _folders(valid: list[dict], explained: list, missed: list) -> list[list[str]]:
    folders = sorted({row["file"].partition("/")[0] for row in valid})
    table = []
    for folder in folders:
        own = [row for row in valid if row["file"].startswith(f"{folder}/")]
        caught = sum(row["outcome"] == CAUGHT for row in own)
        left = sum(row["file"].startswith(f"{folder}/") for row, _ in missed)
        same = sum(row["outcome"] == EQUIVALENT for row in own)
        same += sum(row["file"].startswith(f"{folder}/") for row, _ in explained)
        table.append([folder, str(len(own)), str(caught), str(same), str(left)])
    return table


def _line(row: dict, reason: dict | None) -> list[str]:
    hurried = " (Met the quick tests only.)" if row["outcome"] == PENDING else ""
    return [
        f"{row['file']}:{row['line']}",
        f"`{_cell(row['old'])}` → `{_cell(row['new'])}`",
        (reason["why"] if reason else "") + hurried,
    ]


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _table(head: list[str], rows: list[list[str]]) -> list[str]:
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows)]
