"""Shared by all Python tests: FMUs opened once a session and reset for each use."""

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file


@pytest.fixture(scope="session")
def fmu_path():
    return fmu_file


@pytest.fixture(scope="session")
def opened(fmu_path):
    """FMU by name, one instance a session; `run` and `start` of support/checks.py reset it."""
    instances = {}

    def get(name):
        if name not in instances:
            instances[name] = ContactFmu(fmu_path(name), instance_name=name).__enter__()
        return instances[name]

    yield get
    for instance in instances.values():
        instance.__exit__(None, None, None)
