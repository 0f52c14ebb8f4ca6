"""The pages that the tests look at, and the browser that shows them."""

import pytest

from contact_fmus.__main__ import main
from contact_fmus.fmu.files import fmu_file, repository
from support.browser import Browser


@pytest.fixture(scope="session")
def browser():
    with Browser() as opened:
        yield opened


@pytest.fixture(scope="session")
def sources(request):
    """What `animate` is given, and the FMU behind it, by the name of a case"""

    def find(case):
        if case == "ThreeBalls":
            fmu = request.getfixturevalue("built")["ThreeBalls"]  # no body is called source
            return str(fmu), fmu
        if case == "free_pair":
            return str(repository() / "scripts" / "scenarios" / "free_pair.toml"), fmu_file("SphereSphere")
        return case, fmu_file(case)

    return find


@pytest.fixture(scope="session")
def page_of(sources, tmp_path_factory):
    """The animation of a case, written once"""
    folder, made = tmp_path_factory.mktemp("pages"), {}

    def get(case):
        if case not in made:
            made[case] = folder / f"{case}.html"
            assert main(["animate", sources(case)[0], "-o", str(made[case])]) == 0
        return made[case]

    return get


@pytest.fixture
def shown(browser):
    """A page in the browser; closed again, and nothing may have gone wrong until then"""
    pages = []

    def get(file, ready="window.contactAnimation && contactAnimation.frames > 1", **options):
        pages.append(browser.open(file, **options))
        pages[-1].wait_for(ready)
        return pages[-1]

    yield get
    for page in pages:
        assert (page.complaints, page.requests) == ([], [])
        page.close()


@pytest.fixture
def opened(shown, page_of):
    """The animation of a case"""
    return lambda case, **options: shown(page_of(case), **options)
