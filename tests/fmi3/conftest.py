"""Fixtures of the FMI 3.0 tests, and nothing is ever printed."""

import pytest

from support.checks import the_fmu_prints_nothing
from support.fmi3 import raw

__all__ = ["the_fmu_prints_nothing"]


@pytest.fixture(params=raw.KINDS)
def fmu(request) -> raw.Fmu:
    """One FMU of each kind: what the adapter does is the same for all of a kind."""
    return raw.load(request.param)


@pytest.fixture
def pair() -> raw.Fmu:
    """Two spheres with every choice open"""
    return raw.load("SphereSphere")
