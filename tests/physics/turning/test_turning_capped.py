"""Derivatives of a contact with a capped cylinder that the importer moves and turns: with respect to inputs,
axis and angular velocities among them, and to time, in every zone and at both ends; against differences."""

from math import cos, sin

import numpy as np
import pytest

from support.checks import check_close, start

INPUTS = [
    *(f"{body}.prescribed_{row}" for row in ("displacement", "velocity", "angular_velocity")
      for body in ("source", "destination")),
    "destination.prescribed_axis",
]  # fmt: skip
OUTPUTS = [f"contact.{row}" for row in (
    "gap", "gap_rate", "distance", "direction", "normal_force", "source_force", "destination_force", "point",
    "source_torque", "destination_torque", "slip_velocity", "friction_force",
)]  # fmt: skip
RADIUS, OTHER, HALF = 0.2, 0.5, 0.5
APART, OVERLAP = 0.3, -0.02  # gap [m]
# Of differences of fourth order, small beside the depth: their error is some (step/depth)^4
MOVED = 1e-4  # m, m/s, rad/s, 1
TIME = 1e-3  # s
PLACES = {  # outwards, along the axis, gap; from the axis' middle
    "side": (OTHER, 0.1, 1.0, 0.0, OVERLAP),
    "cap": (0.3, HALF, 0.0, 1.0, OVERLAP),
    "other cap": (0.3, -HALF, 0.0, -1.0, OVERLAP),
    "rim": (OTHER, HALF, cos(0.5), sin(0.5), OVERLAP),
    "other rim": (OTHER, -HALF, cos(1.1), -sin(1.1), OVERLAP),
    "off the rim": (OTHER, HALF, cos(0.8), sin(0.8), APART),
    "off the other cap": (0.3, -HALF, 0.0, -1.0, APART),
}
LAWS = {
    "linear, none": {"contact.law": "linear", "contact.friction": "none"},
    "hertz, regularized": {"contact.law": "hertz", "contact.friction": "regularized"},
    "linear, elastic": {"contact.law": "linear", "contact.friction": "elastic"},
}


def scene(place, law):
    """Values, and inputs at the start"""
    draw = np.random.default_rng(14)
    axis, aside = draw.normal(size=(2, 3))
    axis /= np.linalg.norm(axis)
    outward = np.cross(axis, aside)
    outward /= np.linalg.norm(outward)
    across, along, n_across, n_along, gap = PLACES[place]
    foot = across * outward + along * axis
    centre = foot + (RADIUS + gap) * (n_across * outward + n_along * axis)
    values = {
        "source.radius": RADIUS, "destination.radius": OTHER, "destination.finite_length": True,
        "destination.length": 2 * HALF, "destination.ends": "capped", "destination.axis": axis.tolist(),
        "source.center": centre.tolist(), "contact.dashpot": "unclamped", "contact.penalty_factor": 100.0,
        "contact.viscous_penalty_factor": 3.0, "contact.hertz_stiffness": 300.0,
        "contact.hunt_crossley_factor": 0.1, "contact.slip_velocity_control": "user_defined",
        "contact.characteristic_slip_velocity": 0.5, "contact.tangential_stiffness": 50.0,
        "contact.tangential_damping": 1.0,
        **{f"{body}.{kind}": "prescribed" for body in ("source", "destination") for kind in ("motion",
            "rotation")},
    }  # fmt: skip
    inputs = {name: 0.1 * draw.normal(size=3) for name in INPUTS}
    inputs |= {f"{body}.prescribed_displacement": np.zeros(3) for body in ("source", "destination")}
    return values | LAWS[law], inputs | {"destination.prescribed_axis": axis}


def outputs_at(fmu, inputs):
    for name, value in inputs.items():
        fmu[name] = value.tolist()
    return {name: np.atleast_1d(fmu[name]) for name in OUTPUTS}


def difference(at, step):
    """Of fourth order, from values at -2, -1, 1, 2 steps"""
    return (8 * (at[2] - at[1]) - (at[3] - at[0])) / (12 * step)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("place", PLACES)
def test_with_respect_to_inputs(opened, place, law):
    fmu = opened("SphereCylinder")
    values, inputs = scene(place, law)
    start(fmu, values)
    for name in INPUTS:
        outputs_at(fmu, inputs)
        given = {unknown: np.atleast_2d(fmu.jacobian(unknown, name)) for unknown in OUTPUTS}
        for k in range(3):
            at = [
                outputs_at(fmu, inputs | {name: inputs[name] + step * MOVED * np.eye(3)[k]})
                for step in (-2, -1, 1, 2)
            ]
            for unknown in OUTPUTS:
                expected = difference([values[unknown] for values in at], MOVED)
                size = 1.0 + np.max(np.abs(expected))
                check_close(f"{unknown} by {name}[{k + 1}]", given[unknown][:, k], expected, 1e-8 * size)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("place", PLACES)
def test_with_respect_to_time(opened, place, law):
    """Both go straight on and turn evenly; five points of time, derivatives at the third."""
    fmu = opened("SphereCylinder")
    values, inputs = scene(place, law)
    for body in ("source", "destination"):
        rate = inputs[f"{body}.prescribed_velocity"].tolist()
        values[f"{body}.prescribed_displacement.derivatives"] = [rate, [0.0] * 3]
    for name in INPUTS[2:6]:
        values[name] = inputs[name].tolist()
    start(fmu, values, 1e-12)
    seen, given = [], {}
    for k in range(5):
        seen.append({name: np.atleast_1d(fmu[name]) for name in OUTPUTS})
        if k == 2:
            given = {(name, n): np.atleast_1d(fmu.derivative(name, n)) for name in OUTPUTS for n in (1, 2)}
        for body in ("source", "destination"):
            rate = inputs[f"{body}.prescribed_velocity"]
            fmu[f"{body}.prescribed_displacement"] = (fmu.time * rate).tolist()
            fmu.set_derivative(f"{body}.prescribed_displacement", rate.tolist())
        fmu.step(TIME)
    for name in OUTPUTS:
        at = [values[name] for values in seen]
        first = difference([at[0], at[1], at[3], at[4]], TIME)
        second = (16 * (at[1] + at[3]) - (at[0] + at[4]) - 30 * at[2]) / (12 * TIME**2)
        check_close(f"{name}'", given[name, 1], first, 1e-7 * (1.0 + np.max(np.abs(first))))
        check_close(f"{name}''", given[name, 2], second, 1e-5 * (1.0 + np.max(np.abs(second))))
