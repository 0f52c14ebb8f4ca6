"""The FMUs of several platforms as one, and universal libraries for macOS"""

import re
import sys
import zipfile

import pytest

from contact_fmus.building.platforms import PLATFORMS, join, toolchains, universal
from contact_fmus.errors import RunFailure, UserError
from support.programs import finished
from support.sources import ROOT

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
    unpack = ["cmake", "-E", "tar", "xf", tmp_path / "small.fmu"]
    run = finished(unpack, cwd=tmp_path)
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
