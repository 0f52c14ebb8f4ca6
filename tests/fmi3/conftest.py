"""Fixtures of the FMI 3.0 tests, and nothing is ever printed."""

import pytest

from support.fmi3 import raw


@pytest.fixture(params=raw.KINDS)
def fmu(request) -> raw.Fmu:
    """One FMU of each kind: what the adapter does is the same for all of a kind."""
    return raw.load(request.param)


@pytest.fixture
def pair() -> raw.Fmu:
    """Two spheres with every choice open"""
    return raw.load("SphereSphere")


@pytest.fixture(autouse=True)
def the_fmu_prints_nothing(capfd):
    """An FMU talks through the logger alone: standard output and standard error stay empty in every test."""
    yield
    printed = capfd.readouterr()
    assert (printed.out, printed.err) == ("", "")
