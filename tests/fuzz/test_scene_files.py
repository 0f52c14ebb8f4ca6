"""Whatever stands in a scene file, the generator writes all files or refuses in one line.

Values and keys, characters or bytes change. CONTACT_FUZZ_MINUTES (scripts/fuzz.sh) asks for new ones."""

import contextlib
import io
import os
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

import generate

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "modelDescription"

SCENES = [*sorted((FOLDER / "scenes").glob("*.toml")), ROOT / "tests/physics/scenes/ThreeBalls.toml"]
MINUTES = float(os.environ.get("CONTACT_FUZZ_MINUTES", "0"))
# Words of scene files, a line of them each kind; those that are no single word are in PARTS.
WORDS = """
[[body]] [[contact]] [start] [pinned] [leave_out] [experiment] name shape =
"sphere" "cylinder" "source" "destination" "contact" "free" "fixed" "inside" true
"source.radius" "source.center" "contact.location" "solver.method" gravity outputs []
1e400 -1.0 nan inf 0 1979-05-27 ' { } \\u0000 é ]
"""
PARTS = [*WORDS.split(), "\n", "[0.0, 0.0, 1.0]", '"""']


def renamed(scene: Path) -> str:
    """Its text with the name of the file that `answer` writes"""
    return scene.read_text(encoding="utf-8").replace(f'name = "{scene.stem}', 'name = "Fuzzed', 1)


@st.composite
def texts(draw):
    """A scene file of the repository, some lines of it lost, doubled, swapped or with other words in them"""
    lines = renamed(draw(st.sampled_from(SCENES))).splitlines()
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(lines) - 1))
        action = draw(st.integers(0, 4))
        if action == 0 and len(lines) > 1:
            del lines[at]
        elif action == 1:
            lines.insert(at, lines[draw(st.integers(0, len(lines) - 1))])
        elif action == 2:
            key, equals, _ = lines[at].partition("=")
            lines[at] = key + equals + draw(st.sampled_from(PARTS))
        elif action == 3:
            lines.insert(at, " ".join(draw(st.lists(st.sampled_from(PARTS), max_size=4))))
        else:
            cut = draw(st.integers(0, len(lines[at])))
            lines[at] = lines[at][:cut] + draw(st.text(max_size=4)) + lines[at][cut:]
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def answer(content: bytes) -> bool:
    """Whether the generator understands it and writes all files; if not, it has to refuse in one line"""
    with tempfile.TemporaryDirectory() as folder:
        scene, output = Path(folder, "Fuzzed.toml"), Path(folder, "out")
        scene.write_bytes(content)
        said, wrong = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(wrong):
            try:
                status = generate.main(["--scene", str(scene), "--output", str(output)])
            except SystemExit as end:
                status = end.code
        assert said.getvalue() == ""
        if status in (None, 0):
            etree.parse(output / "modelDescription.xml")
            assert (output / "scene.h").is_file()
            assert all(": warning: " in line for line in wrong.getvalue().splitlines())
        else:
            assert status == 2
            lines = wrong.getvalue().splitlines()
            assert len(lines) == 1 and "Fuzzed.toml" in lines[0]
            assert not output.exists()
        return status in (None, 0)


def fuzz(strategy, seconds: float) -> float:
    """The same 60 examples each time, or new ones until the time is over; what part of them was understood"""
    options = {"deadline": None, "database": None, "suppress_health_check": list(HealthCheck)}

    @settings(max_examples=60, derandomize=seconds == 0, **options)
    @given(strategy)
    def run(content):
        answers.append(answer(content))

    answers: list[bool] = []
    end = time.monotonic() + seconds
    run()
    while time.monotonic() < end:
        run()
    return sum(answers) / len(answers)


def test_a_changed_scene_file_is_understood_or_refused():
    assert 0.02 < fuzz(texts(), 50 * MINUTES) < 0.98  # both happen, or the examples are no good


def test_bytes_are_refused():
    assert fuzz(st.binary(max_size=200), 10 * MINUTES) == 0.0


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_the_unchanged_files_are_understood(scene):
    assert answer(renamed(scene).encode())
