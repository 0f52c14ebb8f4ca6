"""Contacts that turn and rub while the importer moves both bodies, against the reference's integration.

The source comes to touch, presses, slides or sticks, and parts again, all within one communication step: mean
force and torques, energies, springs, onsets and durations.
"""

import numpy as np
import pytest

from support.checks import check_close, start
from support.reference.turning import TurningPair, TurningRun, outputs
from support.scenes.scene_checks import FMU
from support.scenes.turning_checks import failures
from support.scenes.turning_scenes import FRICTIONS, PLACES, driven_scene

# The reference begins sliding without a dashpot from free bodies only; such springs have a test of their own.
WITHOUT_DASHPOT = ("elastic", "elastic, static")
SCENES = [
    seed
    for seed in range(len(PLACES) * len(FRICTIONS))
    if FRICTIONS[seed // len(PLACES)] not in WITHOUT_DASHPOT
]
INCREMENTS = 4000  # of the incremental spring, whose error goes with the first power of the step


@pytest.mark.parametrize("seed", SCENES)
def test_a_given_motion_has_the_forces_that_the_reference_says(opened, seed):
    shape, values, end, _ = driven_scene(seed)
    expected = TurningRun(values, shape).run(end).figures()
    lines = failures(opened(FMU[shape]), values, end, 1, "event_driven", expected)
    assert not lines, f"{lines}\n{values}"


def incremental(values, shape, end):
    """Impulse on the source by Cundall and Strack's increments: the spring grows by the slip, stays tangent,
    and is cut back to where k_t times its length is mu F_n."""
    pair, rubbing = TurningPair(values | {"contact.friction": "none"}, shape), TurningPair(values, shape)
    speed, bend = map(np.array, values["source.prescribed_displacement.derivatives"])
    omega = np.array(values["source.prescribed_angular_velocity"])
    m = {
        name: np.zeros(3)
        for name in ("destination.displacement", "destination.velocity", "destination.omega")
    }
    m |= {name: np.array(values[name]) for name in ("source.center", "destination.center")}
    m |= {"source.omega": omega, "axis": np.array(values.get("destination.axis", (0.0, 0.0, 1.0)))}
    spring, impulse, step = np.zeros(3), np.zeros(3), end / INCREMENTS
    for k in range(INCREMENTS):
        t = (k + 0.5) * step
        m["source.displacement"], m["source.velocity"] = speed * t + bend * t**2 / 2, speed + bend * t
        now = outputs(pair, m)
        normal = now["direction"]
        k_t = rubbing.stiffness_of(rubbing.opposed["slip"], now["gap"][0])
        spring = spring + step * now["slip_velocity"]
        spring = spring - (spring @ normal) * normal
        limit = values["contact.friction_coefficient"] * now["normal_force"][0]
        size = k_t * np.linalg.norm(spring)
        spring = spring * min(1.0, limit / size) if size > 0.0 else np.zeros(3)
        impulse += step * (now["source_force"] - k_t * spring)
    return impulse


HERTZ = {"contact.law": "hertz", "contact.hertz_stiffness": 1e6, "contact.tangential_law": "mindlin"}


@pytest.mark.parametrize("law", [{}, HERTZ], ids=["linear", "mindlin"])
@pytest.mark.parametrize("number", range(len(PLACES)))
def test_a_spring_without_a_dashpot_slides_as_increments_say(opened, number, law):
    """In turn so soft that it sticks for long, and so stiff that it slides nearly at once"""
    shape, values, end, _ = driven_scene(number)
    stiffness = 5e4
    values = {name: value for name, value in values.items() if not name.startswith("contact.")} | {
        "contact.location": values.get("contact.location"),
        "contact.law": "linear", "contact.method": "penalty",
        "contact.penalty_factor": stiffness, "contact.friction": "elastic",
        "contact.friction_coefficient": 0.4, "contact.static_friction_coefficient": 0.4,
        "destination.prescribed_angular_velocity": [0.0, 0.0, 0.0],
    }  # fmt: skip
    values = {name: value for name, value in values.items() if value is not None}
    values["contact.tangential_stiffness"] = (0.02, 0.5)[number % 2] * stiffness
    values |= law | {"contact.tangential_ratio": (0.02, 0.5)[number % 2]} if law else {}
    fmu = start(opened(FMU[shape]), values)
    fmu.step(end)
    right = incremental(values, shape, end)
    assert np.linalg.norm(end * fmu["contact.mean_force"] - right) < 3e-3 * np.linalg.norm(right)


def test_a_spring_relaxes_through_its_dashpot_while_the_contact_pulls(opened):
    """A ball is drawn off the plane. Over the last millimetre E_t falls as exp(-2 k_t t / c_t)."""
    values = {"source.motion": "prescribed", "source.radius": 0.1, "source.center": [0.0, 0.0, 0.098]}
    values |= {"source.prescribed_velocity": [0.05, 0.0, 0.1]}
    values |= {"source.prescribed_displacement.derivatives": [[0.05, 0.0, 0.1]]}
    values |= {"contact.penalty_factor": 1e4, "contact.viscous_penalty_factor": 100.0}
    values |= {"contact.dashpot": "unclamped", "contact.friction": "elastic"}
    values |= {"contact.tangential_stiffness": 1e4, "contact.tangential_damping": 50.0}
    fmu = start(opened("SpherePlane"), values)
    fmu.step(0.012)
    assert fmu["contact.normal_force"] < 0.0
    before = fmu["energy.tangential"]
    fmu.step(0.004)
    assert before > 1e-9
    expected = before * np.exp(-2.0 * 1e4 / 50.0 * 0.004)
    check_close("energy.tangential", fmu["energy.tangential"], expected, 1e-9 * before)
