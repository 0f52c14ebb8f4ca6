"""What `contact-fmus build` says while it works, and where a scene cannot become an FMU that runs"""

import pytest

from contact_fmus.building import cmake_build, command
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
