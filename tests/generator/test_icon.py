"""model.png of each scene shows its bodies where they start"""

import re
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from support.generator.generated import FOLDER, folder_of, run

SOURCE, DESTINATION, FORCE = (243, 217, 184), (216, 226, 236), (187, 0, 0)


def icon(scene: Path, folder: Path) -> np.ndarray:
    done = run("--scene", scene, "--output", folder / "out", "--icon", folder / "model.png")
    assert done.returncode == 0, done.stderr
    return pixels_of(folder)


def pixels_of(folder: Path) -> np.ndarray:
    return np.round(255 * matplotlib.image.imread(folder / "model.png")).astype(int)


def where(pixels: np.ndarray, color: tuple) -> np.ndarray:
    """Columns and rows of the pixels of a colour"""
    rows, columns = np.nonzero((pixels[..., :3] == color).all(axis=-1) & (pixels[..., 3] == 255))
    return np.array([columns, rows])


def test_every_scene_has_an_icon_with_its_bodies_and_a_force(scene):
    pixels = pixels_of(folder_of(scene))
    assert pixels.shape == (200, 200, 4)
    assert where(pixels, SOURCE).size > 100
    assert where(pixels, FORCE).size > 100
    hollow = scene in ("BallInShell", "GolfersDilemma", "GroovedBearing", "PinInHole", "PinJoint")
    assert (where(pixels, DESTINATION).size == 0) == hollow
    # Nothing is behind it.
    assert pixels[0, 0, 3] == 0 or scene in ("SphereCylinder", "ForceElement", "GaltonBoard")


def test_bodies_are_drawn_to_scale_and_above_each_other(tmp_path):
    """A ball of 0.2 m on a sphere of 0.5 m: the ball is above, the force goes away from the sphere"""
    text = (FOLDER / "scenes" / "BallOnSphere.toml").read_text(encoding="utf-8")
    text = re.sub(r'"source.center" = .*', '"source.center" = [0.0, 0.0, 0.7]\n"source.radius" = 0.2', text)
    scene = tmp_path / "Own.toml"
    scene.write_text(text.replace("BallOnSphere", "Own"), encoding="utf-8")
    pixels = icon(scene, tmp_path)
    ball, sphere, force = (where(pixels, color) for color in (SOURCE, DESTINATION, FORCE))
    heights = [np.ptp(part[1]) for part in (ball, sphere)]
    assert heights[0] / heights[1] == pytest.approx(0.4, abs=0.04)  # without the outlines
    assert ball[1].mean() < sphere[1].min()
    assert force[1].min() < ball[1].min()
    assert force[0].mean() == pytest.approx(sphere[0].mean(), abs=1.0)


@pytest.mark.parametrize("size", ["1e-150", "1e149"])
def test_extreme_sizes_are_drawn(size, tmp_path):
    text = (FOLDER / "scenes" / "SphereSphere.toml").read_text(encoding="utf-8")
    text = text.replace("SphereSphere", "Own")
    scene = tmp_path / "Own.toml"
    start = f'"source.radius" = {size}\n"destination.radius" = {size}\n"source.center" = [0.0, 3.0e0, {size}]'
    scene.write_text(text.replace("[experiment]", f"[start]\n{start}\n[experiment]"), encoding="utf-8")
    assert where(icon(scene, tmp_path), SOURCE).size > 10
