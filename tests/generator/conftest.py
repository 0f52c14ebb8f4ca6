"""A test that takes a scene runs with each of the repository, unless it says which."""

import pytest

from support.generator.generated import SCENES


@pytest.fixture(params=SCENES)
def scene(request):
    return request.param
