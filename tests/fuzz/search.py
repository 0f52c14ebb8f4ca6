"""Builds the fuzzers and runs each for a while.

New inputs are kept in build-fuzz/found/NAME, what broke a claim in build-fuzz/findings/NAME."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

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
OPTIONS = {"fork": 1, "ignore_crashes": 1, "ignore_timeouts": 1, "ignore_ooms": 1, "timeout": 120}
OPTIONS |= {"report_slow_units": 120, "rss_limit_mb": 2000, "max_len": 500, "len_control": 0}


def main() -> int:
    """0: nothing found; 1: a finding, or a fuzzer did not run; 3: building failed"""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("--minutes", type=minutes, default=10, metavar="N", help="for each fuzzer (10)")
    parser.add_argument("--only", choices=NAMES, metavar="NAME", help=f"one of {', '.join(NAMES)}")
    options = parser.parse_args()
    names = [options.only] if options.only else list(NAMES)
    _build([f"fuzz_{name}" for name in names if name != "scene_files"])
    quiet = True
    for name in names:
        print(f"\n== {name}, {options.minutes} minutes", flush=True)
        search = scene_files if name == "scene_files" else library
        quiet &= search(name, options.minutes)
    return 0 if quiet else 1


def minutes(text: str) -> int:
    """A whole number greater than 0"""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number greater than 0")
    return int(text)


def _build(targets: list[str]) -> None:
    configure = ["cmake", "--preset", "fuzz", "-Wno-dev", "--log-level=WARNING"]
    _run([*configure, f"-DPython3_EXECUTABLE={sys.executable}"])
    if targets:
        _run(["cmake", "--build", "--preset", "fuzz", "--target", *targets, "--", "--quiet"])


def _run(command: list[str]) -> None:
    if subprocess.run(command, cwd=ROOT, stdin=subprocess.DEVNULL, check=False).returncode != 0:
        print(f"fuzz: {' '.join(command[:3])} failed", file=sys.stderr)
        sys.exit(3)


def scene_files(_name: str, length: int) -> bool:
    """Hypothesis with scene files against the generator; True where it finds nothing"""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    command += ["tests/fuzz/test_scene_files.py"]
    environment = os.environ | {"CONTACT_FUZZ_MINUTES": str(length)}
    run = subprocess.run(command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, check=False)
    return run.returncode == 0


def library(name: str, length: int) -> bool:
    """One of libFuzzer's programs; True where it ran to its end and found nothing"""
    folder = ROOT / "build-fuzz"
    corpus = ROOT / "tests" / "fuzz" / "corpus" / f"fuzz_{name.partition('_')[0]}"
    found, findings = folder / "found" / name, folder / "findings" / name
    for made in (found, findings):
        made.mkdir(parents=True, exist_ok=True)
    program = folder / "tests" / "fuzz" / f"fuzz_{name}"
    options = OPTIONS | {"max_total_time": 60 * length}
    command = ["nice", program, *(f"-{name}={value}" for name, value in options.items()), found, corpus]
    log = findings / "log"
    with log.open("w", encoding="utf-8") as output:
        streams = {"stdin": subprocess.DEVNULL, "stdout": output, "stderr": output}
        subprocess.run(command, cwd=findings, check=False, **streams)
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    print(*lines[-1:])
    count = sum(file.is_file() and file != log for file in findings.iterdir())
    print(f"{name}: {count} findings in {findings.relative_to(ROOT)}")
    # libFuzzer's last words; without them it did not run, and nothing was looked for.
    ended = any(line.startswith("INFO: exiting") for line in lines)
    if not ended:
        print(f"{name}: did not run to its end, see {log.relative_to(ROOT)}", file=sys.stderr)
    return ended and count == 0


if __name__ == "__main__":
    sys.exit(main())
