"""Builds the fuzzers and runs each for a while.

New inputs are kept in build-fuzz/found/NAME, what broke a claim in build-fuzz/findings/NAME.
"""

from __future__ import annotations

import os
import subprocess
import sys

from contact_fmus.errors import CLAIM_FAILED, DONE, RunFailure, UserError

from .fmu.files import is_clone, repository
from .options import parse

# exchange: Model Exchange of FMI 2.0; calls3 and exchange3: Co-Simulation and Model Exchange of FMI 3.0;
# these three also with other scenes than SphereCylinder
NAMES = (
    *("calls", "exchange", "calls3", "exchange3", "state", "run_sphere", "run_cylinder", "run_plane"),
    *("run_three_balls", "run_two_pairs", "scene_files"),
    *(
        f"{kind}_{part}"
        for kind in ("exchange", "calls3", "exchange3")
        for part in ("turning", "plane", "caps", "cvode")
    ),
)
# A fuzzer goes on after a finding; inputs are tried in other lengths from the start. The most work an input
# can ask for, 2 runs of 12 communication steps of 2000 internal steps, takes six seconds of a processor; on a
# busy machine that may last twenty times as long.
OPTIONS = """-fork=1 -ignore_crashes=1 -ignore_timeouts=1 -ignore_ooms=1 -timeout=120 -report_slow_units=120
    -rss_limit_mb=2000 -max_len=500 -len_control=0"""


def main(arguments: list[str] | None = None) -> int:
    """0: nothing found; 1: a finding, or a fuzzer did not run; 2: this is no clone; 3: building failed"""
    options = parse("fuzz", arguments, names=", ".join(NAMES))
    if options.only not in (None, *NAMES):
        raise UserError(f"--only: there is no fuzzer '{options.only}' (allowed: {', '.join(NAMES)})")
    if not is_clone():
        raise UserError("the fuzzers are tests, which only a clone of the sources has")
    names = [options.only] if options.only else list(NAMES)
    _build([f"fuzz_{name}" for name in names if name != "scene_files"])
    quiet = True
    for name in names:
        print(f"\n== {name}, {options.minutes} minutes", flush=True)
        search = scene_files if name == "scene_files" else library
        quiet &= search(name, options.minutes)
    return DONE if quiet else CLAIM_FAILED


def _build(targets: list[str]) -> None:
    configure = ["cmake", "--preset", "fuzz", "-Wno-dev", "--log-level=WARNING"]
    _run([*configure, f"-DPython3_EXECUTABLE={sys.executable}"])
    if targets:
        _run(["cmake", "--build", "--preset", "fuzz", "--target", *targets, "--", "--quiet"])


def _run(command: list[str]) -> None:
    if subprocess.run(command, cwd=repository(), stdin=subprocess.DEVNULL, check=False).returncode != 0:
        raise RunFailure(f"{' '.join(command[:3])} failed")


def scene_files(_name: str, length: int) -> bool:
    """Hypothesis with scene files against the generator; True where it finds nothing"""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/fuzz/test_scene_files.py"]
    environment = os.environ | {"CONTACT_FUZZ_MINUTES": str(length)}
    run = subprocess.run(command, cwd=repository(), env=environment, stdin=subprocess.DEVNULL, check=False)
    return run.returncode == 0


def library(name: str, length: int) -> bool:
    """One of libFuzzer's programs; True where it ran to its end and found nothing"""
    folder = repository() / "build-fuzz"
    corpus = repository() / "tests" / "fuzz" / "corpus" / f"fuzz_{name.partition('_')[0]}"
    found, findings = folder / "found" / name, folder / "findings" / name
    for made in (found, findings):
        made.mkdir(parents=True, exist_ok=True)
    program = folder / "tests" / "fuzz" / f"fuzz_{name}"
    command = ["nice", program, *OPTIONS.split(), f"-max_total_time={60 * length}", found, corpus]
    log = findings / "log"
    with log.open("w", encoding="utf-8") as output:
        subprocess.run(command, cwd=findings, stdin=subprocess.DEVNULL, stdout=output, stderr=output, check=False)
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    print(*lines[-1:])
    count = sum(file.is_file() and file != log for file in findings.iterdir())
    print(f"{name}: {count} findings in {findings.relative_to(repository())}")
    # libFuzzer's last words; without them it did not run, and nothing was looked for.
    ended = any(line.startswith("INFO: exiting") for line in lines)
    if not ended:
        print(f"{name}: did not run to its end, see {log.relative_to(repository())}", file=sys.stderr)
    return ended and count == 0
