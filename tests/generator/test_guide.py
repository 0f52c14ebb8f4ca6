"""docs/scenes.md says what the generator reads today, and its example becomes an FMU's files"""

import re

from support.generator.generated import CATALOGUE, ROOT, generate, parse_xml, run

GUIDE = ROOT / "docs" / "scenes.md"


def test_the_guide_to_scene_files_is_current(tmp_path):
    done = run("--guide", tmp_path / "scenes.md")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "scenes.md").read_text(encoding="utf-8") == GUIDE.read_text(encoding="utf-8"), (
        "write it again: python modelDescription/generate.py --guide docs/scenes.md"
    )


def test_the_example_of_the_guide_is_a_scene(tmp_path):
    """run() of generate() allows no warning."""
    text = re.search(r"```toml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)[1]
    (tmp_path / "MarbleOnPipe.toml").write_text(text, encoding="utf-8")
    variables = parse_xml(generate(tmp_path / "MarbleOnPipe.toml", tmp_path / "out")["modelDescription.xml"])
    assert float(variables["marble.center[3]"]["start"]) == 0.3
    assert "pipe.motion" not in variables


def test_the_guide_names_every_parameter_and_input():
    text = GUIDE.read_text(encoding="utf-8")
    for key, row in CATALOGUE["variable"].items():
        name = key.replace("body.", "BODY.").replace("contact.", "CONTACT.")
        if key.startswith("energy."):
            name = key
        assert f"`{name}`" in text, row
