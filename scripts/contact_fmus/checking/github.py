"""What GitHub Actions show of checks: an annotation for each finding, a table in the run's summary"""

from __future__ import annotations

import os

from .check import FOUND, NOT_DONE, Check


def tell(found: dict[str, list[Check]], allowed: set[str]) -> None:
    """Annotations on stdout, the summary into the file that GITHUB_STEP_SUMMARY names"""
    for file, checks in found.items():
        for check in checks:
            if check.outcome in (FOUND, NOT_DONE):
                level = "warning" if check.outcome == NOT_DONE and check.name in allowed else "error"
                for finding in check.findings:
                    print(f"::{level} file={_property(file)},title={check.name}::{_data(finding)}")
    if path := os.environ.get("GITHUB_STEP_SUMMARY"):
        with open(path, "a", encoding="utf-8") as summary:
            summary.write("\n".join(_table(found)) + "\n")


def _table(found: dict[str, list[Check]]) -> list[str]:
    lines = ["### FMU checks", "", "| FMU | check | outcome | findings |", "| --- | --- | --- | --- |"]
    for file, checks in found.items():
        for check in checks:
            text = "<br>".join(check.findings).replace("|", "\\|")
            lines.append(f"| {file} | {check.name} | {check.outcome} | {text} |")
    return lines


def _data(text: str) -> str:
    """As GitHub's workflow commands want it"""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
