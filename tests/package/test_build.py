"""What `contact-fmus build` says while it works, and where a scene cannot become an FMU that runs"""

import shutil
import stat

import pytest

from contact_fmus.building import cmake_build, command
from contact_fmus.building.cmake_build import find_compiler
from contact_fmus.building.command import build, new
from contact_fmus.errors import RunFailure, UserError
from support.sources import ROOT


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path


@pytest.mark.parametrize("scene", command.SCENES)
def test_a_new_scene_of_many_bodies_is_the_shipped_one_by_another_name(folder, scene):
    assert new(["Mine", "--scene", scene]) == 0  # what the generator has accepted
    shipped = (ROOT / "modelDescription" / "scenes" / f"{command.SCENES[scene]}.toml").read_text(
        encoding="utf-8"
    )
    own = (folder / "Mine.toml").read_text(encoding="utf-8")
    assert own.replace('name = "Mine"', f'name = "{command.SCENES[scene]}"') == shipped


def test_a_scene_that_cannot_be_initialized_is_refused_with_the_sentence_of_the_fmu(folder, capsys):
    """Its steps are told on the way, with the scene, though nobody looks at a terminal."""
    new(["Endless", "--shape", "cylinder", "--pinned", "tube.motion=free", "--pinned", "tube.rotation=free"])
    with pytest.raises(UserError, match="an infinite cylinder has no inertia of its own") as refused:
        build(["Endless.toml", "--fmi", "3"])
    assert "Endless.toml: this scene cannot run: " in str(refused.value)
    assert not (folder / "Endless.fmu").exists()
    told = capsys.readouterr().err.splitlines()
    assert told[:2] == ["Endless: configuring", "Endless: compiling"] and told[-1] == "Endless: initializing"
    assert len([line for line in told if "steps done" in line]) > 1


def test_where_sundials_cannot_be_fetched_one_sentence_names_both_ways_out(folder, monkeypatch):
    new(["Open", "--pinned", 'solver.method=["event_driven", "cvode_bdf"]'])
    said = "CMake Error at sundials-subbuild:\n  Failed to clone repository\nTraceback\n"
    monkeypatch.setattr(cmake_build, "_run", lambda *_arguments: (1, said))
    monkeypatch.setattr("contact_fmus.building.command.find_compiler", lambda *_asked: ["zig"])
    with pytest.raises(RunFailure) as refused:
        build(["Open.toml", "--platforms", "win64"])
    told = str(refused.value)
    assert 'pin "solver.method" = "event_driven"' in told and "--sundials-source" in told
    assert told.startswith("Open.toml: solver.method is open") and "x86_64-windows" in told
    assert "\n" not in told and "Traceback" not in told


@pytest.mark.parametrize("asked", [[], ["--inside"], ["--shape", "cylinder"], ["--shape", "plane"]])
def test_a_new_scene_needs_no_sundials_and_its_bodies_may_be_renamed(asked, folder):
    new(["Mine", *asked])
    text = (folder / "Mine.toml").read_text()
    body = next(word for word in ("globe", "shell", "tube", "floor") if f'"{word}"' in text)
    (folder / "Mine.toml").write_text(text.replace("ball", "marble").replace(body, "thing"))
    scene = cmake_build.check_scene(folder / "Mine.toml", folder / "generated")
    assert not scene.has_cvode
    assert "contact-fmus[plot]" in text


# The compiler that `contact-fmus build` takes: what is asked for, else the first that works


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
