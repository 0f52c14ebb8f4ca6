"""The script on the documentation page of each FMU runs as it stands, and says what it says there"""

import contextlib
import io
import re
import zipfile

import pytest
from lxml import html

from contact_fmus.fmu.files import fmu_file
from support.generator.generated import PAIRS, describe


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
