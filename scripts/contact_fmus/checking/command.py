"""The command check"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import fmpy

from contact_fmus.errors import CLAIM_FAILED, DONE, UserError, similar
from contact_fmus.fmu.files import fmu_file, shipped_fmus

from . import archive, github
from .check import FOUND, NOT_DONE, Check, not_done, result
from .trial import platform_folder

PATIENCE = 120.0  # s, of a trial run or of a validator
# Programs that are asked where they are installed: names, and the words of a report that finds nothing
VALIDATORS = {
    "VDMCheck2": (("VDMCheck2.sh", "VDMCheck2"), "No errors found"),
    "fmuCheck": (("fmuCheck.linux64", "fmuCheck"), "0 error(s)"),
}
TRIALS = ("exports", "run", "exchange", "state")
ALL = "all"


def main(arguments: list[str] | None = None) -> int:
    """0: nothing found; 1: something is, or a check could not be done; 2: a file is no FMU"""
    options = _parser().parse_args(arguments)
    unknown = set(options.allow_missing) - {*archive.WHAT, *VALIDATORS, ALL}
    if unknown:
        name = min(unknown)
        known = [*archive.WHAT, *VALIDATORS, ALL]
        hint = f"{similar(name, known)}: {', '.join(known)}"
        raise UserError(f"--allow-missing: there is no check '{name}'{hint}")
    found = {file: check_file(_file(file), options.patience) for file in options.files}
    allowed = {check.name for checks in found.values() for check in checks}
    allowed = allowed if ALL in options.allow_missing else set(options.allow_missing)
    report = [
        {"fmu": str(file), "checks": [dataclasses.asdict(one) for one in checks]}
        for file, checks in found.items()
    ]
    if options.json:
        for one in report:
            print(json.dumps(one))
    else:
        for file, checks in found.items():
            print("\n".join([f"{file}"] * (len(found) > 1) + told(checks)))
    if options.output is not None:
        options.output.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    if options.github:
        github.tell(found, allowed)
    bad = any(failed(check, allowed) for checks in found.values() for check in checks)
    return CLAIM_FAILED if bad else DONE


def failed(check: Check, allowed: set[str]) -> bool:
    return check.outcome == FOUND or (check.outcome == NOT_DONE and check.name not in allowed)


def told(checks: list[Check]) -> list[str]:
    lines = []
    for check in checks:
        lines.append(f"{check.outcome:8}  {check.name:12} {check.what}")
        lines += [f"{'':10}- {finding}" for finding in check.findings]
    return lines


def _parser() -> argparse.ArgumentParser:
    what = "".join(f"\n  {name:12} {text}" for name, text in archive.WHAT.items())
    parser = argparse.ArgumentParser(
        prog="contact-fmus check",
        description="Checks FMU files of FMI 2.0 and 3.0, of any maker:\n"
        f"{what}\n\nand by {' and '.join(VALIDATORS)} where they are installed.",
        epilog="status: 0 nothing found; 1 something found, or a check could not be done; 2 a file is no FMU",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", nargs="+", metavar="FILE.fmu", help="or the name of a shipped FMU")
    parser.add_argument(
        "--allow-missing",
        action="extend",
        nargs="+",
        default=[],
        metavar="CHECK",
        help=f"checks that may be left undone, such as run where there is no binary for this machine; {ALL}",
    )
    parser.add_argument(
        "--patience", type=float, default=PATIENCE, metavar="S", help=f"for each check, s ({PATIENCE:g})"
    )
    parser.add_argument("--json", action="store_true", help="the results as JSON, a line for each FMU")
    parser.add_argument("--output", type=Path, metavar="FILE", help="also writes the results as JSON")
    parser.add_argument(
        "--github", action="store_true", help="also annotations and a summary for GitHub Actions"
    )
    return parser


def _file(name: str) -> Path:
    return fmu_file(name) if not Path(name).exists() and name in shipped_fmus() else Path(name)


def check_file(file: Path, patience: float = PATIENCE) -> list[Check]:
    """UserError where the file is no archive with a description"""
    if file.is_dir():
        raise UserError(f"{file}: this is a folder; an FMU (.fmu) is needed")
    if not file.is_file():
        raise UserError(f"{file}: there is no such file")
    if not zipfile.is_zipfile(file):
        raise UserError(f"{file}: this is no FMU: not a ZIP archive")
    with zipfile.ZipFile(file) as members:
        if "modelDescription.xml" not in members.namelist():
            raise UserError(f"{file}: this is no FMU: it has no modelDescription.xml")
    checks = [result("archive", archive.archive(file)), result("description", archive.description(file))]
    with tempfile.TemporaryDirectory() as name:
        checks += _unpacked(file, Path(name), patience)
    installed = {name: program for name in VALIDATORS if (program := _program(name)) is not None}
    return checks + [_validated(name, program, file, patience) for name, program in installed.items()]


def _unpacked(file: Path, folder: Path, patience: float) -> list[Check]:
    """What needs the FMU's files"""
    try:
        fmpy.extract(str(file), str(folder))
        about = fmpy.read_model_description(folder, validate=False)
    except Exception as error:  # fmpy has no class of its own for what it cannot read
        reason = f"the FMU cannot be read: {' '.join(str(error).split())}"
        return [not_done(name, reason) for name in ("binaries", "exports", "run")]
    checks = [result("binaries", archive.binaries(folder, about))]
    trials = [name for name in TRIALS if _offers(about, name)]
    platform = platform_folder(about)
    if not (folder / "binaries" / platform).is_dir():
        reason = f"the FMU has no binary for {platform}"
        return [*checks, *(not_done(name, reason) for name in trials)]
    return checks + [_trial(name, file, patience) for name in trials]


def _offers(about: Any, trial: str) -> bool:
    """Whether there is anything to try"""
    if trial == "exchange":
        return about.modelExchange is not None
    if trial == "state":
        kind = about.coSimulation
        names = ("canGetAndSetFMUstate", "canGetAndSetFMUState")
        return kind is not None and any(getattr(kind, name, False) for name in names)
    return trial == "exports" or about.coSimulation is not None


def _trial(name: str, file: Path, patience: float) -> Check:
    """The library in a process of its own"""
    command = [sys.executable, "-m", "contact_fmus.checking.trial", name, str(file.resolve())]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    try:
        trial = subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=patience,
            check=False,
            env=environment,
        )
    except subprocess.TimeoutExpired:
        return result(name, [f"not done after {patience:g} s"])
    # The library may print too.
    said = [line for line in trial.stdout.splitlines() if line.startswith('{"findings"')]
    if said:
        return result(name, json.loads(said[-1])["findings"])
    ended = f" with status {trial.returncode}" if trial.returncode > 0 else ""
    if trial.returncode < 0:
        ended = f" by signal {signal.Signals(-trial.returncode).name}"
    return result(name, [f"the library ended its process{ended}"])


def _program(name: str) -> str | None:
    """A validator's, where it is installed"""
    asked = os.environ.get(name.upper())  # a path, such as VDMCHECK2=/opt/vdmcheck2/VDMCheck2.sh
    return next(filter(None, map(shutil.which, [asked] if asked else VALIDATORS[name][0])), None)


def _validated(name: str, program: str, file: Path, patience: float) -> Check:
    try:
        run = subprocess.run(
            [program, str(file.resolve())],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=patience,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return not_done(name, f"not done after {patience:g} s")
    if run.returncode == 0 and VALIDATORS[name][1] in run.stdout:
        return result(name, [])
    return result(name, [line.strip() for line in run.stdout.splitlines() if line.strip()])
