"""Shared by all Python tests: paths of the modules, and FMUs opened once a session and reset for each use."""

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
for folder in (ROOT / "scripts", ROOT / "tests" / "physics"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def fmu_folder():
    """$CONTACT_FMUS, or where the build leaves them."""
    return Path(os.environ.get("CONTACT_FMUS", ROOT / "build" / "fmus")).resolve()


@pytest.fixture(scope="session")
def fmu_path():
    def path(name):
        file = fmu_folder() / f"{name}.fmu"
        assert file.is_file(), f"{file} is missing: build the FMUs first"
        return file

    return path


@pytest.fixture(scope="session")
def opened(fmu_path):
    """FMU by name, one instance a session; `run` and `start` of tests/physics/checks.py reset it before each
    run.
    """
    from contact_scenarios.fmu import ContactFmu

    instances = {}

    def get(name):
        if name not in instances:
            instances[name] = ContactFmu(fmu_path(name), instance_name=name).__enter__()
        return instances[name]

    yield get
    for instance in instances.values():
        instance.__exit__(None, None, None)
