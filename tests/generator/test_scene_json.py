"""resources/scene.json tells what the scene file does: bodies, contacts, pinned values"""

import json
import tomllib

import pytest

from support.generator.generated import ROOT, SCENES, files_of, generate

EXTRA = ROOT / "tests" / "physics" / "scenes" / "ThreeBalls.toml"
FILES = [*(ROOT / "modelDescription" / "scenes" / f"{scene}.toml" for scene in SCENES), EXTRA]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_viewer_is_told_what_the_scene_file_says(file, tmp_path):
    files = generate(file, tmp_path) if file == EXTRA else files_of(file.stem)
    told = json.loads(files["resources/scene.json"])
    scene = tomllib.loads(file.read_text(encoding="utf-8"))
    assert told["bodies"] == scene["body"]
    assert told["contacts"] == scene["contact"]
    constants = {
        name: value
        for name, value in scene.get("pinned", {}).items()
        if not (isinstance(value, list) and isinstance(value[0], str))  # a choice that keeps some items
    }
    assert told["pinned"] == constants
    assert (told["name"], told["title"], told["format"]) == (scene["name"], scene["title"], 1)
