"""The command behind scripts/mutate.sh"""

from __future__ import annotations

import argparse
import shutil
import time
from pathlib import Path

from contact_fmus.errors import UserError
from contact_fmus.fmu.files import fmus_folder, is_clone, repository

from .campaign import Campaign, say
from .choice import chosen
from .page import write_page
from .program import Program

TESTS = ["tests/physics", "tests/property", "tests/fmu"]
# They look at finished files or build FMUs of their own, from the sources.
LEFT_OUT = [
    "physics/test_lists",
    "physics/test_extra_scenes",
    "fmu/test_determinism",
    "fmu/test_leave_out",
    "fmu/test_validity",
]


def main(arguments: list[str]) -> int:
    """0 when every change that compiles was noticed, is the same code or has its reason in reasons.toml"""
    parser = argparse.ArgumentParser(prog="contact-fmus mutate")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--minutes", type=float, default=1e6)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--patience", type=float, default=60.0)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--page", action="store_true")
    asked = parser.parse_args(arguments)
    if not is_clone():
        raise UserError("the changes are judged by the tests, which only a clone of the sources has")
    root = repository()
    build = fmus_folder().resolve().parent
    folder = root / "build-mutation"
    results = folder / "mutants.csv"
    if asked.again:
        results.unlink(missing_ok=True)
    folder.mkdir(exist_ok=True)
    campaign = Campaign(Program(root / "fmu_src", build, folder), root, results, asked.jobs, asked.patience)
    stamp = folder / "base" / "made of"
    if not asked.page and not (stamp.is_file() and stamp.read_text() == campaign.source):
        shutil.rmtree(folder / "base", ignore_errors=True)
    mutants = chosen(root / "fmu_src", asked.seed, asked.only)
    if not asked.page:
        until = time.time() + 60 * asked.minutes
        campaign.prepare([*TESTS, *(f"--ignore=tests/{name}.py" for name in LEFT_OUT)])
        stamp.write_text(campaign.source)
        say(f"{len(mutants)} changes to choose from")
        campaign.run(mutants, asked.count, until)
    known = [row for one in mutants if (row := campaign.rows.get(one.key))]
    unexplained = write_page(
        known, asked.seed, Path(__file__).with_name("reasons.toml"), root / "docs" / "mutation.md"
    )
    say(f"{unexplained} changes that no test notices have no reason yet: docs/mutation.md")
    return int(unexplained > 0)
