"""Shared by all Python tests: FMUs opened once a session and reset for each use."""

import lark
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


@pytest.fixture(scope="session")
def names_parsed_once():
    """fmpy parses the names of variables slowly, and FMUs have the same ones."""
    parse, known = lark.Lark.parse, {}

    def parsed(self, text, *more, **options):
        if text not in known:
            known[text] = parse(self, text, *more, **options)
        return known[text]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lark.Lark, "parse", parsed)
        yield
