"""What `contact-fmus build` says while it works, and where a scene cannot become an FMU that runs"""

import re
import shutil
import stat
import sys
import zipfile

import pytest

from contact_fmus.building import cmake_build, command
from contact_fmus.building.cmake_build import find_compiler
from contact_fmus.building.command import build, new
from contact_fmus.building.platforms import PLATFORMS, join, toolchains, universal
from contact_fmus.errors import RunFailure, UserError
from support.programs import finished
from support.sources import ROOT


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch, quick_compiler):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CC", quick_compiler)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path


@pytest.mark.parametrize("scene", command.SCENES)
def test_a_new_scene_of_many_bodies_is_the_shipped_one_by_another_name(folder, scene):
    assert new(["Mine", "--scene", scene]) == 0  # what the generator has accepted
    file = ROOT / "modelDescription" / "scenes" / f"{command.SCENES[scene]}.toml"
    shipped = file.read_text(encoding="utf-8")
    own = (folder / "Mine.toml").read_text(encoding="utf-8")
    assert own.replace('name = "Mine"', f'name = "{command.SCENES[scene]}"') == shipped


def test_a_scene_that_cannot_be_initialized_is_refused_with_the_sentence_of_the_fmu(folder, capsys):
    """Its steps are told on the way, with the scene, though nobody looks at a terminal."""
    new(["Fills", "--shape", "torus"])
    scene = folder / "Fills.toml"
    text = scene.read_text().replace('"ball.radius" = 0.1', '"ball.radius" = 0.6')
    scene.write_text(text.replace("[1.0, 0.0, 1.0]", "[1.0, 0.0, 3.0]"))
    with pytest.raises(UserError, match=r"contradicts ring\.ring_radius") as refused:
        build(["Fills.toml", "--fmi", "3"])
    assert "Fills.toml: this scene cannot run: " in str(refused.value)
    assert not (folder / "Fills.fmu").exists()
    told = capsys.readouterr().err.splitlines()
    assert told[:2] == ["Fills: configuring", "Fills: compiling"] and told[-1] == "Fills: initializing"
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
    assert not cmake_build.check_scene(folder / "Mine.toml", folder / "generated").has_cvode
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


# The FMUs of several platforms as one, and universal libraries for macOS

# The first twelve bytes of a library for macOS: magic, processor, variant (mach/machine.h).
INTEL = bytes.fromhex("cffaedfe 07000001 03000000")
APPLE = bytes.fromhex("cffaedfe 0c000001 00000000")


def fmu(folder, name, **members):
    file = folder / f"{name}.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        for member, content in members.items():
            archive.writestr(member.replace("__", "/"), content)
    return file


def test_every_platform_has_its_toolchain_file_and_all_means_all():
    files = {file.stem for file in (ROOT / "cmake" / "platforms").glob("*.cmake")} - {"zig"}
    assert set(toolchains("all")) == files
    assert toolchains("win64, linux64,win64") == ["x86_64-windows", "x86_64-linux"]
    with pytest.raises(UserError, match=f"'amiga' .allowed: all, {', '.join(PLATFORMS)}"):
        toolchains("linux64,amiga")


def test_a_universal_library_says_where_its_parts_are():
    content = universal([INTEL + b"first\0", APPLE + b"second\0"])
    assert content[:8] == bytes.fromhex("cafebabe 00000002")
    for begin, part in ((8, INTEL + b"first\0"), (28, APPLE + b"second\0")):
        offset, size = (int.from_bytes(content[begin + k : begin + k + 4], "big") for k in (8, 12))
        assert offset % 0x4000 == 0 and content[offset : offset + size] == part
    assert content.endswith(b"second\0")


def test_joining_keeps_every_binary_and_gives_the_same_bytes_again(tmp_path):
    first = fmu(tmp_path, "a", **{"modelDescription.xml": "x", "binaries__win64__x.dll": "w"})
    second = fmu(tmp_path, "b", **{"modelDescription.xml": "x", "binaries__linux64__x.so": "l"})
    for name in ("one", "two"):
        join([first, second], tmp_path / f"{name}.fmu")
    assert (tmp_path / "one.fmu").read_bytes() == (tmp_path / "two.fmu").read_bytes()
    with zipfile.ZipFile(tmp_path / "one.fmu") as archive:
        names = ["modelDescription.xml", "binaries/linux64/x.so", "binaries/win64/x.dll"]
        assert archive.namelist() == names


def test_a_joined_fmu_is_the_same_in_fewer_bytes(tmp_path, monkeypatch):
    """For Python and for libarchive, which CMake has; a file that deflate only makes longer is stored"""
    text = (ROOT / "fmu_src" / "fmi" / "instance.c").read_text()
    first = fmu(tmp_path, "a", **{"modelDescription.xml": text, "binaries__win64__x.dll": "w", "empty": ""})
    join([first], tmp_path / "small.fmu")
    monkeypatch.setitem(sys.modules, "zopfli", None)  # as if it were not installed
    join([first], tmp_path / "usual.fmu")
    run = finished(["cmake", "-E", "tar", "xf", tmp_path / "small.fmu"], cwd=tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    assert (tmp_path / "modelDescription.xml").read_text() == text
    with zipfile.ZipFile(tmp_path / "small.fmu") as small, zipfile.ZipFile(tmp_path / "usual.fmu") as usual:
        assert small.testzip() is None
        for one, other in zip(small.infolist(), usual.infolist(), strict=True):
            assert small.read(one) == usual.read(other)
            assert (one.filename, one.date_time) == (other.filename, other.date_time)
            assert (one.external_attr, one.create_system) == (other.external_attr, other.create_system)
            assert one.compress_type in (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED)
        assert small.getinfo("binaries/win64/x.dll").compress_type == zipfile.ZIP_STORED
        text, plain = (archive.getinfo("modelDescription.xml") for archive in (small, usual))
        assert text.compress_size < 0.98 * plain.compress_size


def test_descriptions_that_differ_are_not_joined(tmp_path):
    first = fmu(tmp_path, "a", **{"modelDescription.xml": "x"})
    second = fmu(tmp_path, "b", **{"modelDescription.xml": "y"})
    with pytest.raises(RunFailure, match=re.escape("modelDescription.xml differs")):
        join([first, second], tmp_path / "joined.fmu")
