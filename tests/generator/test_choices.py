"""`choices = "integer"`: enumerations become Integers, and nothing else changes."""

import re

import pytest

from support.generator.generated import CATALOGUE, SCENES, generate, parse_xml, run, scene_file
from support.generator.generated import FOLDER as DESCRIPTION

ENUMERATIONS = {name: entry["items"] for name, entry in CATALOGUE["type"].items() if "items" in entry}


def with_choices(scene, choices, tmp_path):
    folder = tmp_path / f"{scene}-{choices}"
    path = tmp_path / f"{choices}.toml"
    text = (DESCRIPTION / "scenes" / f"{scene}.toml").read_text()
    # A key of the file itself stands before the first table.
    path.write_text(f'choices = "{choices}"\n{text}'.replace(f'"{scene}"', f'"{scene}X"', 1))
    return generate(path, folder)


@pytest.fixture(params=["SphereCylinder", "ForceElement"])
def both(request, tmp_path):
    return [with_choices(request.param, choices, tmp_path) for choices in ("enumeration", "integer")]


def test_no_enumeration_is_left(both):
    assert "Enumeration" in both[0]["modelDescription.xml"]
    assert "Enumeration" in both[0]["modelDescription3.xml"]
    for name in ("modelDescription.xml", "modelDescription3.xml"):
        assert "Enumeration" not in both[1][name]
    assert "VARIABLE_ENUMERATION" in both[0]["scene_variables.c"]
    assert "VARIABLE_ENUMERATION" not in both[1]["scene_variables.c"]


def test_a_choice_is_an_integer_with_range_and_items_in_its_description(both):
    plain, whole = (parse_xml(files["modelDescription.xml"]) for files in both)
    assert list(plain) == list(whole)
    changed = [name for name in plain if plain[name] != whole[name]]
    assert changed == [name for name in plain if plain[name]["base"] == "Enumeration"] != []
    for name in changed:
        before, after = plain[name], whole[name]
        assert after["base"] == "Integer"
        changed = {key for key in before if before[key] != after[key]}
        assert changed <= {"base", "description", "items", "quantity"}
        items = dict(re.findall(r"(\d) = (\w+)", after["description"]))
        kind = next(kind for kind in ENUMERATIONS.values() if set(kind) == set(items.values()))
        assert {int(number): item for number, item in items.items()} == {
            entry["value"]: item for item, entry in kind.items()
        }


def test_the_code_differs_in_the_identity_alone(both):
    def without_identity(text):
        return re.sub(r"#define SCENE_(GUID|TOKEN|HASH) .*", "", text)

    assert without_identity(both[0]["scene.h"]) == without_identity(both[1]["scene.h"])
    integers = both[0]["scene_variables.c"].replace("VARIABLE_ENUMERATION", "VARIABLE_INTEGER")
    assert integers == both[1]["scene_variables.c"]
    assert both[0]["resources/scene.json"] == both[1]["resources/scene.json"]


def test_the_default_is_enumerations():
    assert all("choices" not in scene_file(scene) for scene in SCENES)


def test_the_option_stands_above_the_file(tmp_path):
    scene = DESCRIPTION / "scenes" / "SphereSphere.toml"
    done = run("--scene", scene, "--output", tmp_path, "--choices", "integer")
    assert (done.returncode, done.stderr) == (0, "")
    assert "Enumeration" not in (tmp_path / "modelDescription.xml").read_text()


def test_another_word_is_refused(tmp_path):
    path = tmp_path / "Odd.toml"
    text = (DESCRIPTION / "scenes" / "SphereSphere.toml").read_text()
    path.write_text('choices = "text"\n' + text.replace('"SphereSphere"', '"Odd"', 1))
    done = run("--scene", path, "--output", tmp_path)
    assert done.returncode == 2
    assert "'choices' is 'text' (allowed: enumeration, integer)" in done.stderr
