"""docs/scenes.md says what the generator reads today, and its example becomes an FMU's files"""

import contextlib
import io
import re
import zipfile

import pytest
from lxml import html

from contact_fmus.fmu.files import fmu_file
from support.generator.generated import CATALOGUE, PAIRS, ROOT, describe, generate, parse_xml, run

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


# The script on the documentation page of each FMU runs as it stands, and says what it says there


def example(page: str) -> str:
    (script,) = html.fromstring(page).xpath("//h2[@id='use']/following::pre[1]")
    return script.text_content()


@pytest.mark.parametrize("scene", PAIRS)
def test_the_example_of_the_page_runs(scene, tmp_path, monkeypatch):
    fmu = fmu_file(scene)
    with zipfile.ZipFile(fmu) as members:
        script = example(members.read("documentation/index.html").decode())
    compile(script, "example", "exec")
    monkeypatch.chdir(tmp_path)
    (tmp_path / fmu.name).symlink_to(fmu)
    values = {}
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(script, values)
    assert float(said.getvalue()) > 0.0  # a force: every FMU touches with what it starts with
    outputs = re.findall(r'"([\w.]+)"', re.search(r"output=\[(.*)\]", script)[1])
    assert outputs and {"time", *outputs} == set(values["result"].dtype.names)
    assert set(re.findall(r'^ {8}"([\w.]+)":', script, re.MULTILINE)) <= describe(scene).keys()
    if "contact.dashpot" in describe(scene):
        assert "  # unclamped" in script
