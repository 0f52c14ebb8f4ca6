"""Concentric bodies, automatic location, kinds of motion that mean the same, and starts in mid-contact."""

import math

import numpy as np
import pytest

from support.checks import FMU, check_close, check_relative, run, start
from support.scenes.head_on import ACROSS, AXIS, GEOMETRIES, approach, head_on

PRESCRIBED = {"source.motion": "prescribed", "destination.motion": "prescribed"}
ORIGIN = {"source.center": [0.0, 0.0, 0.0], "destination.center": [0.0, 0.0, 0.0]}
ROWS = ("gap", "gap_rate", "distance", "direction", "normal_force", "source_force", "destination_force")
ROWS += ("point",)
READ = [f"contact.{row}" for row in ROWS]


def check_finite(fmu):
    for name in READ:
        assert np.all(np.isfinite(fmu[name])), f"{name} = {fmu[name]}"


def warnings(fmu):
    """Returns all warnings except the one about a deep overlap at the start."""
    told = [message for message in fmu.messages if message.category == "logStatusWarning"]
    return [message for message in told if "more than a tenth of the smaller radius" not in message.text]


def concentric(shape, **more):
    values = {**PRESCRIBED, **ORIGIN, "source.radius": 0.1, "destination.radius": 0.5}
    if shape == "cylinder":
        values["destination.axis"] = AXIS.tolist()
    return {**values, **{name.replace("_", ".", 1): value for name, value in more.items()}}


@pytest.mark.parametrize("location", ["automatic", "inside"])
def test_concentric_hollow_bodies_do_not_touch(opened, shape, location):
    values = concentric(shape, contact_location=location, source_prescribed_velocity=[1, 2, 3])
    fmu = start(opened(FMU[shape]), values)
    for _ in range(3):
        check_finite(fmu)
        check_close("gap", fmu["contact.gap"], 0.4, 1e-15)
        assert fmu["contact.active"] is False
        check_close("forces", [fmu[f"contact.{body}_force"] for body in ("source", "destination")], 0.0, 0)
        fmu.step(0.1)
    assert not warnings(fmu)


def test_a_ball_flies_through_the_middle_of_a_hollow_body(opened, shape, method):
    """An undamped ball passes d = 0 to and fro and bounces four times in one communication step."""
    fmu = run(opened(FMU[shape]), head_on(shape, "inside", gap=0.4), 4.0, 1, method=method)
    period = 0.8 + math.pi * 1e-3
    assert fmu["contact.onsets"] == 5
    check_close("last_onset_time", fmu["contact.last_onset_time"], 0.4 + 4 * period, 1e-7)
    left = 4.0 - (0.4 + 4 * period + math.pi * 1e-3)
    check_close("position", fmu["source.position"], (0.4 - left) * ACROSS, 1e-6)


MOVING = [1.0, 2.0, 3.0]
LED = {"source.prescribed_displacement": [0.3, 0.5, -1.2], "destination.center": [0.4, 0.7, -0.9]}
LED |= {"source.prescribed_angular_velocity": [0.0, 5.0, 3.0], "source.center": [0.1, 0.2, 0.3]}
LED |= {"contact.friction": "regularized", "source.rotation": "prescribed"}
LED |= {f"{body}.prescribed_velocity": MOVING for body in ("source", "destination")}
LED |= {f"{body}.prescribed_displacement.derivatives": [MOVING] for body in ("source", "destination")}


@pytest.mark.parametrize("moved", [{}, LED], ids=["at rest", "led along"])
def test_overlapping_solids_at_the_same_place_push_along_a_fixed_direction(opened, shape, moved):
    """No normal is defined: docs name a unit vector (across a cylinder's axis). One warning is given."""
    values = concentric(shape, contact_location="outside", contact_method="penalty") | moved
    fmu = start(opened(FMU[shape]), values)
    directions = []
    for _ in range(3):
        check_finite(fmu)
        check_relative("gap", fmu["contact.gap"], -0.6, 1e-15)
        check_relative("normal_force", fmu["contact.normal_force"], 0.6e6, 1e-14)
        directions.append(fmu["contact.direction"])
        check_close("length of direction", np.linalg.norm(directions[-1]), 1.0, 1e-14)
        check_close("action and reaction", fmu["contact.source_force"], -fmu["contact.destination_force"], 0)
        check_relative("force", fmu["contact.source_force"] @ directions[-1], -0.6e6, 1e-14)
        fmu.step(0.1)
        check_relative("mean force", fmu["contact.mean_force"], fmu["contact.source_force"], 1e-14)
    check_close("direction", directions, [directions[0]] * 3, 0)
    if shape == "cylinder":
        check_close("direction along the axis", directions[0] @ AXIS, 0.0, 1e-15)
    assert len(warnings(fmu)) == 1, fmu.messages


def test_the_direction_at_the_axis_is_that_of_the_step_before(opened):
    """Flight defers steps: the source comes to the axis of a hollow cylinder at 7/16 s along x = (7/16 - t) /
    2, y = (7/16 - t)^2. There e_c, from the axis to the wall, is that of 6/16 s."""
    values = {"destination.axis": [0.0, 0.0, 1.0], "contact.location": "inside", "gravity": [0.0, 2.0, 0.0]}
    values |= {"source.center": [7 / 32, 49 / 256, 0.0], "source.initial_velocity": [-0.5, -0.875, 0.0]}
    fmu = run(opened("SphereCylinder"), values, 7 / 16, 7)
    assert fmu["contact.distance"] == 0.0
    check_close("direction", fmu["contact.direction"], np.array([8.0, 1.0, 0.0]) / math.sqrt(65.0), 1e-15)


def test_overlapping_solids_keep_the_last_direction(opened, shape):
    values = concentric(shape, contact_location="outside")
    fmu = start(opened(FMU[shape]), values | {"source.prescribed_displacement": list(0.3 * ACROSS)})
    fmu.step(0.1)
    before = fmu["contact.direction"]
    check_close("direction", before, -ACROSS, 1e-14)
    fmu["source.prescribed_displacement"] = [0.0, 0.0, 0.0]
    fmu.step(0.1)
    check_close("direction", fmu["contact.direction"], before, 0)
    check_finite(fmu)
    assert len(warnings(fmu)) == 1, fmu.messages
    fmu["source.prescribed_displacement"] = (-0.3 * ACROSS).tolist()
    check_close("direction", fmu["contact.direction"], ACROSS, 1e-14)
    fmu["source.prescribed_displacement"] = [0.0, 0.0, 0.0]
    fmu.step(0.1)
    assert len(warnings(fmu)) == 1, "warned more than once"


LOCATIONS = {  # r_s, r_d, d -> location
    "centre inside, fits": (0.1, 0.5, 0.45, "inside"),
    "centre just inside": (0.1, 0.5, 0.4999999, "inside"),
    "centre just outside": (0.1, 0.5, 0.5000001, "outside"),
    "far outside": (0.1, 0.5, 5.0, "outside"),
    "does not fit": (0.6, 0.5, 0.2, "outside"),
    "just does not fit": (0.5, 0.5, 0.2, "outside"),
}


@pytest.mark.parametrize("case", LOCATIONS)
@pytest.mark.parametrize("motion", ["prescribed", "free"])
def test_automatic_location_is_inside_if_the_centre_starts_inside_and_fits(opened, shape, motion, case):
    """The displaced place at the start counts, not the undeformed centre alone."""
    r_s, r_d, distance, location = LOCATIONS[case]
    values = concentric(shape, source_radius=r_s, destination_radius=r_d, source_motion=motion)
    row = "prescribed" if motion == "prescribed" else "initial"
    values["source.center"] = (10 * ACROSS).tolist()
    values[f"source.{row}_displacement"] = ((distance - 10) * ACROSS).tolist()
    fmu = start(opened(FMU[shape]), values)
    gap = r_d - r_s - distance if location == "inside" else distance - r_s - r_d
    check_close("gap", fmu["contact.gap"], gap, 1e-14)


@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_location_stays_what_it_was_at_the_start(opened, shape, location):
    """A body pressed through the wall is still inside (outside)."""
    values = {**head_on(shape, location), **PRESCRIBED, "contact.location": "automatic"}
    fmu = start(opened(FMU[shape]), values)
    first = fmu["contact.gap"]
    fmu["source.prescribed_displacement"] = (0.3 * approach(location)).tolist()
    fmu.step(0.1)
    check_close("gap", fmu["contact.gap"], first - 0.3, 1e-14)


@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_start_in_the_middle_of_a_contact_counts_as_an_onset(opened, shape, location, method):
    """Let go at depth s without speed, the ball leaves with omega s after a quarter of a period."""
    depth, stiffness = 1e-3, 1e6
    fmu = start(opened(FMU[shape]), head_on(shape, location, gap=-depth, speed=0.0), 1e-10, method)
    assert (fmu["contact.onsets"], fmu["contact.active"], fmu["contact.last_onset_time"]) == (1, True, 0)
    fmu.step(0.01)
    check_close("last_duration", fmu["contact.last_duration"], math.pi / 2 / math.sqrt(stiffness), 1e-10)
    check_close("velocity", fmu["source.velocity"], -depth * math.sqrt(stiffness) * approach(location), 1e-8)
    assert fmu["contact.onsets"] == 1
