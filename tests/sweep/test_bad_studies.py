"""What is wrong with a study is one sentence that says where and what is allowed"""

import pytest

from contact_fmus.errors import UserError
from support.sweeps import read, study_text, write_study

ONE = {"source.radius": "{ range = [0.05, 0.15] }"}


def text(**options):
    return study_text(**{"vary": ONE, "count": 10, **options})


CASES = {
    "no TOML": ("fmu = ", "no TOML file"),
    "unknown key": (text(fmuu='"x"'), "fmuu"),
    "unknown FMU": (text(fmu='"SphereSpere"'), "SphereSphere"),
    "missing file": (text(fmu='"nowhere.fmu"'), "nowhere.fmu"),
    "not an FMU": (text(fmu='"study.fmu"'), "study.fmu"),
    "no outputs": (text(outputs={}), "outputs"),
    "unknown output": (text(outputs={"h": '"source.positon[3]"'}), "source.position"),
    "unknown reduction": (text(outputs={"h": '{ variable = "contact.gap", reduce = "maximum" }'}), "max"),
    "late output": (text(outputs={"h": '{ variable = "contact.gap", at = 9.0 }'}), "2.0"),
    "max of an enumeration": (text(outputs={"h": '{ variable = "contact.dashpot", reduce = "max" }'}),
        "enumeration"),
    "two columns": (text(outputs={"status": '"contact.gap"'}), "status"),
    "unknown parameter": (text(vary={"source.radios": "[1.0]"}), "source.radius"),
    "an output set": (text(vary={"source.position[1]": "[1.0]"}), "output"),
    "text for a number": (text(vary={"source.radius": '["50 mm"]'}), "no quotation marks"),
    "beyond the range": (text(vary={"source.radius": "{ range = [-0.1, 0.1] }"}), "-0.1 m"),
    "backwards": (text(vary={"source.radius": "{ range = [0.2, 0.1] }"}), "below the second"),
    "log of zero": (text(vary={"gravity[3]": '{ range = [-1, 1], scale = "log" }'}), "above 0"),
    "unquoted name": (text().replace('"source.radius"', "source.radius"), '"source.radius"'),
    "unknown item": (text(vary={"contact.dashpot": '["unclampd"]'}), "unclamped"),
    "range of an enumeration": (text(vary={"contact.dashpot": "{ range = [1, 2] }"}), "choices"),
    "empty list": (text(vary={"source.radius": "[]"}), "at least one"),
    "nothing varies": (text(vary={}), "[vary]"),
    "no count": (text(count=0), "[samples]"),
    "no samples": (text(count=0.5), "whole number"),
    "nothing sampled": (text(vary={"source.radius": "[0.1]"}), "nothing is sampled"),
    "said twice": (text(vary={"contact.method": '["penalty"]'}, count=0), "already"),
    "component said twice": (text(vary={"source.center": "[[0,0,1]]", "source.center[3]": "[1]"}),
        "source.center"),
    "stop before start": (text(experiment="stop_time = -1.0"), "stop_time"),
    "step and steps": (text(experiment="stop_time = 1.0\nstep = 0.1\nsteps = 10"), "not both"),
    "too many steps": (text(experiment="stop_time = 1.0\nstep = 1e-9"), "at most"),
    "key of another distribution": (
        text(vary={"source.radius": '{ distribution = "normal", mean = 1, deviation = 1, mode = 2 }'}),
        "mode",
    ),
    "nothing left of a distribution": (
        text(vary={"source.mass": '{ distribution = "normal", mean = -1e6, deviation = 1 }'}),
        "no value",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_bad_study_is_refused_in_one_sentence(tmp_path, name):
    content, expected = CASES[name]
    (tmp_path / "study.fmu").write_bytes(b"no archive")
    with pytest.raises(UserError) as refused:
        read(write_study(tmp_path, content))
    said = str(refused.value)
    assert expected in said
    assert "\n" not in said


def test_the_study_that_the_bad_ones_are_made_of_is_good(tmp_path):
    assert read(write_study(tmp_path, text())).samples().runs == 10


def test_a_byte_order_mark_is_read_over(tmp_path):
    file = write_study(tmp_path, text())
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert read(file).samples().runs == 10
