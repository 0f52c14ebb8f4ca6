"""Animations far from any clone: the wheel brings three.js, which a clone that has none makes"""

import json
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from support.browser import Browser
from support.programs import finished
from support.sources import ROOT

BUNDLE = "contact_fmus/animate/three.bundle.js"


def test_the_wheel_carries_three_js_with_its_licence(wheel):
    with zipfile.ZipFile(wheel) as archive:
        script = archive.read(BUNDLE).decode()
    version = json.loads((ROOT / "package.json").read_text())["devDependencies"]["three"]
    assert "The MIT License" in script[:1000] and "three.js authors" in script[:1000]
    assert f'"{version.split(".")[1]}"' in script  # its REVISION


def test_a_clone_without_three_js_makes_it(tmp_path):
    """Of what git tracks; npm comes from the path"""
    animate = "scripts/contact_fmus/animate"
    for name in (
        "package.json",
        "package-lock.json",
        "scripts/build_backend.py",
        f"{animate}/three_parts.js",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for told in ("made", "already installed"):
        run = finished([sys.executable, "scripts/build_backend.py"], cwd=tmp_path, check=True)
        assert run.stdout == f"three.js: {told}\n"
    made = (tmp_path / animate / "three.bundle.js").read_bytes()
    assert made == (ROOT / animate / "three.bundle.js").read_bytes()


def test_the_source_archive_carries_three_js(far_from_clone, tmp_path):
    command = [sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", tmp_path, ROOT]
    subprocess.run(command, check=True, capture_output=True, env=far_from_clone)
    (file,) = tmp_path.glob("*.tar.gz")
    names = finished(["tar", "tzf", file], check=True).stdout
    assert f"/scripts/{BUNDLE}\n" in names and "/scripts/build_backend.py\n" in names


@pytest.mark.parametrize("command_line", [["animate", "BallInShell"], ["animate", "ball_on_plane"]])
def test_an_animation_of_the_installed_package_draws(command_line, command, tmp_path):
    run = command(*command_line, "-o", "page.html")
    assert (run.returncode, run.stderr) == (0, "")
    with Browser() as browser:
        page = browser.open(tmp_path / "page.html", width=900, height=700)
        page.wait_for("window.contactAnimation && contactAnimation.frames > 1")
        ball = page.run("contactAnimation.project('source')")
        picture = page.picture()
        assert (page.complaints, page.requests) == ([], [])
        top = page.run("document.querySelector('.stage').getBoundingClientRect().top")
        left = page.run("document.querySelector('.stage').getBoundingClientRect().left")
    # The ball has a colour where it is; what is behind it is grey.
    shown = picture[int(top + ball["y"]), int(left + ball["x"])].astype(int)
    assert np.ptp(shown) > 40
