"""Extra scenes beside the shipped ones: their names"""

import pytest

from support.programs import finished
from support.sources import ROOT


@pytest.mark.parametrize("name, kind", [("contact_core", "SCENES"), ("unit_geometry", "EXTRA_SCENES")])
def test_a_scene_named_like_a_target_of_the_project_is_refused_in_words(tmp_path, quick_python, name, kind):
    """One such target is defined before the scenes, the other one by the tests."""
    text = (ROOT / "tests" / "physics" / "scenes" / "TwoPairs.toml").read_text(encoding="utf-8")
    scene = tmp_path / f"{name}.toml"
    scene.write_text(text.replace('"TwoPairs"', f'"{name}"'), encoding="utf-8")
    command = ["cmake", "-S", str(ROOT), "-B", str(tmp_path / "build"), "-G", "Ninja", "-DCONTACT_FMI3=OFF"]
    options = [f"-DCONTACT_{kind}={scene}", f"-DPython3_EXECUTABLE={quick_python}"]
    made = finished([*command, *options])
    assert made.returncode != 0
    said = " ".join(made.stderr.split())
    assert f"'name' is '{name}', but this build has another target '{name}' (allowed: any other" in said
