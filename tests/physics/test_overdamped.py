"""Head-on contacts beyond critical damping: two exponentials in closed form."""

import math

import pytest
from mpmath import mp

from support.checks import check_close, run
from support.scenes.head_on import DASHPOTS, FMU, GEOMETRIES, approach, head_on


@pytest.mark.parametrize("ratio", [1.5, 10.0, 1000.0])
@pytest.mark.parametrize("radius", [1.0, 1e6, 1e9])
def test_a_ball_damped_on_approach_only_rebounds_by_its_spring(opened, ratio, radius):
    """However heavily damped on its way in, and however large the bodies are against the depth: it turns
    where the damped oscillator does, at depth D, and leaves with D sqrt(p_n / m)
    """
    stiffness, speed = 1e6, 1.0
    rate = math.sqrt(stiffness)
    spread = math.sqrt(ratio**2 - 1.0)
    slow, fast = rate / (ratio + spread), rate * (ratio + spread)
    turn = math.log(fast / slow) / (fast - slow)
    depth = speed / (fast - slow) * (math.exp(-slow * turn) - math.exp(-fast * turn))
    values = {
        "source.radius": radius,
        "destination.radius": radius,
        "source.center": [0.0, 0.0, 2.0 * radius],
        "source.initial_velocity": [0.0, 0.0, -speed],
        "gravity": [0.0, 0.0, 0.0],
        "contact.location": "outside",
        "contact.method": "penalty_dynamic",
        "contact.dashpot": "approach_only",
        "contact.penalty_factor": stiffness,
        "contact.viscous_penalty_factor": 2.0 * ratio * rate,
    }
    fmu = run(opened("SphereSphere"), values, 0.1, 1, 1e-9, "event_driven")
    assert fmu["source.velocity"][2] == pytest.approx(depth * rate, rel=1e-6)


def shares_left(ratio, lasted):
    """Of a contact at `ratio` of critical damping that starts at the touch: -g omega / v, -g' / v after
    `lasted` decay times of the slower rate, and that time times omega
    """
    with mp.workdps(40):
        spread = mp.sqrt(mp.mpf(ratio) ** 2 - 1)
        slower, faster = ratio - spread, ratio + spread
        time = lasted / slower
        slow, fast = mp.exp(-slower * time), mp.exp(-faster * time)
        return (
            float((slow - fast) / (2 * spread)),
            float((faster * fast - slower * slow) / (2 * spread)),
            float(time),
        )


def at_the_touch(shape, location, mass, stiffness, ratio, speed=1.0):
    """`ratio` of critical damping, `unclamped`"""
    return head_on(
        shape,
        location,
        gap=0.0,
        speed=speed,
        source_mass=mass,
        contact_method="penalty_dynamic",
        contact_dashpot="unclamped",
        contact_penalty_factor=stiffness,
        contact_viscous_penalty_factor=2 * ratio * math.sqrt(stiffness * mass),
    )


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("lasted", [1e-3, 1.0, 30.0, 600.0, 1e4, 1e9])
@pytest.mark.parametrize("ratio", [1.0001, 1.02, 1.05, 8.7, 1e4])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_an_unloaded_contact_beyond_critical_damping_dies_away(opened, shape, location, ratio, lasted, steps):
    """`unclamped`, so that it never parts: two exponentials, until they are below the smallest number, or
    below the rounding of the direction, which makes a ball outside slide off
    """
    stiffness, mass = 1e9, 1e-3
    rate = math.sqrt(stiffness / mass)
    values = at_the_touch(shape, location, mass, stiffness, ratio)
    gap, speed, time = shares_left(ratio, lasted)
    fmu = run(opened(FMU[shape]), values, time / rate, steps, None, "event_driven")
    assert fmu["contact.active"] is True or lasted > 30
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.steps"] <= steps + 20
    slid = 1e-15 * (1.0 + time / rate) if lasted > 30 else 0.0
    check_close("gap", fmu["contact.gap"], -gap / rate, 1e-6 * gap / rate + 1e-17 + slid)
    check_close("velocity", fmu["source.velocity"], speed * approach(location), 1e-6 * abs(speed) + 1e-15)
    check_close("energy", fmu["energy.total"], mass / 2, 1e-15 * mass)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.7, 0.8, 0.95, 1.05])
@pytest.mark.parametrize("lasted", [0.01, 0.3, 3.0])
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_deep_impact_beyond_critical_damping(opened, shape, location, share, lasted):
    """Either exponential alone would go a share of half the way to the centre"""
    ratio, stiffness, mass = 1.25, 1e6, 1.0
    rate = math.sqrt(stiffness / mass)
    reach = 0.4 if location == "inside" else 0.6
    speed = share * reach * rate * math.sqrt(ratio**2 - 1)
    values = at_the_touch(shape, location, mass, stiffness, ratio, speed)
    gap, left, time = shares_left(ratio, lasted)
    fmu = run(opened(FMU[shape]), values, time / rate, 3, 1e-10, "event_driven")
    assert fmu["solver.fallbacks"] == 0
    check_close("gap", fmu["contact.gap"], -gap * speed / rate, 1e-9)
    check_close("velocity", fmu["source.velocity"], left * speed * approach(location), 1e-9 * speed)


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("lasted", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("dashpot", DASHPOTS)
@pytest.mark.parametrize("shape, location", GEOMETRIES)
def test_a_dashpot_alone_leaves_a_drift(opened, shape, location, dashpot, lasted, steps):
    """Pushed along an axis: the speed decays to the force over p_nv"""
    mass, damping, force = 2.0, 1e5, 0.5
    values = head_on(
        shape,
        location,
        gap=0.0,
        source_mass=mass,
        source_center=[0.0, 0.0, 0.6 if location == "outside" else -0.4],
        source_initial_velocity=[0.0, 0.0, -1.0],
        source_external_force=[0.0, 0.0, -force],
        contact_method="penalty_dynamic",
        contact_penalty_control="viscous_only",
        contact_dashpot=dashpot,
        contact_viscous_penalty_factor=damping,
    )
    if shape == "cylinder":
        values["destination.axis"] = [0.0, 1.0, 0.0]
    decay, drift = mass / damping, force / damping
    time = lasted * decay
    fmu = run(opened(FMU[shape]), values, time, steps, 1e-9, "event_driven")
    moved = drift * time - (1.0 - drift) * decay * math.expm1(-lasted)
    speed = drift + (1.0 - drift) * math.exp(-lasted)
    assert fmu["contact.onsets"] == 1
    assert fmu["solver.steps"] <= steps + 2
    check_close("gap", fmu["contact.gap"], -moved, 1e-13 * moved)
    check_close("rate", fmu["contact.gap_rate"], -speed, 1e-15 + 1e-13 * speed)
    check_close(
        "force", fmu["contact.normal_force"], damping * speed, 1e-15 * damping + 1e-13 * damping * speed
    )
    check_close("velocity", fmu["source.velocity"], [0.0, 0.0, -speed], 1e-15)
