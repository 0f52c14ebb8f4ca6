"""Families of scenes with several contacts, whose FMUs are built for the tests."""

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu


@pytest.fixture(scope="module")
def opened_several(built):
    """As `opened`, of the FMUs of tests/physics/scenes."""
    instances = {}

    def get(name):
        if name not in instances:
            instances[name] = ContactFmu(built[name], instance_name=name).__enter__()
        return instances[name]

    yield get
    for instance in instances.values():
        instance.__exit__(None, None, None)
