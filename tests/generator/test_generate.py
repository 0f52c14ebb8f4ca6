"""The generator as a program: what it refuses, and that scene.json tells what the scene file does"""

import json
import tomllib

import pytest

from support.generator.generated import FOLDER, ROOT, SCENES, files_of, generate, run, written_out
from support.programs import finished

EXTRA = ROOT / "tests" / "physics" / "scenes" / "ThreeBalls.toml"
FILES = [*(ROOT / "modelDescription" / "scenes" / f"{scene}.toml" for scene in SCENES), EXTRA]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_viewer_is_told_what_the_scene_file_says(file, tmp_path):
    files = generate(file, tmp_path) if file == EXTRA else files_of(file.stem)
    told = json.loads(files["resources/scene.json"])
    scene = written_out(tomllib.loads(file.read_text(encoding="utf-8")))
    for body in told["bodies"]:  # the words of the file
        body |= {"part": body.pop("parts")} if "parts" in body else {}
    for contact in told["contacts"]:
        for end in ("source", "destination"):
            part = contact.pop(f"{end}_part", None)
            contact[end] += f".{part}" if part else ""
    for kind, tables in (("body", told["bodies"]), ("contact", told["contacts"])):
        assert tables == [{key: text for key, text in one.items() if key != "block"} for one in scene[kind]]
    constants = {
        name: value
        for name, value in scene.get("pinned", {}).items()
        if not (isinstance(value, list) and isinstance(value[0], str))  # a choice that keeps some items
    }
    assert told["pinned"] == constants
    assert (told["name"], told["title"], told["format"]) == (scene["name"], scene["title"], 1)


def test_unchanged_files_are_not_written_again(tmp_path):
    icon = ("--icon", tmp_path / "model.png")
    generate(FOLDER / "scenes" / "ForceElement.toml", tmp_path)
    run("--scene", FOLDER / "scenes" / "ForceElement.toml", "--output", tmp_path, *icon)
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
    run("--scene", FOLDER / "scenes" / "ForceElement.toml", "--output", tmp_path, *icon)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


def test_wrong_arguments_say_what_is_needed():
    done = run("--scene", FOLDER / "scenes" / "BallOnSphere.toml")
    assert done.returncode == 2
    assert "--output" in done.stderr


@pytest.mark.parametrize("name, kind", [("contact_core", "SCENES"), ("unit_geometry", "EXTRA_SCENES")])
def test_a_scene_named_like_a_target_of_the_project_is_refused_in_words(tmp_path, quick_python, name, kind):
    """One such target is defined before the scenes, the other one by the tests."""
    text = EXTRA.read_text(encoding="utf-8")
    scene = tmp_path / f"{name}.toml"
    scene.write_text(text.replace('"ThreeBalls"', f'"{name}"'), encoding="utf-8")
    command = ["cmake", "-S", str(ROOT), "-B", str(tmp_path / "build"), "-G", "Ninja", "-DCONTACT_FMI3=OFF"]
    options = [f"-DCONTACT_{kind}={scene}", f"-DPython3_EXECUTABLE={quick_python}"]
    made = finished([*command, *options])
    assert made.returncode != 0
    said = " ".join(made.stderr.split())
    assert f"'name' is '{name}', but this build has another target '{name}' (allowed: any other" in said
