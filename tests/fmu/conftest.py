"""Fixtures of the FMU tests, and nothing is ever printed."""

import pytest

from support.checks import the_fmu_prints_nothing
from support.fmi2 import raw

__all__ = ["the_fmu_prints_nothing"]


@pytest.fixture(params=raw.KINDS)
def fmu(request) -> raw.Fmu:
    """One FMU of each kind: what the adapter does is the same for all of a kind."""
    return raw.load(request.param)


@pytest.fixture
def instance(fmu):
    """One that is just made; freed at the end of the test"""
    with raw.Instance(fmu) as made:
        yield made


@pytest.fixture(params=raw.SCENES)
def every_fmu(request) -> raw.Fmu:
    """For what a scene's own table of variables says"""
    return raw.load(request.param)


@pytest.fixture
def universal() -> raw.Fmu:
    """The FMU with every choice open"""
    return raw.load("SphereCylinder")
