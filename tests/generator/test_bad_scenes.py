"""A wrong scene file gives one line that names the file, the key and what is allowed, and exit status 2."""

import tomllib
from pathlib import Path

import pytest

from support.generator.generated import FOLDER, refused, run

GOOD = """
name = "Pair"
title = "A pair"
description = "For tests."

[[body]]
name = "source"
shape = "sphere"

[[body]]
name = "destination"
shape = "cylinder"

[[contact]]
name = "contact"
source = "source"
destination = "destination"

[start]
"destination.center" = [0.0, 2.0, 0.0]
"source.radius" = 0.2

[pinned]
"contact.location" = "outside"

[leave_out]
outputs = []

[experiment]
stop_time = 1.0
"""

PLACES = """"destination.center" = [0.0, 2.0, 0.0]
"source.radius" = 0.2"""

BAD = tomllib.loads(Path(__file__).with_name("bad_scenes.toml").read_text(encoding="utf-8"))


@pytest.fixture
def answer(tmp_path):
    def ask(text):
        file = tmp_path / "scenes" / "Pair.toml"
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return run("--scene", file, "--output", tmp_path / "out")

    return ask


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_the_good_scene_is_good_with_a_byte_order_mark_too(answer, mark):
    done = answer(mark + GOOD.encode())
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("case", BAD)
def test_a_bad_scene_file_is_refused_in_one_line(answer, tmp_path, case):
    old, new, says = BAD[case]
    assert old in GOOD
    refused(answer(GOOD.replace(old, new, 1)), "scenes/Pair.toml: ", *says)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("start", "depth"), [
    ('"source.center" = [0.0, 0.3, 0.0]', "0.3 m deep"),  # of 0.1 + 0.5 m, outside as pinned
    ('"source.center" = [0.0, 0.7, 0.0]\n"source.initial_displacement" = [0.0, -0.15, 0.0]', "0.05 m deep"),
    ('"destination.axis" = [3.0, 0.0, 0.0]\n"source.center" = [9.0, 0.0, 0.585]', "0.015 m deep"),
])  # fmt: skip
def test_a_deep_overlap_at_the_start_is_warned_of(answer, start, depth):
    done = answer(GOOD.replace(PLACES, start))
    assert done.returncode == 0
    assert "scenes/Pair.toml: warning: source starts " in done.stderr
    assert depth in done.stderr and "under [start]" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("start", [
    '"source.center" = [0.0, 0.591, 0.0]',  # 9 mm, less than a tenth of 0.1 m
    '"source.center" = [0.0, 0.3, 9.0]\n"destination.finite_length" = true',  # beyond the end
    '"source.center" = [0.0, 0.3, 0.0]\n"source.motion" = "prescribed"\n'
    '"source.prescribed_displacement" = [0.0, 0.3, 0.0]',
])  # fmt: skip
def test_a_little_overlap_or_none_is_not_warned_of(answer, start):
    done = answer(GOOD.replace(PLACES, start))
    assert (done.returncode, done.stderr) == (0, "")


def test_a_file_of_other_bytes_or_none_is_refused(answer):
    refused(answer(GOOD.encode("utf-16")), "scenes/Pair.toml: ", "not valid UTF-8")
    refused(answer(b""), "scenes/Pair.toml: ", "'name' is missing")


def test_a_missing_file_is_refused(tmp_path):
    refused(run("--scene", tmp_path / "None.toml", "--output", tmp_path), "None.toml: ", "cannot be read")


def test_a_bad_scene_in_the_table_is_refused(tmp_path):
    file = tmp_path / "Bad.toml"
    file.write_text("name = 1\n")
    refused(run("--table", "--scene", FOLDER / "scenes" / "BallOnSphere.toml", "--scene", file), "Bad.toml: ")


def test_an_output_folder_that_cannot_be_made_is_refused(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    refused(
        run("--scene", FOLDER / "scenes" / "BallOnSphere.toml", "--output", blocked / "sub"),
        "cannot be written",
    )
