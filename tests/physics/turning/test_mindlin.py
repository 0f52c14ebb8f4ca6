"""A tangential stiffness that follows the normal one of Hertz's law: closed forms and the reference."""

import math

import numpy as np
import pytest

from support.checks import check_close, check_relative, run
from support.exchange_runs import check_exchange
from support.reference.turning import follow
from support.scenes.scene_checks import FMU

K_H, MASS, RADIUS, SPEED = 3e6, 1.2, 0.1, 0.7
ALLOWED = {"event_driven": 1e-10, "cvode_bdf": 1e-8, "cvode_adams": 1e-8}


def impact(ratio, mu, slip, damping=0.0):
    """A ball that meets a plane at SPEED, whose surface moves along it at `slip`: half of it is spin."""
    values = {"source.mass": MASS, "source.radius": RADIUS, "source.center": [0.0, 0.0, RADIUS + 0.01]}
    values |= {"source.initial_velocity": [0.5 * slip, 0.0, -SPEED], "source.rotation": "free"}
    values |= {"source.initial_angular_velocity": [0.0, -0.5 * slip / RADIUS, 0.0]}
    values |= {"gravity": [0.0, 0.0, 0.0], "contact.law": "hertz", "contact.hertz_stiffness": K_H}
    values |= {"contact.viscous_control": "user_defined", "contact.hunt_crossley_factor": damping}
    values |= {"contact.friction": "elastic", "contact.friction_coefficient": mu}
    values |= {"contact.static_friction_coefficient": mu, "contact.tangential_law": "mindlin"}
    return values | {"contact.tangential_ratio": ratio}


def slip_of(fmu):
    return fmu["source.velocity"][0] - RADIUS * fmu["source.angular_velocity"][1]


def test_an_impact_with_a_ratio_of_two_sevenths_turns_the_slip_round(opened, method):
    """delta'' = -(k_h/m) delta^1.5, and xi'' = -(7/2) (2/7) 1.5 (k_h/m) delta^0.5 xi is its linearization,
    which 4 delta + t delta' solves, because b^4 delta(b t) is another solution for every b. So xi is
    (4 delta + t delta') v_t/(5 v_n), and xi' = -v_t at the end. With mu = 1e9 it slides only in the last
    1e-9 of the depth, where 1e-13 of the impulse is left."""
    slip = 0.4
    fmu = run(opened(FMU["plane"]), impact(2 / 7, 1e9, slip), 0.05, 1, 1e-12, method)
    assert fmu["contact.onsets"] == 1
    check_close("slip", slip_of(fmu), -slip, ALLOWED[method])
    check_close("velocity", fmu["source.velocity"][0], (0.5 - 4 / 7) * slip, ALLOWED[method])
    check_close("energy", fmu["energy.total"], fmu["energy.kinetic"] + fmu["energy.rotational"], 1e-9)


def test_the_elongation_midway_is_that_of_the_closed_form(opened):
    """At the deepest point delta' = 0, so that xi = (4/5) delta v_t/v_n and F_t = K delta^0.5 xi; the energy
    that has come from the change of k_t is missing in energy.friction."""
    slip, ratio = 0.4, 2 / 7
    depth = (1.25 * MASS * SPEED**2 / K_H) ** 0.4
    lasts = 2 * depth / SPEED * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
    fmu = run(opened(FMU["plane"]), impact(ratio, 1e9, slip), 0.01 / SPEED + 0.5 * lasts, 1, 1e-12)
    check_relative("depth", -fmu["contact.gap"], depth, 1e-10)
    spring = 0.8 * depth * slip / SPEED
    force = 1.5 * ratio * K_H * math.sqrt(depth) * spring
    check_relative("force", fmu["contact.friction_force"][0], -force, 1e-10)
    check_relative("stored", fmu["energy.tangential"], 0.5 * force * spring, 1e-10)
    gone = 0.5 * MASS / 3.5 * slip**2 - 0.5 * MASS / 3.5 * (slip_of(fmu)) ** 2
    check_relative("friction", fmu["energy.friction"], gone - 0.5 * force * spring, 1e-9)


@pytest.mark.parametrize("ratio, damping", [(1.4 / 1.7, 0.0), (1.4 / 1.7, 0.4), (0.05, 0.0)])
def test_an_impact_that_sticks_goes_as_the_reference_says(opened, method, ratio, damping):
    values = impact(ratio, 1e9, 0.4, damping)
    expected = follow(values, "plane", 0.05)
    fmu = run(opened(FMU["plane"]), values, 0.05, 1, 1e-12, method)
    check_close("velocity", fmu["source.velocity"], expected["source.velocity"], ALLOWED[method])
    spin = expected["source.angular_velocity"]
    check_close("spin", fmu["source.angular_velocity"], spin, ALLOWED[method] / RADIUS)


@pytest.mark.parametrize("damping", [0.0, 0.4])
@pytest.mark.parametrize("tangential, cap", [(0.0, 1e300), (3.0, 1e300), (0.0, 0.0)])
def test_an_impact_that_slides_takes_mu_of_the_normal_impulse(opened, method, damping, tangential, cap):
    mu, slip = 0.1, 5.0
    values = impact(1.4 / 1.7, mu, slip, damping) | {"contact.tangential_damping": tangential}
    values["contact.maximum_friction_force"] = cap
    fmu = run(opened(FMU["plane"]), values, 0.05, 1, 1e-12, method)
    kick = mu * (SPEED + fmu["source.velocity"][2]) if cap else 0.0
    check_close("velocity", fmu["source.velocity"][0], 0.5 * slip - kick, ALLOWED[method])
    spin = -0.5 * slip / RADIUS + 2.5 * kick / RADIUS
    check_close("spin", fmu["source.angular_velocity"][1], spin, ALLOWED[method] / RADIUS)


@pytest.mark.parametrize("law", ["linear", "mindlin"])
def test_a_load_from_rest_at_the_touch_makes_it_slide(opened, method, law):
    """F* grows as t^2 or, with the factor K a_t > mu k_h a_n, as t^3, like the limit."""
    values = impact(0.8, 0.1, 0.0) | {"source.center": [0.0, 0.0, RADIUS], "gravity": [9.0, 0.0, -9.0]}
    values |= {"source.initial_velocity": [0.0, 0.0, 0.0], "contact.tangential_law": law}
    fmu = run(opened(FMU["plane"]), values, 0.02, 1, 1e-12, method)
    kick = 0.1 * (9.0 * 0.02 + fmu["source.velocity"][2])
    check_close("velocity", fmu["source.velocity"][0], 9.0 * 0.02 - kick, ALLOWED[method])


@pytest.mark.parametrize("factor, sticks", [(0.999, True), (1.001, False)])
@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_it_sticks_at_the_touch_where_the_spring_grows_more_slowly_than_its_limit(
    opened, method, factor, sticks, damping
):
    """K v_t < mu k_h (1 + chi v_n) v_n, of two forces that both grow with the power 1.5 of time."""
    ratio, mu = 0.8, 0.3
    slip = factor * mu * (1 + damping * SPEED) * SPEED / (1.5 * ratio)
    fmu = run(opened(FMU["plane"]), impact(ratio, mu, slip, damping), 0.01 / SPEED + 1e-6, 1, 1e-10, method)
    assert fmu["contact.active"] and bool(fmu["contact.sticking"]) == sticks


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder"])
def test_the_automatic_ratio_is_that_of_the_materials(opened, shape):
    """k_t = 8 G* (R* delta)^0.5; an elliptic contact has the same ratio to dF_n/d delta."""
    depth, slip, time = 1e-4, 0.02, 1e-3
    E, nu = (7e9, 2e11), (0.35, 0.28)
    g = [e / (2 * (1 + n)) for e, n in zip(E, nu, strict=True)]
    shear = 1 / sum((2 - n) / one for n, one in zip(nu, g, strict=True))
    modulus = 1 / sum((1 - n**2) / e for n, e in zip(nu, E, strict=True))
    values = {"source.center": [0.0, 0.0, 0.1 + (0.0 if shape == "plane" else 0.5) - depth]}
    values |= {"source.motion": "prescribed", "source.prescribed_velocity": [slip, 0.0, 0.0]}
    values |= {"source.youngs_modulus": E[0], "source.poissons_ratio": nu[0]}
    values |= {"destination.youngs_modulus": E[1], "destination.poissons_ratio": nu[1]}
    values |= {"contact.law": "hertz", "contact.penalty_control": "automatic", "contact.method": "penalty"}
    values |= {"contact.friction": "elastic", "contact.friction_coefficient": 10.0}
    values |= {"contact.static_friction_coefficient": 10.0, "contact.tangential_law": "mindlin"}
    if shape == "cylinder":
        values["destination.axis"] = [1.0, 0.0, 0.0]
    if shape == "sphere":  # along the surface, and deep enough to feel no curvature in 2e-5 m
        values |= {"source.prescribed_velocity": [0.0, 0.0, 0.0], "destination.rotation": "prescribed"}
        values["destination.prescribed_angular_velocity"] = [0.0, -slip / (0.5 - depth), 0.0]
    fmu = run(opened(FMU[shape]), values, time, 1, 1e-10)
    tangential = 4 * shear / modulus * 1.5 * fmu["contact.effective_hertz_stiffness"] * math.sqrt(depth)
    if shape != "cylinder":
        curved = 1 / 0.1 + (0.0 if shape == "plane" else 1 / 0.5)
        check_relative("k_t", 8 * shear * math.sqrt(depth / curved), tangential, 1e-12)
    check_relative("force", np.linalg.norm(fmu["contact.friction_force"]), tangential * slip * time, 1e-9)


@pytest.mark.parametrize("tangential", [0.0, 10.0])
def test_model_exchange_goes_the_same_way(opened, tangential):
    """It slides, sticks and slides again, as fmpy's CVODE moves the FMU of FMI 2.0 and that of FMI 3.0."""
    values = impact(1.4 / 1.7, 0.3, 1.2, 0.1) | {"contact.tangential_damping": tangential}
    fmu = run(opened("SpherePlane"), values, 0.05, 1, 1e-11)
    check_exchange(fmu, "SpherePlane", values, 0.05, ["source.velocity", "source.angular_velocity"])
