"""The compiler that `contact-fmus build` takes: what is asked for, else the first that works"""

import shutil
import stat

import pytest

from contact_fmus.building.cmake_build import find_compiler
from contact_fmus.errors import UserError


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """Makes programs of these names the only ones on the path"""
    monkeypatch.delenv("CC", raising=False)
    real = shutil.which("gcc")
    scripts = {
        "works": f'#!/bin/sh\nPATH=/usr/bin:/bin exec {real} "$@"\n',
        "no headers": '#!/bin/sh\necho "trial.c:1:10: fatal error: math.h: No such file" >&2\nexit 1\n',
    }

    def put(**kinds):
        for name, kind in kinds.items():
            file = tmp_path / name
            file.write_text(scripts[kind.replace("_", " ")])
            file.chmod(file.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", str(tmp_path))
        return tmp_path

    return put


def test_the_first_that_works_is_taken(programs):
    folder = programs(gcc="no_headers", clang="works", cc="works")
    assert find_compiler(None) == [str(folder / "clang")]


def test_what_is_asked_for_is_taken_with_its_arguments(programs, monkeypatch):
    folder = programs(gcc="works", mine="works")
    assert find_compiler("mine -pipe") == [str(folder / "mine"), "-pipe"]
    monkeypatch.setenv("CC", "mine")
    assert find_compiler(None) == [str(folder / "mine")]
    assert find_compiler("gcc") == [str(folder / "gcc")]


def test_without_one_the_message_says_what_was_tried_and_what_to_install(programs):
    programs(gcc="no_headers")
    with pytest.raises(UserError) as refused:
        find_compiler("gcc")
    assert "gcc: math.h: No such file" in str(refused.value) and "libc6-dev" in str(refused.value)
    with pytest.raises(UserError, match="tcc: not found"):
        find_compiler("tcc")


def test_other_platforms_want_zig_whatever_else_there_is(programs, monkeypatch):
    programs(gcc="works")
    monkeypatch.setattr("contact_fmus.building.cmake_build._packaged", lambda *_: None)
    with pytest.raises(UserError) as refused:
        find_compiler("gcc", "all")
    words = "--platforms all needs zig, which compiles for any platform (zig: not found): pip install"
    assert str(refused.value).startswith(words) and "gcc" not in str(refused.value)
