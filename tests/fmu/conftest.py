"""Fixtures of the FMU tests: one scene after the other, and nothing ever printed."""

import pytest

from support.fmi2 import raw


@pytest.fixture(params=raw.SCENES)
def fmu(request) -> raw.Fmu:
    return raw.load(request.param)


@pytest.fixture
def universal() -> raw.Fmu:
    """The FMU with every choice open"""
    return raw.load("SphereCylinder")


@pytest.fixture(autouse=True)
def the_fmu_prints_nothing(capfd):
    """An FMU talks through the logger alone: standard output and standard error stay empty in every test."""
    yield
    printed = capfd.readouterr()
    assert (printed.out, printed.err) == ("", "")
