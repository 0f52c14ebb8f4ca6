"""Extra scenes beside the shipped ones: their names, and FMUs of scenes that are gone."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_an_fmu_whose_scene_is_gone_is_removed(built):
    folder = built["ThreeBalls"].parent
    assert sorted(path.stem for path in folder.glob("*.fmu")) == sorted(built)


def test_a_scene_named_like_a_target_of_the_project_is_refused_in_words(built, tmp_path):
    """Of one that is defined before the scenes, and of one that the tests define"""
    text = (ROOT / "tests" / "physics" / "scenes" / "TwoPairs.toml").read_text(encoding="utf-8")
    for name in ("contact_core", "unit_geometry"):
        scene = tmp_path / f"{name}.toml"
        scene.write_text(text.replace('"TwoPairs"', f'"{name}"'), encoding="utf-8")
        command = ["cmake", "-B", str(built["ThreeBalls"].parents[1]), f"-DCONTACT_EXTRA_SCENES={scene}"]
        made = subprocess.run(command, capture_output=True, text=True)
        assert made.returncode != 0
        said = " ".join(made.stderr.split())
        assert f"'name' is '{name}', but this build has another target '{name}' (allowed: any other" in said
