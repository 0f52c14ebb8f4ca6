"""model.png of each scene shows its bodies where they start"""

import re
from pathlib import Path

import fmpy
import matplotlib.image
import numpy as np
import pytest
from lxml import etree

from support.generator.generated import FOLDER, folder_of, run, scene_file

SOURCE, DESTINATION, FORCE = (243, 217, 184), (216, 226, 236), (187, 0, 0)


def written(name: str, changes: dict, folder: Path) -> Path:
    """Generates `folder`/out and model.png of a scene in which regular expressions are replaced."""
    text = (FOLDER / "scenes" / f"{name}.toml").read_text(encoding="utf-8")
    for pattern, text_for in {f'"{name}"': '"Own"', **changes}.items():
        text = re.sub(pattern, text_for, text, count=1)
    (folder / "Own.toml").write_text(text, encoding="utf-8")
    done = run("--scene", folder / "Own.toml", "--output", folder / "out", "--icon", folder / "model.png")
    assert done.returncode == 0, done.stderr
    return folder


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
    larger = {'"source.center" = .*': '"source.center" = [0.0, 0.0, 0.7]\n"source.radius" = 0.2'}
    pixels = pixels_of(written("BallOnSphere", larger, tmp_path))
    ball, sphere, force = (where(pixels, color) for color in (SOURCE, DESTINATION, FORCE))
    heights = [np.ptp(part[1]) for part in (ball, sphere)]
    assert heights[0] / heights[1] == pytest.approx(0.4, abs=0.04)  # without the outlines
    assert ball[1].mean() < sphere[1].min()
    assert force[1].min() < ball[1].min()
    assert force[0].mean() == pytest.approx(sphere[0].mean(), abs=1.0)


@pytest.mark.parametrize("size", ["1e-150", "1e149"])
def test_extreme_sizes_are_drawn(size, tmp_path):
    start = f'"source.radius" = {size}\n"destination.radius" = {size}\n"source.center" = [0.0, 3.0e0, {size}]'
    extreme = written("SphereSphere", {r"\[experiment]": f"[start]\n{start}\n[experiment]"}, tmp_path)
    assert where(pixels_of(extreme), SOURCE).size > 10


# The next tests hold that terminalsAndIcons.xml is valid by the schema of FMI 3.0, and that each body has a
# terminal, whose members are variables.

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
KIND = "contact-fmus.body"
# FMI 2.0 and FMI 3.0: where the terminals are, the description, the element of a variable
GIVEN = ["prescribed_displacement", "prescribed_velocity", "external_force"]
GIVEN += ["prescribed_angular_velocity", "external_torque"]
MOTION = ["displacement", "position", "velocity", "angular_velocity", "orientation"]
VERSIONS = [("terminals2", "modelDescription.xml"), ("terminals3", "modelDescription3.xml")]


def terminals(folder, which):
    document = etree.parse(folder / which / "terminalsAndIcons.xml")
    etree.XMLSchema(etree.parse(SCHEMA)).assertValid(document)
    return document.findall("Terminals/Terminal")


@pytest.mark.parametrize("which,description", VERSIONS)
def test_every_body_has_a_terminal_whose_members_are_variables(scene, which, description):
    variables = {
        entry.get("name"): entry.get("causality")
        for entry in etree.parse(folder_of(scene) / description).find("ModelVariables")
    }
    found = terminals(folder_of(scene), which)
    assert [entry.get("name") for entry in found] == [body["name"] for body in scene_file(scene)["body"]]
    for terminal in found:
        assert (terminal.get("matchingRule"), terminal.get("terminalKind")) == ("plug", KIND)
        members = {member.get("memberName"): member.get("variableName") for member in terminal}
        assert len(members) == len(terminal)
        assert set(members.values()) <= set(variables)
        force = [name for name in members if name.startswith("force")]
        contacts = [
            one
            for one in scene_file(scene)["contact"]
            if terminal.get("name") in [str(text).partition(".")[0] for text in one.values()]
        ]
        assert len(force) == (3 if which == "terminals2" else 1) * len(contacts)


def test_inputs_and_motion_of_a_body_are_together():
    [source, _] = terminals(folder_of("SphereCylinder"), "terminals3")
    assert {member.get("memberName"): member.get("variableName") for member in source} == {
        **{row: f"source.{row}" for row in [*GIVEN, *MOTION]},
        "force": "contact.source_force",
        "torque": "contact.source_torque",
    }


def test_a_body_in_two_contacts_has_its_forces_numbered(tmp_path):
    second = (
        '[[body]]\nname = "other"\nshape = "sphere"\n\n[[contact]]\nname = "second"\nsource = "source"\n'
        'destination = "other"\n\n[pinned]\n"second.location" = "outside"'
    )
    written("BallOnSphere", {r"\[pinned]": second}, tmp_path)
    source = terminals(tmp_path / "out", "terminals3")[0]
    forces = {m.get("memberName"): m.get("variableName") for m in source if "force_" in m.get("memberName")}
    assert forces["force_1"] == "contact.source_force"
    assert forces["force_2"] == "second.source_force"


def test_the_svg_shows_the_bodies_where_the_png_does(scene):
    """The middle of a filled shape has its colour on the PNG, unless covered; a torus is two sections"""
    picture = etree.parse(folder_of(scene) / "icon.svg")
    pixels = pixels_of(folder_of(scene))
    space = "{http://www.w3.org/2000/svg}"
    filled = [one for one in picture.iter(f"{space}circle", f"{space}rect") if one.get("fill") != "none"]
    last = filled[-1]  # the source, which is above all
    if last.tag == f"{space}circle":
        x, y = (int(float(last.get(key))) for key in ("cx", "cy"))
        assert "#" + "".join(f"{value:02x}" for value in pixels[y, x, :3]) == last.get("fill")
    assert len(list(picture.iter(f"{space}polygon"))) == 1
    shapes = len(list(picture.iter(f"{space}circle"))) + len(list(picture.iter(f"{space}rect")))
    drawn = [2 if b["shape"] == "torus" else len(b.get("part", [1])) for b in scene_file(scene)["body"]]
    assert shapes == sum(drawn)
