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

import fmpy

from contact_fmus.errors import CLAIM_FAILED, DONE, UserError

from . import archive

PATIENCE = 120  # s, of a trial run or of a validator
# Programs that are asked where they are installed: names, and the words of a report that finds nothing
VALIDATORS = {
    "VDMCheck2": (("VDMCheck2.sh", "VDMCheck2"), "No errors found"),
    "fmuCheck": (("fmuCheck.linux64", "fmuCheck"), "0 error(s)"),
}
WHAT = {
    "archive": "names and checksums in the ZIP archive",
    "description": "XML schema, names, model structure, start values, units (fmpy)",
    "binaries": "a library of the described name and kind for each platform",
    "exports": "the standard's functions in this platform's library",
    "run": "a short simulation: finite numbers, no error",
}


@dataclasses.dataclass
class Check:
    """One check's result"""

    name: str
    outcome: str  # passed | found | not done
    findings: list[str]
    what: str = ""


def main(arguments: list[str] | None = None) -> int:
    """0: nothing found; 1: something is; 2: the file is no FMU"""
    parser = argparse.ArgumentParser(
        prog="contact-fmus check",
        description="Checks an FMU file, of any maker: archive, description, binaries, exports, a short run,"
        f" and {' and '.join(VALIDATORS)} where they are installed.",
    )
    parser.add_argument("file", type=Path, metavar="FILE.fmu")
    parser.add_argument("--json", action="store_true", help="the results as JSON")
    options = parser.parse_args(arguments)
    checks = check_file(options.file)
    failed = any(check.outcome == "found" for check in checks)
    if options.json:
        print(json.dumps({"fmu": str(options.file), "checks": [dataclasses.asdict(one) for one in checks]}))
    else:
        for check in checks:
            print(f"{check.outcome:8}  {check.name:12} {check.what}")
            for finding in check.findings:
                print(f"{'':10}- {finding}")
    return CLAIM_FAILED if failed else DONE


def check_file(file: Path) -> list[Check]:
    """UserError where the file is no archive with a description"""
    if file.is_dir():
        raise UserError(f"{file}: this is a folder; an FMU (.fmu) is needed")
    if not file.is_file():
        raise UserError(f"{file}: there is no such file")
    if not zipfile.is_zipfile(file):
        raise UserError(f"{file}: this is no FMU: not a ZIP archive")
    checks = [_result("archive", list(archive.archive(file)))]
    with zipfile.ZipFile(file) as members:
        if "modelDescription.xml" not in members.namelist():
            raise UserError(f"{file}: this is no FMU: it has no modelDescription.xml")
    checks.append(_result("description", list(archive.description(file))))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        checks += _unpacked(file, folder)
    return checks + [_validator(name, file) for name in VALIDATORS]


def _unpacked(file: Path, folder: Path) -> list[Check]:
    """What needs the FMU's files"""
    try:
        fmpy.extract(str(file), str(folder))
        about = fmpy.read_model_description(folder, validate=False)
    except Exception as error:  # fmpy has no class of its own for what it cannot read
        return [
            _not_done(name, f"the FMU cannot be read: {error}") for name in ("binaries", "exports", "run")
        ]
    checks = [_result("binaries", list(archive.binaries(folder, about)))]
    if not (folder / "binaries" / fmpy.platform).is_dir():
        reason = f"the FMU has no binary for {fmpy.platform}"
        return [*checks, _not_done("exports", reason), _not_done("run", reason)]
    return checks + _trial(folder)


def _trial(folder: Path) -> list[Check]:
    """The library in a process of its own"""
    command = [sys.executable, "-m", "contact_fmus.checking.trial", str(folder)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    ended = "the library ended its process"
    try:
        trial = subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PATIENCE,
            check=False,
            env=environment,
        )
        lines = trial.stdout.splitlines()
        if trial.returncode < 0:
            ended += f" by signal {signal.Signals(-trial.returncode).name}"
        elif trial.returncode > 0:
            ended += f" with status {trial.returncode}"
    except subprocess.TimeoutExpired as error:
        lines = (error.stdout or b"").decode("utf-8", "replace").splitlines()
        ended = f"not done after {PATIENCE} s"
    # The library may print too; each of the trial's own lines has all checks that are done.
    done = [json.loads(line) for line in lines if line.startswith('{"exports"')]
    found = done[-1] if done else {}
    return [_result(name, found.get(name, [ended])) for name in ("exports", "run")]


def _validator(name: str, file: Path) -> Check:
    programs, good = VALIDATORS[name]
    asked = os.environ.get(name.upper())  # a path, such as VDMCHECK2=/opt/vdmcheck2/VDMCheck2.sh
    program = next(filter(None, map(shutil.which, [asked] if asked else programs)), None)
    if program is None:
        return _not_done(name, f"not installed: no {programs[0]} on the PATH, and {name.upper()} names none")
    try:
        run = subprocess.run(
            [program, str(file.resolve())],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return _not_done(name, f"not done after {PATIENCE} s")
    if run.returncode == 0 and good in run.stdout:
        return _result(name, [])
    return _result(name, [line.strip() for line in run.stdout.splitlines() if line.strip()])


def _result(name: str, findings: list[str]) -> Check:
    return Check(name, "found" if findings else "passed", findings, WHAT.get(name, ""))


def _not_done(name: str, reason: str) -> Check:
    return Check(name, "not done", [reason], WHAT.get(name, ""))
