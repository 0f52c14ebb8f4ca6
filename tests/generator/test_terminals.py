"""terminalsAndIcons.xml: valid by the schema of FMI 3.0, a terminal for each body, its members variables."""

from pathlib import Path

import fmpy
import matplotlib.image
import numpy as np
import pytest
from lxml import etree

from support.generator.generated import FOLDER, folder_of, run, scene_file

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
    text = (FOLDER / "scenes" / "BallOnSphere.toml").read_text(encoding="utf-8")
    text = text.replace('"BallOnSphere"', '"Two"', 1).replace(
        "[pinned]",
        '[[body]]\nname = "other"\nshape = "sphere"\n\n[[contact]]\nname = "second"\nsource = "source"\n'
        'destination = "other"\n\n[pinned]\n"second.location" = "outside"',
        1,
    )
    scene = tmp_path / "Two.toml"
    scene.write_text(text, encoding="utf-8")
    done = run("--scene", scene, "--output", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    source = terminals(tmp_path / "out", "terminals3")[0]
    forces = {m.get("memberName"): m.get("variableName") for m in source if "force_" in m.get("memberName")}
    assert forces["force_1"] == "contact.source_force"
    assert forces["force_2"] == "second.source_force"


def test_the_svg_shows_the_bodies_where_the_png_does(scene):
    """The middle of a filled shape has its colour on the PNG, unless something is drawn above; a torus is
    both sections of its tube"""
    picture = etree.parse(folder_of(scene) / "icon.svg")
    pixels = np.round(255 * matplotlib.image.imread(folder_of(scene) / "model.png")).astype(int)
    space = "{http://www.w3.org/2000/svg}"
    filled = [one for one in picture.iter(f"{space}circle", f"{space}rect") if one.get("fill") != "none"]
    last = filled[-1]  # the source, which is above all
    if last.tag == f"{space}circle":
        x, y = (int(float(last.get(key))) for key in ("cx", "cy"))
        assert "#" + "".join(f"{value:02x}" for value in pixels[y, x, :3]) == last.get("fill")
    assert len(list(picture.iter(f"{space}polygon"))) == 1
    shapes = len(list(picture.iter(f"{space}circle"))) + len(list(picture.iter(f"{space}rect")))
    drawn = [
        2 if body["shape"] == "torus" else len(body.get("part", [1])) for body in scene_file(scene)["body"]
    ]
    assert shapes == sum(drawn)
