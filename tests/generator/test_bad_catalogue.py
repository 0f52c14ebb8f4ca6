"""A wrong variables.toml gives one line that names the file and the row, and exit status 2."""

import shutil
import sys

import pytest

from support.generator.generated import FOLDER, refused
from support.programs import finished

# What stands in variables.toml (its first occurrence), what it becomes, words of the message in their order.
BAD = [
    ("vr = 2\n", "vr = 1\n", ['variable."body.mass"', "value reference 1", "that of body.radius"]),
    ("vr = 11\n", "vr = 12\nvr_base = 0\n",
        ['variable."body.center"', "'vr_base'", "allowed: absent, causality"]),
    ("vr = 110\n", "vr = 101\n", ['variable."contact.characteristic_rolling_rate"', "that of body.radius"]),
    ("vr = 45\n", "vr = 100\n", ['variable."body.length"', "value reference 100 is out of 1..99"]),
    ('type = "Length"', 'type = "Lenght"', ['variable."body.radius"', "'Lenght'", "allowed: Acceleration"]),
    ('causality = "parameter"', 'causality = "exported"',
        ['variable."body.radius"', "'exported'", "allowed: parameter"]),
    ("start = 0.1\n", "", ['variable."body.radius"', "'start' belongs to parameters"]),
    ('role = "state"\n', "", ['variable."body.displacement_state"', "'role' belongs to local variables"]),
    ('rate_of = "body.velocity_state"', 'rate_of = "body.velocity"',
        ['variable."body.acceleration"', "'rate_of' is 'body.velocity'", "allowed: body.displacement_state"]),
    ('["free"] }, {', '["free"], "body.mood" = ["bad"] }, {',
        ['variable."body.mass"', "'body.mood'", "body.motion"]),
    ("max = 1e150\n", "max = 1e301\n",
        ['variable."body.axial_inertia"', "range 1e-150 to 1e+301", "within 1e-300"]),
    ('unit = "m", display = "mm"', 'unit = "ft", display = "mm"',
        ["type.Length", "'ft'", "allowed: 1, 1/s, J"]),
    ('unit = "m", display = "mm"', 'unit = "m", display = "in"', ["type.Length", "'in'", "allowed: mm"]),
    ('depends = { "body.prescribed_displacement" = "fixed", ', 'depends = { "body.displaced" = "fixed", ',
        ['variable."body.displacement"', "unknown input or state 'body.displaced'",
        "allowed: body.prescribed_displacement"]),
    ('depends = { "body.prescribed_displacement" = "fixed", ',
        'depends = { "body.prescribed_displacement" = "loose", ',
        ['variable."body.displacement"', "'body.prescribed_displacement' is 'loose'", "allowed: dependent"]),
    ("start = 0.1\n", 'start = 0.1\ndepends = { "body.external_force" = "fixed" }\n',
        ['variable."body.radius"', "depends belongs to outputs"]),
    ("vr = 1\n", "", ["incomplete", "vr"]),
    ("[project]", "[project", ["not valid TOML", "line"]),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "words"), BAD)
def test_a_bad_catalogue_is_refused_in_one_line(tmp_path, old, new, words):
    folder = tmp_path / "modelDescription"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("__pycache__"))
    text = (folder / "variables.toml").read_text(encoding="utf-8")
    assert old in text
    (folder / "variables.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    done = finished([sys.executable, "-B", folder / "generate.py", "--table"])
    refused(done, "modelDescription/variables.toml: ", *words)
