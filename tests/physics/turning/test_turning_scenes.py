"""The shipped scenes of bodies that turn and rub move as the universal FMUs do, given the same choices."""

import tomllib

import pytest

from contact_fmus.fmu.files import repository
from support.checks import check_close, run

UNIVERSAL = {
    "Bowling": "SpherePlane",
    "SpinningBall": "SpherePlane",
    "Turntable": "SpherePlane",
    "GolfersDilemma": "SphereCylinder",
    "TippingRoller": "SphereCylinder",
}
OUTPUTS = ("source.position", "source.velocity", "energy.total")


@pytest.mark.parametrize("name", UNIVERSAL)
def test_what_is_compiled_in_computes_what_is_open(opened, name):
    file = repository() / "modelDescription" / "scenes" / f"{name}.toml"
    scene = tomllib.loads(file.read_text(encoding="utf-8"))
    end = 0.1 * scene["experiment"]["stop_time"]
    pinned = run(opened(name), {}, end, 3)
    values = scene["start"] | scene["pinned"]
    if name == "GolfersDilemma":
        values["destination.axis"] = [0.0, 0.0, 1.0]
    if name == "TippingRoller":
        values["destination.axis"] = [0.0, 0.0, 1.0]
    if name == "Turntable":
        values["destination.prescribed_axis"] = [0.0, 0.0, 1.0]
    universal = run(opened(UNIVERSAL[name]), values, end, 3)
    for output in OUTPUTS:
        check_close(output, pinned[output], universal[output], 1e-9)


def test_a_scene_without_rotation_has_no_variable_of_it(opened):
    gone = ("rotation", "angular", "inertia", "torque", "friction", "slip", "orientation", "tangential")
    assert [name for name in opened("BouncingBall").variables if any(word in name for word in gone)] == []
    assert [name for name in opened("SpherePlane").variables if "torque" in name]
