"""Without any setting the FMUs touch, and a start deeper than a tenth of a radius is warned of once."""

import math

import pytest

from support.checks import check_close, run, start

# Each case has an FMU, start values and the depth of the overlap [m]. The radii are 0.1 m and 0.5 m.
LYING = {"destination.axis": [0.0, 1.0, 0.0]}
FREE = {"contact.location": "outside"}
INSIDE = {"contact.location": "inside"}
DEEP = {
    "sphere": ("SphereSphere", {**FREE, "source.center": [0.0, 0.0, 0.55]}, 0.05),
    "hollow sphere": ("SphereSphere", {**INSIDE, "source.center": [0.0, 0.0, 0.45]}, 0.05),
    "cylinder": ("SphereCylinder", {**FREE, **LYING, "source.center": [0.0, 3.0, 0.55]}, 0.05),
    "hollow cylinder": ("SphereCylinder", {**INSIDE, **LYING, "source.center": [0.0, 0.0, 0.45]}, 0.05),
    "plane": ("SpherePlane", {"source.center": [0.0, 0.0, 0.05]}, 0.05),
    "far below a plane": ("SpherePlane", {"source.center": [0.0, 0.0, -2.9]}, 3.0),
    "force element": ("ForceElement", {"source.center": [0.55, 0.0, 0.0]}, 0.05),
}


def warnings(fmu):
    return [str(message) for message in fmu.messages if "overlap by more than a tenth" in str(message)]


@pytest.mark.parametrize("case", DEEP)
def test_a_deep_start_is_warned_of_once_with_depth_and_stored_energy(opened, case):
    name, values, depth = DEEP[case]
    fmu = opened(name)
    for _ in range(2):  # again after a reset
        run(fmu, values, 0.01, 3, method="event_driven" if "solver.method" in fmu else None)
        said = warnings(fmu)
        assert len(said) == 1
        assert f"contact.gap = {-depth:g} m" in said[0]
        assert "smaller radius, 0.1 m" in said[0]
        assert f"{0.5e6 * depth**2:g} J" in said[0]


@pytest.mark.parametrize("case", DEEP)
def test_a_tenth_and_less_is_no_matter(opened, case):
    name, values, depth = DEEP[case]
    side = 1 if math.hypot(*values["source.center"]) > 0.5 or "plane" in case else -1
    row = next(i for i in (0, 2) if values["source.center"][i])
    values = {**values, "source.center": list(values["source.center"])}
    values["source.center"][row] += side * (depth - 0.0099)
    assert not warnings(start(opened(name), values))


def test_beyond_the_ends_of_a_cylinder_nothing_overlaps(opened):
    name, values, _ = DEEP["cylinder"]
    assert not warnings(start(opened(name), {**values, "destination.finite_length": True}))


def test_a_dashpot_alone_stores_nothing(opened):
    name, values, _ = DEEP["plane"]
    fmu = start(opened(name), {**values, "contact.penalty_control": "viscous_only"})
    assert "and 0 J are stored" in warnings(fmu)[0]


@pytest.mark.parametrize("depth", [0.045, 0.05, 0.06, 0.1, 1.0])
def test_a_plane_that_accelerates_takes_no_more_steps_below_the_centre_than_above(opened, depth):
    """A small ball is damped far beyond critically. A plane has no centre, at any depth: the law is linear,
    and the later gap is linear in the gap at the start."""
    gaps = []
    for start_depth in (0.02, 0.04, depth):
        values = {"source.radius": 0.05, "source.mass": 1e-3, "source.center": [0.0, 0.0, 0.05 - start_depth]}
        values |= {"contact.penalty_factor": 1e3, "contact.viscous_penalty_factor": 1e4}
        values |= {"contact.dashpot": "unclamped", "destination.motion": "prescribed"}
        values |= {"destination.prescribed_velocity": [0.0, 0.0, -1.0], "gravity": [0.0, 0.0, 0.0]}
        fmu = start(opened("SpherePlane"), values, 1e-8)
        fmu.set_derivative("destination.prescribed_displacement", [0.0, 0.0, -1.0], order=1)
        fmu.set_derivative("destination.prescribed_displacement", [0.0, 0.0, -1.0], order=2)
        fmu.set_derivative("destination.prescribed_velocity", [0.0, 0.0, -1.0], order=1)
        fmu.step(0.1)
        assert fmu["solver.steps"] <= 5
        gaps.append(fmu["contact.gap"])
    near, far, gap = gaps
    check_close("gap", gap, near + (far - near) * (depth - 0.02) / 0.02, 1e-11)


@pytest.mark.parametrize("name", ["SphereSphere", "SphereCylinder"])
def test_a_run_without_any_setting_bounces(opened, name):
    """A ball of 0.1 m falls half a metre onto a body of 0.5 m, from 1.1 m, and rises again."""
    fmu = run(opened(name), {}, 0.6, 1, None, None)
    assert fmu["contact.onsets"] == 1
    check_close("onset", fmu["contact.last_onset_time"], (2 * 0.5 / 9.81) ** 0.5, 1e-9)
    assert fmu["source.velocity"][2] > 0.9 * (2 * 9.81 * 0.5) ** 0.5 - 9.81 * 0.3


def test_the_force_element_presses_without_any_input(opened):
    """The bodies overlap by 1 mm at 1e6 N/m."""
    fmu = run(opened("ForceElement"), {}, 1e-3, 1, None, None)
    check_close("force", fmu["contact.source_force"], [1000.0, 0.0, 0.0], 1e-6)
