"""The generator as a program: what it writes again, what it refuses."""

from support.generator.generated import FOLDER, generate, run


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
