"""Numbers with units, in scene files and in --set: to the last digit, and refused where they do not fit"""

import math
import tomllib

import pytest

from contact_fmus.errors import UserError
from contact_fmus.fmu.variables import Variable, read_settings
from generator.quantity import in_unit
from support.generator.generated import ROOT, run

UNITS = tomllib.loads((ROOT / "modelDescription" / "variables.toml").read_text())["unit"]


@pytest.mark.parametrize(("text", "unit", "value"), [
    ("50mm", "m", 0.05),
    ("35 mm", "m", 0.035),  # 35 * 0.001 is another double
    ("-1e-3 km", "m", -1.0), ("1 in", "m", 0.0254), ("36 km/h", "m/s", 10.0), ("9.81 m/s^2", "m/s2", 9.81),
    ("2 deg/s", "rad/s", math.radians(2.0)), ("60 rpm", "rad/s", 2.0 * math.pi),
    ("210 GPa", "Pa", 210e9), ("3 kg.cm2", "kg.m2", 3e-4),
    ("4 N/mm^1.5", "N/m1.5", 4.0 * 1000.0**1.5), ("50 %", "1", 0.5),
])  # fmt: skip
def test_a_number_with_a_unit_is_the_nearest_double(text, unit, value):
    assert in_unit(text, unit) == value


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_and_display_unit_is_one_that_pint_knows(unit):
    assert in_unit(f"3 {unit}", unit) == 3.0 or unit == "1"
    for display, factor in UNITS[unit].get("display", {}).items():
        assert math.isclose(factor * in_unit(f"3 {display}", unit), 3.0, rel_tol=1e-15)


@pytest.mark.parametrize(("text", "unit", "words"), [
    ("5 kg", "m", "cannot be converted to m"),
    ("2 Hz", "rad/s", "cannot be converted to rad/s"),
    ("3 deg", "1", "cannot be converted to 1"),
    ("5 ells", "m", "no unit that pint knows"), ("2*3 mm", "m", "no unit that pint knows"),
    ("mm", "m", "no number with a unit"),
])  # fmt: skip
def test_what_does_not_fit_is_refused(text, unit, words):
    with pytest.raises(ValueError, match=words):
        in_unit(text, unit)


SCENE = """
name = "Own"
title = "Own"
description = "Own."
body = [{{ name = "ball", shape = "sphere" }}, {{ name = "globe", shape = "sphere" }}]
contact = [{{ name = "contact", source = "ball", destination = "globe" }}]
[start]
"ball.radius" = {radius}
"ball.center" = {center}
"ball.initial_angular_velocity" = {turning}
[pinned]
"contact.penalty_factor" = {stiffness}
[experiment]
step_size = {step}
"""
SI = {"radius": 0.2, "center": [0, 0.0, 3.0], "turning": [0.0, math.pi, 0], "stiffness": 2e6, "step": 0.002}
WITH_UNITS = {"radius": '"200 mm"', "center": '[0, "0 m", "3000mm"]', "turning": '["0 rpm", "180 deg/s", 0]'}
WITH_UNITS |= {"stiffness": '"2 kN/mm"', "step": '"2 ms"'}


def test_a_scene_with_units_is_the_scene_in_si(tmp_path):
    made = []
    for name, values in (("si", SI), ("units", WITH_UNITS)):
        file = tmp_path / name / "Own.toml"
        file.parent.mkdir()
        file.write_text(SCENE.format(**values))
        done = run("--scene", file, "--output", tmp_path / name / "out")
        assert (done.returncode, done.stderr) == (0, "")
        outputs = ("modelDescription.xml", "modelDescription3.xml", "scene.h")
        made.append([(tmp_path / name / "out" / output).read_bytes() for output in outputs])
    assert made[0] == made[1]


VARIABLES = {
    "source.radius": Variable("source.radius", "Real", "parameter", "m", "", (1,), (), ()),
    "source.center": Variable("source.center", "Real", "parameter", "m", "", (1, 2, 3), (), ()),
}


@pytest.mark.parametrize(("setting", "value"), [
    ("source.radius=50mm", 0.05),
    ("source.center=0,0,50 mm", [0.0, 0.0, 0.05]),
    ("source.center=[1 in, 2mm, 3 m]", [0.0254, 0.002, 3.0]),
])  # fmt: skip
def test_a_setting_may_have_units(setting, value):
    assert read_settings([setting], VARIABLES, "Any") == {setting.partition("=")[0]: value}


@pytest.mark.parametrize(("setting", "words"), [
    ("source.radius=50kg", "takes a number in m, not '50kg', in 'kg', which cannot be converted to m"),
    ("source.center=10,20,30mm", "a unit with each number that is not 0"),
    ("source.radius=nan mm", "not 'nan mm'"),
])  # fmt: skip
def test_a_setting_in_a_wrong_unit_is_refused(setting, words):
    with pytest.raises(UserError, match=words.replace("(", r"\(")):
        read_settings([setting], VARIABLES, "Any")
