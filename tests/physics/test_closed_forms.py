"""Contacts whose end is known in closed form: duration, restitution, exchange, rest, peaks, mean force."""

import math

import numpy as np
import pytest

from support.checks import FMU, check_close, check_relative, run
from support.scenes.head_on import GEOMETRIES, SPEED, approach, head_on, oscillator, shared_out

RELATIVE = 1e-8  # at tolerance 1e-10
GAP_ERROR = 2e-10  # m, of distances of 0.6 m; decides when a contact ends while its dashpot still acts
STIFFNESS = 1e6
END = 0.1  # onset at 0.05 s, contact over well before

MASSES = {  # source, destination, effective mass
    "source free": ("free", "fixed", 2.0, 1.0, 2.0),
    "destination free": ("fixed", "free", 1.0, 3.0, 3.0),
    "both free": ("free", "free", 1.0, 3.0, 0.75),
}


@pytest.mark.parametrize("zeta, motions", [
    (0.0, "source free"),
    (0.05, "destination free"),
    (0.4, "both free"), (0.9, "both free"), (1.5, "source free"),
])  # fmt: skip
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_restitution_duration_and_peaks_are_the_damped_oscillators(
    opened, shape, location, dashpot, zeta, motions, method
):
    if dashpot == "unclamped" and zeta > 0.9:  # bodies part at exp(-pi tan phi) of their speed: at 1 never
        zeta = 0.7
    mass = MASSES[motions][-1]
    damping = 2 * zeta * math.sqrt(STIFFNESS * mass)
    configuration = head_on(
        shape, location, contact_method="penalty_dynamic", contact_viscous_penalty_factor=damping,
        contact_dashpot=dashpot,
    )  # fmt: skip
    configuration |= shared_out(configuration, *MASSES[motions][:-1])
    fmu = run(opened(FMU[shape]), configuration, 2 * END, 1, method=method)
    expected = oscillator(dashpot, mass, STIFFNESS, damping)
    speed = (fmu["destination.velocity"] - fmu["source.velocity"]) @ approach(location)
    slower, late = GAP_ERROR * damping / mass / SPEED, GAP_ERROR / (expected.restitution * SPEED)
    check_close("restitution", speed / SPEED, expected.restitution, RELATIVE + slower)
    allowed = RELATIVE * expected.duration + late
    check_close("duration", fmu["contact.last_duration"], expected.duration, allowed)
    check_relative("peak penetration", fmu["contact.peak_penetration"], expected.peak_penetration, RELATIVE)
    check_relative("peak force", fmu["contact.peak_force"], expected.peak_force, RELATIVE)


@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_momentum_and_angular_momentum_of_two_free_bodies_stay(opened, shape, location, dashpot, method):
    """The impact is oblique, without gravity. Angular momentum about the axis, of spheres the origin,
    stays."""
    configuration = head_on(
        shape, location, contact_method="penalty_dynamic", contact_dashpot=dashpot, destination_motion="free"
    )
    configuration.update({"source.mass": 1.0, "destination.mass": 2.5})
    configuration["source.initial_velocity"] = (np.array([0.3, 0.1, -0.2]) + 2 * approach(location)).tolist()
    configuration["destination.initial_velocity"] = [0.1, -0.2, 0.3]
    momenta, spins = [], []

    def record(fmu):
        rows = [
            (m, fmu[f"{b}.position"], fmu[f"{b}.velocity"])
            for b, m in (("source", 1.0), ("destination", 2.5))
        ]
        momenta.append(sum(m * v for m, _, v in rows))
        spins.append(sum(m * np.cross(x, v) for m, x, v in rows))

    fmu = run(opened(FMU[shape]), configuration, END, 20, method=method, each=record)
    assert fmu["contact.onsets"] >= 1
    check_close("momentum", momenta, [momenta[0]] * len(momenta), 1e-12)
    if shape == "sphere":
        check_close("angular momentum", spins, [spins[0]] * len(spins), 1e-9)


@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_body_at_rest_sinks_in_by_weight_over_stiffness_and_stays(opened, shape, location, dashpot, method):
    mass, stiffness, weight = 2.0, 1e4, 9.81
    damping = 0.4 * 2 * math.sqrt(stiffness * mass)
    down = approach(location)
    configuration = head_on(
        shape, location, gap=1e-3, speed=0.0, contact_method="penalty_dynamic", contact_dashpot=dashpot
    )
    configuration |= {"source.mass": mass, "contact.penalty_factor": stiffness}
    configuration |= {"contact.viscous_penalty_factor": damping, "gravity": (weight * down).tolist()}
    fmu = run(opened(FMU[shape]), configuration, 2.0, 4, method=method)
    check_close("gap", fmu["contact.gap"], -mass * weight / stiffness, 1e-9)
    check_close("normal_force", fmu["contact.normal_force"], mass * weight, 1e-9 * stiffness)
    check_close("source_force", fmu["contact.source_force"], -mass * weight * down, 1e-9 * stiffness)
    check_close("mean_force", fmu["contact.mean_force"], -mass * weight * down, 1e-5)
    check_close("velocity", fmu["source.velocity"], [0, 0, 0], 1e-7)
    settled = fmu["contact.onsets"], fmu["solver.events"]
    for _ in range(200):
        fmu.step(0.02)
    assert (fmu["contact.onsets"], fmu["solver.events"]) == settled
    check_close("gap", fmu["contact.gap"], -mass * weight / stiffness, 2e-12)


@pytest.mark.parametrize("steps", [1, 3, 7, 100])
def test_a_slide_presses_hardest_at_its_lowest_point_with_the_oscillation_on_top(opened, steps):
    """The ball is let go 60° off the lowest line of a hollow cylinder without a dashpot. The load grows from
    m g/2 to 2 m g, and the force oscillates about it by m g/2, 16 000 times a second. The load falls by
    (turning/omega)^2 within half an oscillation, and the wall is soft: both are below 1e-8."""
    weight = 0.1 * 9.81
    values = {"source.radius": 0.05, "source.mass": 0.1}
    values |= {"source.center": [0.45 * math.sqrt(0.75), 0.0, -0.225], "destination.axis": [0.0, 1.0, 0.0]}
    values |= {"contact.location": "inside", "contact.method": "penalty", "contact.penalty_factor": 1e9}
    peaks, fmu = [], opened("SphereCylinder")
    run(fmu, values, 0.7, steps, each=lambda fmu: peaks.append(fmu["contact.peak_force"]))
    check_relative("peak force", max(peaks), 2.5 * weight, 2e-8)
