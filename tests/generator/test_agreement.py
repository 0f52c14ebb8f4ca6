"""The description, the C table and the page of every scene say the same, and what variables.toml says."""

import re

import pytest

from support.generator import generated
from support.generator.agreement import disagreements
from support.generator.freeze_references import current, read_frozen


def test_all_generated_files_agree_with_variables_toml(scene):
    assert disagreements(generated.files_of(scene), generated.scene_file(scene)) == []


# file, what to change, into what: each a slip of one hand edit that must not pass.
ALTERATIONS = [
    ("modelDescription.xml", r'(name="source.radius" valueReference=")101', r"\g<1>102"),
    ("modelDescription.xml", r'(name="contact.penalty_factor"[\s\S]*?start=")1000000.0', r"\g<1>1000001.0"),
    ("modelDescription.xml", r'(name="destination.radius"[\s\S]*?min=")1e-150', r"\g<1>0.0"),
    ("modelDescription.xml", r'(name="contact.gap_rate"[\s\S]*?unit=")m/s', r"\g<1>m"),
    ("modelDescription.xml", r'(name="contact.gap" [^>]*causality=")output', r"\g<1>local"),
    ("modelDescription.xml", r'(<Item name="unclamped" value=")2', r"\g<1>4"),
    ("modelDescription.xml", r"Radius of source", "Diameter of source"),
    ("modelDescription.xml", r'(name="contact.penalty_factor"[^>]*variability=")tunable', r"\g<1>fixed"),
    ("scene_variables.c", r'("contact.dashpot", [^\n]*, )1\},', r"\g<1>0},"),
    ("documentation/index.html", r"tunable (parameter, PenaltyFactor)", r"\g<1>"),
    ("scene_variables.c", r'("contact.point\[2\]", [^,]+, [^,]+, )248', r"\g<1>247"),
    ("scene_variables.c", r'("source.center\[1\]", )-1e\+150', r"\g<1>-1e+151"),
    ("scene_variables.c", r'    \{"contact.gap",.*\n', ""),
    ("scene_variables.c", r"ROW_contact_gap_rate, VARIABLE_REAL", "ROW_contact_gap, VARIABLE_REAL"),
    ("scene_variables.c", r"(ROW_contact_active, VARIABLE_)BOOLEAN", r"\g<1>INTEGER"),
    ("scene_variables.c", r'("energy.dissipated_state".*, )1(, 0\})', r"\g<1>0\g<2>"),
    ("documentation/index.html", r"(source.center\[1..3\]</code>\s*<small>)111..113", r"\g<1>111..114"),
    ("documentation/index.html", r"(contact.penalty_factor</code>[\s\S]*?<td>)1000000.0", r"\g<1>100000.0"),
    ("documentation/index.html", r"(contact.gap</code>[\s\S]*?<td>)m(</td>)", r"\g<1>mm\g<2>"),
    ("documentation/index.html", r"(<code>Length</code></td><td>m</td>\s*<td>)1e-150", r"\g<1>1e-140"),
    ("documentation/index.html", r"<small>1e-14 to 0.01</small>", ""),
    ("documentation/index.html", r"(source.mass</code>\s*<small>102, )parameter", r"\g<1>input"),
    ("documentation/index.html", r"<tr><td><code>contact.active[\s\S]*?</tr>", ""),
    ("documentation/index.html", r"<i>p</i><sub>nv</sub></td>", "<i>p</i><sub>n</sub></td>"),
]


@pytest.mark.parametrize(("file", "pattern", "replacement"), ALTERATIONS)
def test_an_altered_file_is_noticed(file, pattern, replacement):
    original = generated.files_of("SphereCylinder")
    altered, count = re.subn(pattern, replacement, original[file], count=1)
    assert count == 1
    try:
        found = disagreements({**original, file: altered}, generated.scene_file("SphereCylinder"))
    except AssertionError:
        return  # the reader itself refuses the file
    assert found


def test_a_changed_row_of_variables_toml_is_noticed(monkeypatch):
    """Files made before a row changed are stale: all three are caught."""
    monkeypatch.setitem(generated.CATALOGUE["variable"]["contact.penalty_factor"], "start", 2e6)
    found = disagreements(generated.files_of("SphereSphere"), generated.scene_file("SphereSphere"))
    assert sorted(line.split()[0] for line in found) == ["XML", "page"]
    monkeypatch.setitem(generated.CATALOGUE["variable"]["contact.penalty_factor"], "vr", 99)
    found = disagreements(generated.files_of("SphereSphere"), generated.scene_file("SphereSphere"))
    assert {line.split()[0] for line in found} == {"XML", "C", "page"}


def test_value_references_never_change():
    """value_references.txt is written by freeze_references.py, which only ever adds lines."""
    frozen, now = read_frozen(), current()
    assert {key: now.get(key) for key in frozen} == frozen
    assert now.keys() - frozen.keys() == set(), "run support.generator.freeze_references for new variables"


def test_value_references_are_unique_and_found_in_the_index(scene):
    text = generated.files_of(scene)["scene_variables.c"]
    variables = generated.parse_c(text)
    within = max(e["reference"] for e in variables.values() if e["reference"] < 1_000_000) + 1
    index = {int(r): int(p) for r, p in re.findall(r"\[(\d+)\] = (\d+),", text)}
    index = {r if r < within else r - within + 1_000_000: p for r, p in index.items()}  # those behind blocks
    assert index == {entry["reference"]: i for i, entry in enumerate(variables.values(), 1)}
    assert len(index) == len(variables)


def test_the_c_table_names_the_member_of_its_variable(scene):
    data = generated.scene_file(scene)
    bodies, contacts = ([one["name"] for one in data[kind]] for kind in ("body", "contact"))
    for name, entry in generated.parse_c(generated.files_of(scene)["scene_variables.c"]).items():
        if entry["causality"] == "local":
            assert entry["member"] is None, name  # computed when it is asked for
            continue
        owner, _, field = name.partition(".")
        member = f"world.{name.replace('.', '_')}"
        if owner in bodies:
            member = f"body[{bodies.index(owner)}].{field}"
        elif owner in contacts:
            member = f"contact[{contacts.index(owner)}].{field}"
        if name.endswith("]"):
            member = re.sub(r"\[(\d)\]$", lambda match: f"[{int(match[1]) - 1}]", member)
        assert entry["member"] == member


def test_every_number_has_a_symbol_and_every_real_a_unit_quantity_range_and_nominal(scene):
    for name, entry in generated.parse_xml(generated.files_of(scene)["modelDescription.xml"]).items():
        assert entry["description"], name
        if entry["base"] in ("Real", "Integer"):
            assert entry["description"].endswith(")"), name
            assert entry["quantity"], name
        if entry["base"] == "Real":
            assert entry["unit"], name
            assert float(entry["nominal"]) > 0.0, name
            assert abs(entry["min"]) <= 1e300, name
            assert abs(entry["max"]) <= 1e300, name


# What modelDescription.xml says of when a variable changes, and of its start.

TUNABLE = {
    "penalty_multiplier", "penalty_factor", "characteristic_time", "viscous_penalty_factor", "dashpot",
    "reference_modulus", "gravity", "relative_tolerance", "absolute_tolerance", "max_internal_steps",
    "effective_penalty_factor", "effective_viscous_penalty_factor", "effective_hertz_stiffness",
    "hertz_stiffness", "hunt_crossley_factor", "restitution",
}  # fmt: skip


def test_variability_and_initial_follow_from_causality(scene):
    """What sums up a step changes at communication points only: nobody is to ask for its derivatives."""
    for name, entry in generated.describe(scene).items():
        field = generated.whole(name).rpartition(".")[2]
        sums_up = field in generated.SUMS_UP
        varies = "continuous" if entry["base"] == "Real" and not sums_up else "discrete"
        fixed = "tunable" if field in TUNABLE else "fixed"
        assert (entry["variability"], entry["initial"]) == {
            "parameter": (fixed, "exact"),
            "calculatedParameter": (fixed, "calculated"),
            "input": (varies, None),
            "output": (varies, "calculated"),
            "local": (varies, "calculated"),
        }[entry["causality"]], name
