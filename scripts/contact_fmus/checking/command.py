"""The command check: what is wrong with an FMU file, of this project or of another maker"""

import dataclasses
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import fmpy
from fmpy.validation import validate_fmu

from contact_fmus.errors import CLAIM_FAILED, DONE, UserError, similar
from contact_fmus.fmu.files import file_or_shipped
from contact_fmus.options import parse

from .trial import CHECKS, TRIALS, platform_folder

# Checks that only read the file: archive, description, and the kind of every binary

WHAT = CHECKS["what"]


def archive(file: Path) -> Iterator[str]:
    """Damaged members, names that other systems cannot read, names that would leave the folder"""
    with zipfile.ZipFile(file) as members:
        damaged = members.testzip()
        if damaged is not None:
            yield f"{damaged} is damaged: its checksum does not agree"
        for member in members.infolist():
            if "\\" in member.orig_filename:
                yield f"{member.orig_filename}: a backslash in a name; FMI wants forward slashes"
            if member.filename.startswith("/") or ".." in member.filename.split("/"):
                yield f"{member.filename}: a name that leaves the FMU's folder"
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                yield f"{member.filename}: packed by a method that FMI does not allow, only store and deflate"


def description(file: Path) -> Iterator[str]:
    """fmpy's validation: XML schema, names, model structure, start values, causality, units"""
    for problem in validate_fmu(str(file)):
        yield " ".join(problem.split())


def binaries(folder: Path, about: Any) -> Iterator[str]:
    """Each platform's binaries: one of the described name, and of the platform's kind"""
    kinds = (about.coSimulation, about.modelExchange, getattr(about, "scheduledExecution", None))
    identifiers = {kind.modelIdentifier for kind in kinds if kind is not None}
    found = sorted(path for path in (folder / "binaries").glob("*") if path.is_dir())
    if not found and not (folder / "sources").is_dir():
        yield "there are neither binaries nor sources"
    for platform in found:
        if platform.name not in CHECKS["platforms"]:
            continue  # a platform that this list does not know is no fault
        for identifier in sorted(identifiers):
            yield from _binary(platform, identifier)


def _binary(platform: Path, identifier: str) -> Iterator[str]:
    ending, begins, machine = CHECKS["platforms"][platform.name]
    library = platform / f"{identifier}{ending}"
    name = f"binaries/{platform.name}/{library.name}"
    if not library.is_file():
        yield f"{name} is missing: the description says modelIdentifier {identifier}"
        return
    head = library.read_bytes()[:20]
    if not head.startswith(tuple(map(bytes.fromhex, begins))) or not head[18:20].startswith(bytes.fromhex(machine)):
        yield f"{name} is no library for {platform.name}: it begins with {head[:4].hex(' ')}"


# One check's result

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


# What GitHub Actions show of checks: an annotation for each finding, a table in the run's summary


def tell(found: dict[str, list[Check]], allowed: set[str]) -> None:
    """Annotations on stdout, the summary into the file that GITHUB_STEP_SUMMARY names"""
    for file, checks in found.items():
        for check in checks:
            if check.outcome in (FOUND, NOT_DONE):
                level = "warning" if check.outcome == NOT_DONE and check.name in allowed else "error"
                where = _data(file).replace(":", "%3A").replace(",", "%2C")
                for finding in check.findings:
                    print(f"::{level} file={where},title={check.name}::{_data(finding)}")
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
    """Escapes the text as GitHub's workflow commands want it"""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


PATIENCE = 120.0  # s, of a trial run or of a validator
# Programs that are asked where they are installed: names, and the words of a report that finds nothing
VALIDATORS = {
    "VDMCheck2": (("VDMCheck2.sh", "VDMCheck2"), "No errors found"),
    "fmuCheck": (("fmuCheck.linux64", "fmuCheck"), "0 error(s)"),
}
ALL = "all"


def main(arguments: list[str] | None = None) -> int:
    """0: nothing found; 1: something is, or a check could not be done; 2: a file is no FMU"""
    checks = "\n".join(f"  {name:12} {text}" for name, text in WHAT.items())
    options = parse("check", arguments, checks=checks)
    unknown = set(options.allow_missing) - {*WHAT, *VALIDATORS, ALL}
    if unknown:
        name = min(unknown)
        known = [*WHAT, *VALIDATORS, ALL]
        hint = f"{similar(name, known)}: {', '.join(known)}"
        raise UserError(f"--allow-missing: there is no check '{name}'{hint}")
    found = {name: check_file(file_or_shipped(name), options.patience) for name in options.files}
    allowed = {check.name for checks in found.values() for check in checks}
    allowed = allowed if ALL in options.allow_missing else set(options.allow_missing)
    report = [
        {"fmu": str(file), "checks": [dataclasses.asdict(one) for one in checks]} for file, checks in found.items()
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
        tell(found, allowed)
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
    checks = [result("archive", archive(file)), result("description", description(file))]
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
    checks = [result("binaries", binaries(folder, about))]
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
            command, capture_output=True, text=True, errors="replace", timeout=patience, check=False, env=environment
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
    lines = [line.strip() for line in run.stdout.splitlines() if line.strip()]
    # fmuCheck tells of the run and prints its values besides.
    return result(name, [line for line in lines if line.startswith(("[WARNING]", "[ERROR]", "[FATAL]"))] or lines)
