"""modelDescription.xml: structure of a co-simulation slave, what a scene has and has not."""

import math
import re
import shutil
import subprocess
import sys

import pytest
from lxml import etree

from support.generator import generated
from support.generator.turning_page import assert_the_page_explains_turning

PINNED = [scene for scene in generated.PAIRS if generated.scene_file(scene).get("pinned")]
UNIVERSAL = {"sphere": "SphereSphere", "cylinder": "SphereCylinder", "plane": "SpherePlane"}
UNIVERSAL |= {"torus": "SphereTorus"}


def test_the_description_is_ascii(scene):
    """VDMCheck2 takes one byte for one character; symbols are written as character references."""
    assert (generated.folder_of(scene) / "modelDescription.xml").read_bytes().isascii()
    contact = generated.scene_file(scene)["contact"][0]["name"]
    assert generated.describe(scene)[f"{contact}.gap_rate"]["description"].endswith("(ġ)")


def test_attributes_of_the_slave(scene):
    root = etree.parse(generated.folder_of(scene) / "modelDescription.xml").getroot()
    slave = dict(root.find("CoSimulation").attrib)
    both = ("canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative")
    able = {"modelIdentifier": scene} | dict.fromkeys(both, "true")
    steps = {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true"}
    assert slave == able | steps | {"maxOutputDerivativeOrder": "2"}
    exchange = dict(root.find("ModelExchange").attrib)
    assert exchange == able | {"completedIntegratorStepNotNeeded": "false"}
    for attribute in ("description", "author", "version", "copyright", "license", "generationTool"):
        assert root.get(attribute)
    assert root.get("variableNamingConvention") == "structured"
    assert root.get("generationDateAndTime") is None
    categories = [category.get("name") for category in root.find("LogCategories")]
    levels = ["Warning", "Discard", "Error", "Fatal"]
    assert categories == ["logEvents", *(f"logStatus{level}" for level in levels), "logAll"]


def test_model_structure_lists_all_outputs_and_all_unknowns(scene):
    root = etree.parse(generated.folder_of(scene) / "modelDescription.xml").getroot()
    names = list(generated.describe(scene))
    listed = {
        part: [names[int(entry.get("index")) - 1] for entry in root.find(f"ModelStructure/{part}")]
        for part in ("Outputs", "Derivatives", "InitialUnknowns")
        if part != "Derivatives" or root.find("ModelStructure/Derivatives") is not None
    }
    of = {name: entry["causality"] for name, entry in generated.describe(scene).items()}
    role = {name: generated.row_of(name, generated.scene_file(scene))[1].get("role") for name in names}
    assert sorted(listed.get("Derivatives", [])) == sorted([name for name in names if role[name] == "rate"])
    assert int(root.get("numberOfEventIndicators")) == sum(one == "indicator" for one in role.values())
    assert listed["Outputs"] == [name for name in names if of[name] == "output"]
    assert listed["InitialUnknowns"] == [
        name
        for name in names
        if of[name] in ("output", "calculatedParameter") or role[name] in ("state", "rate")
    ]


def test_each_rate_names_its_state_and_stands_in_the_order_of_the_states(scene):
    root = etree.parse(generated.folder_of(scene) / "modelDescription.xml").getroot()
    scalars = root.findall("ModelVariables/ScalarVariable")
    names = [scalar.get("name") for scalar in scalars]
    rows = {name: generated.row_of(name, generated.scene_file(scene)) for name in names}
    order = [
        int(scalars[int(entry.get("index")) - 1][0].get("derivative"))
        for entry in root.findall("ModelStructure/Derivatives/Unknown")
    ]
    assert order == [i for i, name in enumerate(names, 1) if rows[name][1].get("role") == "state"]
    for scalar in scalars:
        name, value = scalar.get("name"), scalar[0]
        of = rows[name][1].get("rate_of")
        if of is None:
            assert value.get("derivative") is None
            continue
        state = names[int(value.get("derivative")) - 1]
        assert (rows[state][0], state[-3:]) == (of, name[-3:] if name.endswith("]") else state[-3:])
        assert state.partition(".")[0] == name.partition(".")[0]


def felt_at_once(output, scene):
    """Input or state -> dependenciesKind of an output, from the names and the rows of variables.toml alone"""
    _, row = generated.row_of(output, generated.scene_file(scene))
    owner, component = output.partition(".")[0], output.removeprefix(generated.whole(output))
    pairs = {  # of compounds a contact names the part, as in foot.heel
        one["name"]: [one[end].partition(".")[0] for end in ("source", "destination")]
        for one in generated.scene_file(scene)["contact"]
    }
    names = [body["name"] for body in generated.scene_file(scene)["body"]]
    bodies = [owner] if owner in names else pairs.get(owner, names)
    met = pairs if owner not in pairs else [owner]  # contacts whose springs it feels
    if owner in names and "contact.spring_state" in row.get("depends", {}):  # a sum over its contacts
        met = [contact for contact, pair in pairs.items() if owner in pair]
        bodies = sorted({body for contact in met for body in pairs[contact]})
    found = {}
    for key, kind in row.get("depends", {}).items():
        group, _, field = key.partition(".")
        for one in {"body": bodies, "contact": met}.get(group, [group]):
            felt = [name for name in generated.describe(scene) if generated.whole(name) == f"{one}.{field}"]
            if group == "body" and len(bodies) == 1 and kind == "fixed":
                felt = [name for name in felt if name.endswith(component)]
            found |= dict.fromkeys(felt, kind)
    return found


def test_outputs_depend_on_the_inputs_and_states_that_their_rows_name(scene):
    root = etree.parse(generated.folder_of(scene) / "modelDescription.xml").getroot()
    names = list(generated.describe(scene))
    for entry in root.find("ModelStructure/Outputs"):
        inputs = [names[int(index) - 1] for index in entry.get("dependencies").split()]
        kinds = (entry.get("dependenciesKind") or "").split()
        assert inputs == sorted(inputs, key=names.index)
        output = names[int(entry.get("index")) - 1]
        assert dict(zip(inputs, kinds, strict=True)) == felt_at_once(output, scene), output


# Units by hand from the definitions of the SI: exponents of kg, m, s, rad.
SI = {
    "1": (0, 0, 0, 0), "m": (0, 1, 0, 0), "s": (0, 0, 1, 0), "kg": (1, 0, 0, 0), "m/s": (0, 1, -1, 0),
    "m/s2": (0, 1, -2, 0), "N": (1, 1, -2, 0), "N/m": (1, 0, -2, 0), "N.s/m": (1, 0, -1, 0),
    "Pa": (1, -1, -2, 0), "J": (1, 2, -2, 0), "W": (1, 2, -3, 0), "s/m": (0, -1, 1, 0),
    "rad/s": (0, 0, -1, 1), "rad/s2": (0, 0, -2, 1), "1/s": (0, 0, -1, 0), "N.m": (1, 2, -2, 0),
    "rad": (0, 0, 0, 1), "N.m/rad": (1, 2, -2, -1), "N.m.s/rad": (1, 2, -1, -1),
    "kg.m2": (1, 2, 0, 0),
    "N/m1.5": None,  # FMI has no half exponents
}  # fmt: skip
PREFIX = {"mm": 1e3, "ms": 1e3, "g": 1e3, "mm/s": 1e3, "kN": 1e-3, "N/mm": 1e-3, "N.s/mm": 1e-3, "MPa": 1e-6}
PREFIX |= {"mJ": 1e3, "N.mm": 1e3, "rpm": 30.0 / math.pi, "deg/s": 180.0 / math.pi, "deg/s2": 180.0 / math.pi}
PREFIX |= {"deg": 180.0 / math.pi}


def test_units_are_those_of_the_si(scene):
    root = etree.parse(generated.folder_of(scene) / "modelDescription.xml").getroot()
    units = {unit.get("name"): unit for unit in root.find("UnitDefinitions")}
    assert units.keys() == {entry["unit"] for entry in generated.describe(scene).values() if entry["unit"]}
    for name, unit in units.items():
        base = unit.find("BaseUnit")
        exponents = base if base is None else tuple(int(base.get(key, 0)) for key in ("kg", "m", "s", "rad"))
        assert exponents == SI[name]
        for display in unit.iterchildren("DisplayUnit"):
            assert float(display.get("factor")) == PREFIX[display.get("name")]


@pytest.mark.parametrize("scene", PINNED)
def test_a_pinned_scene_has_fewer_variables_than_the_universal_one(scene):
    source, destination = (body["shape"] for body in generated.scene_file(scene)["body"])
    universal = "CylinderCylinder" if source == "cylinder" else UNIVERSAL[destination]
    assert generated.describe(scene).keys() < generated.describe(universal).keys()
    assert (
        generated.table()[scene]["variables"]
        == len(generated.describe(scene))
        < generated.table()[universal]["variables"]
    )
    assert generated.table()[scene]["value_bytes"] < generated.table()[universal]["value_bytes"]


def test_the_force_element_has_at_most_43_percent_of_the_variables():
    assert len(generated.describe("ForceElement")) <= 0.43 * len(generated.describe("SphereCylinder"))


def test_the_force_element_has_no_solver_and_no_energies():
    groups = {name.partition(".")[0].partition("[")[0] for name in generated.describe("ForceElement")}
    assert groups == {"source", "contact", "destination"}
    assert "set(SCENE_HAS_CVODE OFF)" in generated.files_of("ForceElement")["scene.cmake"]
    assert "SUNDIALS" not in generated.files_of("ForceElement")["documentation/index.html"]


def test_the_methods_offered_are_those_of_the_solver():
    methods = generated.describe("SphereSphere")["solver.method"]["items"]
    assert methods == {"event_driven": 1, "cvode_bdf": 2, "cvode_adams": 3}


@pytest.mark.parametrize("scene", generated.PAIRS)
def test_the_page_explains_only_what_the_scene_has(scene):
    page = (generated.folder_of(scene) / "documentation" / "index.html").read_text(encoding="utf-8")
    names = {name.partition("[")[0] for name in generated.describe(scene)}
    cylinder = generated.scene_file(scene)["body"][1]["shape"] == "cylinder"
    assert ("cylinder from the side" in page) == cylinder
    assert ("gap_beyond_ends" in page) == ("contact.gap_beyond_ends" in names)
    assert ("<code>approach_only</code>" in page) == ("contact.dashpot" in names)
    assert ("Automatic factors" in page) == ("contact.reference_modulus" in names)
    assert ("Motion and energy" in page) == ("energy.total" in names)
    if "source.prescribed_velocity" in names:
        assert "prescribed_velocity" in page
    assert_the_page_explains_turning(page, scene)
    assert set(re.findall(r"\bprescribed_\w+", page)) <= {name.rpartition(".")[2] for name in names}
    for name in re.findall(r"<code>((?:source|destination|contact|energy|solver)\.\w+)", page):
        assert name in names or name in generated.scene_file(scene)["pinned"]


@pytest.mark.parametrize("scene", ["SphereCylinder", "ForceElement", "PinnedEvent"])
def test_the_same_input_gives_the_same_bytes_anywhere(tmp_path, scene):
    """From a copy of modelDescription in another folder, called from there."""
    copy = tmp_path / "another place" / "modelDescription"
    shutil.copytree(generated.FOLDER, copy, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(generated.ROOT / "LICENSE", copy.parent)
    arguments = ["--scene", copy / "scenes" / f"{scene}.toml", "--output", tmp_path / "out"]
    subprocess.run([sys.executable, "-B", copy / "generate.py", *arguments], check=True, cwd=tmp_path)
    assert generated.texts_in(tmp_path / "out") == generated.files_of(scene)


def test_the_guid_changes_with_what_is_compiled_in(tmp_path):
    """A constant shows nowhere in the description, and yet makes another FMU."""
    text = (generated.FOLDER / "scenes" / "BallOnSphere.toml").read_text().replace("BallOnSphere", "Own")
    (tmp_path / "scene.toml").write_text(text)
    (tmp_path / "other.toml").write_text(text.replace("[pinned]", '[pinned]\n"source.mass" = 2.0'))
    (tmp_path / "third.toml").write_text(text.replace("[pinned]", '[pinned]\n"source.mass" = 3.0'))
    guids = set()
    for name in ("scene", "other", "third"):
        files = generated.generate(tmp_path / f"{name}.toml", tmp_path / name)
        guid = re.search(r'guid="(\{[0-9a-f-]{36}\})"', files["modelDescription.xml"])[1]
        assert f'#define SCENE_GUID "{guid}"' in files["scene.h"]
        assert f"#define SCENE_HASH 0x{guid[1:9]}u" in files["scene.h"]
        guids.add(guid)
    assert len(guids) == 3


def test_every_licence_of_what_is_inside_is_named(scene):
    folders = [folder / "documentation" for folder in (generated.folder_of(scene), generated.FOLDER)]
    page = (folders[0] / "index.html").read_text(encoding="utf-8")
    for link in re.findall(r'href="(licenses/[^"]+)"', page):
        assert any((folder / link).is_file() for folder in folders)
    licence = (folders[0] / "licenses" / "license.txt").read_text(encoding="utf-8")
    assert licence == (generated.ROOT / "LICENSE").read_text(encoding="utf-8")
