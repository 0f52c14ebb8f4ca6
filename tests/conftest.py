"""Shared by all Python tests: FMUs opened once a session and reset for each use, and quick ways to FMUs."""

import contextlib
import shutil
import sys
from collections import Counter

import lark
import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import fmu_file
from support import scene_fmus
from support.checks import DASHPOTS, FMU, METHODS
from support.sources import BUILD, ROOT

# Modules whose builds, checkers and studies take long, by however few tests
LONG = "style determinism report atlas examples layers tutorial animation wheel runs cluster build crash"
LONG = {f"test_{name}" for name in (*LONG.split(), "threads", "both_versions", "extra_scenes", "scene_files")}


def pytest_collection_modifyitems(items):
    """What takes long comes first, then the modules of most tests: at the end no worker waits for another."""
    count = Counter(item.path for item in items)
    items.sort(key=lambda item: (item.path.stem not in LONG, -count[item.path]))


@pytest.fixture(scope="session")
def fmu_path():
    return fmu_file


# A test that takes one of these runs with each, unless it says which.
@pytest.fixture(params=METHODS)
def method(request):
    return request.param


@pytest.fixture(params=DASHPOTS)
def dashpot(request):
    return request.param


@pytest.fixture(params=FMU)
def shape(request):
    return request.param


@contextlib.contextmanager
def instances(path_of):
    """FMU by name, one instance each, which is reset"""
    made = {}
    with contextlib.ExitStack() as stack:

        def get(name):
            if name not in made:
                made[name] = stack.enter_context(ContactFmu(path_of(name), instance_name=name))
            made[name].reset()
            return made[name]

        yield get


@pytest.fixture(scope="session")
def opened(fmu_path):
    with instances(fmu_path) as get:
        yield get


@pytest.fixture(scope="session")
def opened_several(built):
    """As `opened`, of the FMUs of tests/physics/scenes."""
    with instances(built.get) as get:
        yield get


def program(folder, name, text):
    file = folder / name
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return str(file)


@pytest.fixture(scope="session")
def quick_compiler(tmp_path_factory):
    """gcc that optimizes nothing, for FMUs that need not be fast"""
    return program(tmp_path_factory.mktemp("compiler"), "gcc", f'exec {shutil.which("gcc")} "$@" -O0')


@pytest.fixture(scope="session")
def quick_python(tmp_path_factory):
    """Python for CMake that takes what the generator makes of shipped scenes from the build under test"""
    take = f'mkdir -p "$6" && exec cp "{BUILD}/scenes/$(basename "$4" .toml)"/scene* "$6"'
    text = f'case $4 in "{ROOT}"/modelDescription/scenes/*) {take} ;; esac\nexec {sys.executable} "$@"'
    return program(tmp_path_factory.mktemp("python"), "python3", text)


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


@pytest.fixture(scope="session")
def built():
    """The FMUs of tests/physics/scenes, by name"""
    return scene_fmus.built()
